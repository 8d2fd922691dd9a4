// The document that a fit becomes.
#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {

struct FittedDocument {
  Document document;
  std::vector<std::string> remarks;  // what the program does otherwise with a body, or not at all, and why
};

// A starting_document() of bodies of clay, held and with a tool as suits the first: solid where they are
// closed, else shells behind their surfaces, a hundredth of their size thick or as thin as their curvature
// asks for. Refused: more bodies than a document holds.
Result<FittedDocument> fitted_document(const ScanFit& fit, const std::string& name, const Material& clay);

}  // namespace spoonbill
