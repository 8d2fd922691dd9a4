// Points of a deformable body that share its mass and move with its lattice.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// The points are those of regular grids in the cells that are inside the body. In a box of cells about a
// body, half of the outer nodes are outside the body, so that nodes would be a poor measure of where the mass
// is. The density counts as uniform. Has one owner; allocates only when it is made.
class MassPoints {
 public:
  // `at_rest` is the body's surface in the undeformed lattice.
  MassPoints(const SpringLattice& lattice, const Surface& at_rest);

  // Calls visit(point_m, fraction) for each point, where it is now, with its fraction of the body's mass.
  template <class Visit>
  void for_each(const SpringLattice& lattice, const Visit& visit) const {
    std::size_t at = 0;
    for (const Cell& cell : cells_) {
      CellCorners corners;
      for (int c = 0; c < 8; ++c)
        corners[static_cast<std::size_t>(c)] = lattice.position(cell.nodes[static_cast<std::size_t>(c)]);
      for (int k = 0; k < cell.count; ++k, ++at) {
        Vector3 point = Vector3::Zero();
        const std::array<double, 8>& weights = weights_[places_[at]];
        for (std::size_t c = 0; c < 8; ++c) point += weights[c] * corners[c];
        visit(point, cell.fraction);
      }
    }
  }
  std::size_t size() const { return places_.size(); }

 private:
  static constexpr int points_a_side = 3;
  struct Cell {
    std::array<int, 8> nodes{};
    int count = 0;          // number of its points
    double fraction = 0.0;  // of the body's mass, of each of its points
  };
  std::vector<Cell> cells_;
  std::vector<unsigned char> places_;           // of each point in its cell's grid
  std::vector<std::array<double, 8>> weights_;  // of the corners, for each place of the grid
};

}  // namespace spoonbill
