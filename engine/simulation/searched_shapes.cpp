#include "engine/simulation/searched_shapes.h"

#include "engine/base/assert.h"

namespace spoonbill {

SearchedShapes::SearchedShapes(std::span<const BodyState> bodies) {
  for (const BodyState& body : bodies) {
    displacements_m_.emplace_back(static_cast<std::size_t>(body.lattice.mesh().node_count()),
                                  Vector3::Zero());
  }
}

void SearchedShapes::remember(std::span<const BodyState> bodies) {
  SPOONBILL_ASSERT(bodies.size() <= displacements_m_.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    std::vector<Vector3>& nodes = displacements_m_[b];
    for (std::size_t n = 0; n < nodes.size(); ++n)
      nodes[n] = bodies[b].lattice.displacement(static_cast<int>(n));
  }
  known_count_ = bodies.size();
}

bool SearchedShapes::still_hold(std::span<const BodyState> bodies) const {
  SPOONBILL_ASSERT(bodies.size() <= displacements_m_.size());
  if (known_count_ != bodies.size()) return false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& body = bodies[b];
    if (body.is_immovable() && body.rigid->motion().moves) return false;
    const double most_m =
        body.is_immovable() ? 0.0 : searched_motion_cells * static_cast<double>(body.lattice.cell_size_m());
    const std::vector<Vector3>& nodes = displacements_m_[b];
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vector3 moved_m = body.lattice.displacement(static_cast<int>(n)) - nodes[n];
      // The negation also catches a displacement that is not a number.
      if (!(moved_m.squaredNorm() <= most_m * most_m)) return false;
    }
  }
  return true;
}

}  // namespace spoonbill
