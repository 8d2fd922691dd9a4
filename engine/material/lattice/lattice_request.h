// How many nodes a body's lattice gets.
#pragma once

#include <array>
#include <optional>

#include "engine/material/lattice/feature_map.h"
#include "engine/pose.h"
#include "engine/result.h"

namespace spoonbill {

// How many nodes a body gets across (first, second) and along (third) itself, or along x, y and z where it
// is made of triangles or lies in a box of cells (solid_lattice.h), or along u, through and along v of a
// shell (around, through and along of one that closes, the first node around counted again as the last):
// given, or counted out so that cells are near-cubic and at most `node_budget` nodes are spent.
struct LatticeRequest {
  int node_budget = 2000;
  std::optional<std::array<int, 3>> counts;  // each at least 2
  // Of bodies that are tubes: how the nodes inside are spread once the transfinite ones are there; not at all
  // without it.
  std::optional<FeatureMapSettings> feature_map = {};
};

// For a body of these extents, each above zero. Refused: counts below 2.
Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m);
// The same for a shell, which one layer of cells may fill; `closed` where the first direction runs around.
Result<std::array<int, 3>> shell_counts(const LatticeRequest& request, const Vector3& size_m, bool closed);

// A ring of fewer cells is none.
inline constexpr int least_cells_around = 3;

}  // namespace spoonbill
