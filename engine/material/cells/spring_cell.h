// A cell of springs and one volume force: the same elasticity as the lattice that sculpting steps
// (lattice_kernels.h), in double, with its tangent.
#pragma once

#include <array>

#include "engine/material/cells/cell_response.h"
#include "engine/material/cells/cell_springs.h"

namespace spoonbill {

// Plain data; a value.
class SpringCell {
 public:
  SpringCell() = default;
  // At rest in `rest`; `share` is how much of the cell there is.
  SpringCell(const CellCorners& rest, const CellSprings& springs, double bulk_stiffness_pa, double share);

  // 1/2 k (L - L0)^2 of each spring and 1/2 K_v (J - 1)^2 V0, J = V / V0.
  CellResponse respond(const CellMoves& moves, Tangent tangent) const;
  double energy_j(const CellMoves& moves) const;

 private:
  CellCorners corners_of(const CellMoves& moves) const;
  // By how much a spring is longer than at rest.
  double extension_m(std::size_t spring, const CellMoves& moves) const;

  CellCorners rest_{};  // from the middle
  std::array<double, cell_spring_count> stiffness_{}, rest_length_{};
  double bulk_ = 0.0, rest_volume_ = 0.0;  // K_v V0, V0
};

}  // namespace spoonbill
