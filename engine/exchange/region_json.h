// What a body's regions are made of, as JSON fields.
#pragma once

#include <vector>

#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"
#include "engine/scene/material.h"

namespace spoonbill {

// The list "regions" of a body, which is left out where it is empty; the reader keeps the first problem.
std::vector<MaterialRegion> read_material_regions(FieldReader& body);
void add_material_regions(const std::vector<MaterialRegion>& regions, Json& body);

}  // namespace spoonbill
