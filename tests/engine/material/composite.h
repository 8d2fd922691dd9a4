// Blocks of two materials for the lattice's tests.
#pragma once

#include <functional>

#include "engine/material/lattice_materials.h"

namespace spoonbill {

// Returns the first material, except in cells for whose centre (m) `is_second` is true.
LatticeMaterials composite(const LatticeMesh& mesh, const Material& first, const Material& second,
                           const std::function<bool(const Vector3&)>& is_second);

}  // namespace spoonbill
