#include "engine/simulation/searched_shapes.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {

SearchedShapes::SearchedShapes(std::span<const BodyState> bodies) {
  for (const BodyState& body : bodies) {
    Field& field = displacements_m_.emplace_back();
    for (std::vector<float>& axis : field)
      axis.resize(static_cast<std::size_t>(body.lattice.mesh().node_count()));
  }
}

void SearchedShapes::remember(std::span<const BodyState> bodies) {
  SPOONBILL_ASSERT(bodies.size() <= displacements_m_.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<float>& nodes = displacements_m_[b][axis];
      std::copy_n(bodies[b].lattice.displacements(static_cast<int>(axis)), nodes.size(), nodes.begin());
    }
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
    const Field& last = displacements_m_[b];
    for (std::size_t n = 0; n < last[0].size(); ++n) {
      const Vector3 last_m(last[0][n], last[1][n], last[2][n]);
      const Vector3 moved_m = body.lattice.displacement(static_cast<int>(n)) - last_m;
      // The negation also catches a displacement that is not a number.
      if (!(moved_m.squaredNorm() <= most_m * most_m)) return false;
    }
  }
  return true;
}

}  // namespace spoonbill
