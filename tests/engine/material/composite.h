// Blocks of two materials for the lattice's tests.
#pragma once

#include <functional>

#include "engine/material/lattice_materials.h"

namespace spoonbill {

// Of the first material but where `is_second` says so of the middle of a cell, m.
LatticeMaterials composite(const LatticeMesh& mesh, const Material& first, const Material& second,
                           const std::function<bool(const Vector3&)>& is_second);

}  // namespace spoonbill
