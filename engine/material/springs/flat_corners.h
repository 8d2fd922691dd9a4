// Resistance of lattice cells against being turned inside out. Springs cannot tell an inverted cell from a
// regular one: both are at rest.
#pragma once

#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill {

// Ratio j of the volume spanned by the three edges at a corner to that at rest, below which the corner
// resists. Its energy is then 1/2 K (flat_corner_ratio - j)^2, which an inverted corner (j < 0) can give
// back. The volume at rest follows the rest volume of the cell. A corner that is flat at rest, as along the
// edges of a block of cells bent into a body, does not resist: j would change too fast.
inline constexpr float flat_corner_ratio = 0.3f;
// Least volume of a corner at construction, divided by that of its cell, for which the corner resists.
inline constexpr float least_corner_volume = 0.5f;

// Resists the inversion of the flat corners of a lattice in real time. A corner's stiffness K is 15 G V / 8
// for the shear modulus G and the volume V of the body in the cell, and less where it would be too stiff for
// the substep, so that it need not shorten the substep. Owned by the lattice; allocates only in its
// constructor.
class FlatCorners {
 public:
  FlatCorners() = default;  // of no cells
  explicit FlatCorners(const LatticeMesh& mesh);

  // Finds the cells with a corner that resists, or may do so soon. Call at the start of a tick.
  void find(const LatticeKernels& kernels, const LatticeView& view);
  bool empty() const { return flat_.empty(); }
  // Adds the forces of the corners of these cells, in a substep of h_s.
  void add_forces(const LatticeView& view, float h_s) const;

 private:
  std::vector<unsigned char> is_body_cell_;  // by first corner: whether part of the body is in the cell
  std::vector<unsigned char> is_flat_;       // by first corner, padded: results of the kernel
  std::vector<int> flat_;                    // first corners of the cells found
};

}  // namespace spoonbill
