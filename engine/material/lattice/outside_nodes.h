// Nodes of a box of cells that belong only to void cells, outside the body. They bear no load and have almost
// no mass (void_fraction). Left to themselves, they are thrown about by sudden motions, like the end of a
// whip.
#pragma once

#include <array>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill {

// Lets each node outside the body follow the mean linear motion of the nearest cell that contains part of the
// body, so that it continues linear motions exactly. Void cells then exert forces of up to void_fraction of a
// cell's on the body, and their weight rests on nothing. Made once for a lattice; const afterwards.
class OutsideNodes {
 public:
  OutsideNodes() = default;  // of a lattice without such nodes
  explicit OutsideNodes(const LatticeMesh& mesh);

  bool empty() const { return nodes_.empty(); }
  // Sets the values of a field, such as the displacements along one axis, at the nodes outside the body. A
  // node whose entry in `is_free` is 0 keeps its value. Both arrays have one value per node.
  void continue_field(const float* is_free, float* field) const;
  // Limits the speeds of the free nodes outside the body to a little less than the cap. A node far from the
  // body continues a turn of a cell at many times its speed.
  void limit_speeds(const SpeedCap& cap, const LatticeView& view) const;

 private:
  struct Node {
    int node;
    std::array<int, 8> corners;  // of the cell, all in the body or on its shell
    std::array<float, 8> weights;
  };
  std::vector<Node> nodes_;
};

}  // namespace spoonbill
