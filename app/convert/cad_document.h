// The surfaces of a CAD file as a document.
#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/document.h"

namespace spoonbill {

// Each becomes a body of modelling clay; the other settings are those that a new document of the first has.
// Refused: more surfaces than a document has bodies.
Result<Document> document_of(const CadModel& model, const std::string& name);

}  // namespace spoonbill
