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
    for_each(lattice, visit, [](const CellCorners&, double) { return false; });
  }

  // Does the same, but first calls take(corners, fraction) for each cell, with the fraction of all its
  // points. If this returns true, the points of the cell, which are between its corners, are not visited.
  template <class Visit, class Take>
  void for_each(const SpringLattice& lattice, const Visit& visit, const Take& take) const {
    std::size_t at = 0;
    for (const Cell& cell : cells_) {
      CellCorners corners;
      for (std::size_t c = 0; c < 8; ++c) corners[c] = lattice.position(cell.nodes[c]);
      if (take(corners, cell.fraction * cell.count)) {
        at += static_cast<std::size_t>(cell.count);
        continue;
      }
      for (int k = 0; k < cell.count; ++k, ++at) {
        Vector3 point = Vector3::Zero();
        const std::array<double, 8>& weights = weights_[places_[at]];
        for (std::size_t c = 0; c < 8; ++c) point += weights[c] * corners[c];
        visit(point, cell.fraction);
      }
    }
  }
  // Returns the centre of mass of the points. It is a weighted sum of the nodes, so it takes less time than a
  // visit of all points.
  Vector3 find_centre_m(const SpringLattice& lattice) const {
    Vector3 centre = Vector3::Zero();
    for (const NodeWeight& node : node_weights_) centre += node.weight * lattice.position(node.node);
    return centre;
  }
  std::size_t size() const { return places_.size(); }

 private:
  static constexpr int points_a_side = 3;
  struct Cell {
    std::array<int, 8> nodes{};
    int count = 0;          // number of its points
    double fraction = 0.0;  // of the body's mass, of each of its points
  };
  struct NodeWeight {
    int node = 0;
    double weight = 0.0;
  };
  std::vector<Cell> cells_;
  std::vector<NodeWeight> node_weights_;        // of the centre of mass
  std::vector<unsigned char> places_;           // of each point in its cell's grid
  std::vector<std::array<double, 8>> weights_;  // of the corners, for each place of the grid
};

}  // namespace spoonbill
