// How many nodes a body's lattice gets.
#pragma once

#include <array>
#include <optional>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body.h"

namespace spoonbill {

// For a body of these extents, each above zero. Refused: counts below 2.
Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m);
// The same for a shell, which one layer of cells may fill; `closed` where the first direction runs around.
Result<std::array<int, 3>> shell_counts(const LatticeRequest& request, const Vector3& size_m, bool closed);

// A ring of fewer cells is none.
inline constexpr int least_cells_around = 3;

}  // namespace spoonbill
