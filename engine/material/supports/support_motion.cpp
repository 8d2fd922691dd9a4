#include "engine/material/supports/support_motion.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/material/springs/node_motion.h"

namespace spoonbill {
namespace {

// All held nodes are of one support that moves.
const SupportedNodes* ridden(std::span<const SupportedNodes> supports, const SpringLattice& lattice) {
  const SupportedNodes* only = nullptr;
  for (const SupportedNodes& support : supports) {
    if (support.nodes.empty()) continue;
    if (only != nullptr || !support.moves) return nullptr;
    only = &support;
  }
  const bool has_all = only != nullptr && static_cast<int>(only->nodes.size()) == lattice.held_count();
  return has_all ? only : nullptr;
}

Vector3 velocity_of(const SupportedNodes& support, double time_s) {
  return (support.end_m - support.start_m) / time_s;
}

}  // namespace

bool limit_ways(std::span<SupportedNodes> supports, const SpringLattice& lattice, double reach_m) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  const SupportedNodes* const rides_with = ridden(supports, lattice);
  bool limited = false;
  for (SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const double most = &support == rides_with ? std::max(reach_m, 2.0 * support.fastest_m) : reach_m;
    const Vector3 way = support.end_m - support.start_m;
    const double length = way.norm();
    if (!(length > most)) continue;
    support.end_m = support.start_m + most / length * way;
    limited = true;
  }
  return limited;
}

Vector3 riding_velocity(std::span<const SupportedNodes> supports, const SpringLattice& lattice,
                        double time_s) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  const SupportedNodes* const rides_with = ridden(supports, lattice);
  return rides_with ? velocity_of(*rides_with, time_s) : Vector3::Zero();
}

void hand_to_supports(std::span<const SupportedNodes> supports, const LatticeView& view, double time_s) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  for (const SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const Vector3 velocity = velocity_of(support, time_s);
    for (const int n : support.nodes) set_velocity(view, n, velocity);
  }
}

void bear(std::span<SupportedNodes> supports, const SpringLattice& lattice, const LatticeView& view,
          const Vector3& gravity_m_per_s2, double h_s) {
  for (SupportedNodes& support : supports) {
    Vector3 force = Vector3::Zero();
    for (const int n : support.nodes) {
      force -= Vector3(view.fx[n], view.fy[n], view.fz[n]);
      force -= static_cast<double>(lattice.mass(n)) * gravity_m_per_s2;
    }
    support.impulse_ns += h_s * force;
  }
}

float place_supported(std::span<const SupportedNodes> supports, const LatticeView& view, double share,
                      float damping_time_s) {
  float moved_square = 0.0f;
  for (const SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const Vector3 way = support.start_m + share * (support.end_m - support.start_m);
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const float square = place_node(view, support.nodes[i], support.base_m[i] + way, damping_time_s);
      moved_square = std::max(moved_square, square);
    }
  }
  return moved_square;
}

}  // namespace spoonbill
