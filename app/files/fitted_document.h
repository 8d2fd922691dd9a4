// The document that a fit becomes.
#pragma once

#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/fitting/fit_scan.h"
#include "engine/result.h"

namespace spoonbill {

struct FittedDocument {
  Document document;
  std::vector<std::string> remarks;  // what the program will not do with a body, and why
};

// Each body of clay: solid where it is closed, else a shell behind the surface, a hundredth of its size thick
// or as thin as its curvature asks for. Refused: more bodies than a document holds.
Result<FittedDocument> fitted_document(const ScanFit& fit, const std::string& name, const Material& clay);

}  // namespace spoonbill
