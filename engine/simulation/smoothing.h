// Evens out under the tool what strokes have done to a body: dents come forward, bumps sink in, and the
// material takes its new place as its rest. So no force arises, nothing springs back, the rest of the body
// stays where it is, and what no stroke has changed stays as it was made, edges and all.
//
// A node's bump is how much more its curvature has changed since the rest shape than its neighbours', along
// each of the two lines of the lattice that cross there. A bend, whose curvature changes evenly, has none and
// stays. To first order this is the flow d' = -(d^4 d / ds^4) of the displacement along the normal, as a thin
// plate's that gives way. What is smaller than a cell the lattice does not know, and the mass is as before
// even where a little volume comes or goes.
//
// The shell is that of the block of cells. The skin of a body in a box of cells lies inside the block: it
// follows its nodes, which go to the middle of their neighbours as all nodes inside do.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// What to even out: all that lies within the reach, less toward its edge.
struct SmoothingBrush {
  Vector3 centre_m = Vector3::Zero();
  double reach_m = 0.0;
};

// One owner, the simulation; made anew with the lattice's mesh. apply() allocates nothing.
class Smoothing {
 public:
  explicit Smoothing(const LatticeMesh& mesh);

  // One tick of it. Of the nodes within reach a few take their turn in each tick, so that a large tool costs
  // no more than a small one. Held nodes stay.
  void apply(SpringLattice& lattice, const SmoothingBrush& brush, std::uint64_t tick);

 private:
  // The nodes on both sides of a node along a line; a line runs on over the edges of the block.
  using Pair = std::array<int, 2>;
  struct ShellNode {
    std::array<Pair, 2> pairs{};
    int pair_count = 0;  // 0 inside the block, 1 at its corners
  };
  struct Curvature {
    Vector3 normal;                         // unit
    std::array<double, 2> per_m{};          // along each pair, above 0 where the normal's side is convex
    std::array<double, 2> height_factor{};  // from a curvature to the height over the neighbours, m^2
  };

  // Nothing where two lines do not cross, or have shrunk to a point.
  template <class PositionOf>
  std::optional<Curvature> curvature_at(int node, const PositionOf& position_of) const;
  // By how much it has changed.
  std::optional<Curvature> bend_at(const SpringLattice& lattice, int node) const;
  // A neighbour's, along the line that leads to `node`; lowers `height_factor` to the neighbour's.
  std::optional<double> bend_toward(const SpringLattice& lattice, int neighbour, int node,
                                    double& height_factor) const;
  Vector3 off_the_form(const SpringLattice& lattice, int node) const;
  // Where an inner node lies in the middle of its six neighbours.
  struct Middle {
    Vector3 offset;          // of the node
    Eigen::Matrix3d across;  // columns: from one neighbour to the opposite one
  };
  template <class PositionOf>
  Middle middle_at(int node, const PositionOf& position_of) const;
  Vector3 off_the_middle(const SpringLattice& lattice, int node) const;
  void connect(const LatticeMesh& mesh, int node);

  std::array<int, 2> beside(int node, int axis) const;

  std::vector<ShellNode> shell_;                   // one a node
  std::vector<std::array<double, 2>> rest_per_m_;  // of nodes on the shell
  std::vector<Vector3> rest_middle_;               // of inner nodes: the offset in shares of `across`
  std::array<int, 3> stride_{};
  int count_i_ = 0;        // of the lattice
  bool closed_ = false;    // see LatticeMesh
  std::vector<int> near_;  // working memory
};

}  // namespace spoonbill
