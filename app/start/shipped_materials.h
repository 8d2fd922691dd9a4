// The materials that come with the program.
#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

// The names of all of them, sorted.
std::vector<std::string> shipped_material_names();

// By its whole name or a part that no other has: "clay" for modelling-clay. Refused with the names there are.
Result<Material> shipped_material(const std::string& name);

}  // namespace spoonbill
