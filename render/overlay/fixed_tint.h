// The fixed part of a body as a weight of each drawn vertex. Does not use GL.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

// One owner, one thread.
class FixedTint {
 public:
  // If `keeps_weights`, computes the weights again only when the triangles or the fixed nodes have changed,
  // because a vertex moves with the nodes near it.
  void update(const LatticeSnapshot& lattice, const TessellatedSurface& surface, bool keeps_weights);

  // Returns for each vertex 1 in the fixed part, 0 elsewhere, and values between across one cell.
  const std::vector<float>& weights() const { return weights_; }

 private:
  std::vector<float> weights_;
  std::vector<std::uint8_t> fixed_;  // those of the last update
  std::uint64_t topology_version_ = 0;
};

}  // namespace spoonbill
