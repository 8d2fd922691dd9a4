// Provides blocks of two materials for tests of the lattice.
#pragma once

#include <functional>

#include "engine/material/lattice_materials.h"

namespace spoonbill {

// Returns the material of each cell: `second` if `is_second` is true for the cell's centre (m), otherwise
// `first`.
LatticeMaterials composite(const LatticeMesh& mesh, const Material& first, const Material& second,
                           const std::function<bool(const Vector3&)>& is_second);

}  // namespace spoonbill
