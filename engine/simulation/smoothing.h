// Smoothing of a body under the tool. Dents rise and bumps sink, and the material adopts the new positions as
// its rest shape, so that no force arises and nothing springs back. Parts that no stroke has changed keep
// their shape, including edges.
//
// A node's bend is the change of its curvature since the rest shape. The bump of a shell node is its bend
// minus the mean bend of its neighbours, measured along each of the two lattice lines that cross at the node.
// An evenly changing curvature, as in a bent beam, is not a bump and stays. To first order this is the flow
// h' = -(d^4 h / ds^4) of the normal displacement h along the arc length s, as in a thin plate. Shapes
// smaller than a cell are not resolved. Small changes of volume do not change the mass.
//
// Shell nodes are the nodes on the hull of the block of cells. Inner nodes return to their rest position
// relative to their neighbours. If the lattice is a box of cells around the body, the skin is inside the
// block and moves with such inner nodes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Ball in which a body is smoothed, with a weight that falls to 0 at its boundary.
struct SmoothingBrush {
  Vector3 centre_m = Vector3::Zero();
  double reach_m = 0.0;
};

// Smoothing of one lattice. Owned by the simulation, which rebuilds it when the lattice's mesh changes.
// apply() allocates nothing.
class Smoothing {
 public:
  explicit Smoothing(const LatticeMesh& mesh);

  // Smooths for one tick. Only a few of the nodes within reach move in each tick, so that a large tool costs
  // no more than a small one. Fixed nodes stay.
  void apply(SpringLattice& lattice, const SmoothingBrush& brush, std::uint64_t tick);

 private:
  // The two neighbours of a node along a lattice line. Lines continue over the edges of the block.
  using Pair = std::array<int, 2>;
  struct ShellNode {
    std::array<Pair, 2> pairs{};
    int pair_count = 0;  // number of pairs: 2, but 1 at the block's corners and 0 inside
  };
  struct Curvature {
    Vector3 normal;  // unit normal
    // Curvature along each pair, 1/m; positive if the surface is convex on the side of the normal.
    std::array<double, 2> per_m{};
    // Height of the node above the chord of its neighbours, divided by the curvature, m^2.
    std::array<double, 2> height_factor{};
  };

  // Returns the curvature at a shell node; nothing where fewer than two lines cross or a line has no length.
  template <class PositionOf>
  std::optional<Curvature> curvature_at(int node, const PositionOf& position_of) const;
  // Returns the change of the curvature since the rest shape.
  std::optional<Curvature> bend_at(const SpringLattice& lattice, int node) const;
  // Returns the bend of a neighbour along the line that leads to `node`; nothing if there is no such line or
  // no curvature. Lowers `height_factor` to the neighbour's height factor if the latter is less.
  std::optional<double> bend_toward(const SpringLattice& lattice, int neighbour, int node,
                                    double& height_factor) const;
  // Returns the displacement of a shell node from its position on the shape without the bump.
  Vector3 measure_bump(const SpringLattice& lattice, int node) const;
  // Position of an inner node relative to its six neighbours.
  struct NeighbourCentre {
    Vector3 offset;          // offset of the node from the centre of its neighbours
    Eigen::Matrix3d across;  // for each axis, a column: the vector between the two neighbours
  };
  template <class PositionOf>
  NeighbourCentre neighbour_centre_at(int node, const PositionOf& position_of) const;
  // Returns the displacement of an inner node from its rest position relative to its neighbours.
  Vector3 measure_centre_offset(const SpringLattice& lattice, int node) const;
  // Sets the pairs of a shell node in such an order that the cross product of the two pairs' directions
  // points out of the body.
  void connect(const LatticeMesh& mesh, int node);

  // Returns the neighbours before and after an inner node along an axis, across the seam of a closed block.
  std::array<int, 2> beside(int node, int axis) const;

  std::vector<ShellNode> shell_;                   // one entry for each node
  std::vector<std::array<double, 2>> rest_per_m_;  // rest curvatures of shell nodes
  std::vector<Vector3> rest_centre_;               // rest offsets of inner nodes, as fractions of `across`
  std::array<int, 3> stride_{};
  int count_i_ = 0;        // nodes of the lattice along i
  bool closed_ = false;    // LatticeMesh::closed
  std::vector<int> near_;  // working memory
};

}  // namespace spoonbill
