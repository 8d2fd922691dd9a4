// The impulse of one contact in one substep.
#pragma once

#include <algorithm>
#include <optional>

#include "engine/pose.h"

namespace spoonbill {

// What one substep may do to a gap, as shares of it.
struct ContactPace {
  double closing;     // the most of a gap that may close
  double correction;  // of a penetration, how much is taken back
};

// Two points that may not pass each other: what they are like before the substep's drift.
struct ContactPush {
  double gap_m;      // below zero, how deep they have passed
  Vector3 normal;    // unit, along which they part
  Vector3 relative;  // velocity with which they part, m/s
  double mass_kg;    // effective: 1 / the sum of their compliances

  // That keeps them from passing, or takes back a share of what they have; pushes only. `cap` limits the
  // speed of taking back. Coulomb: friction stops the sliding where it can, and is the coefficient times the
  // push where it cannot.
  std::optional<Vector3> impulse(double h_s, const ContactPace& pace, double cap_m_per_s,
                                 double friction) const {
    const double separating = relative.dot(normal);
    const double wanted =
        gap_m > 0.0 ? -gap_m * pace.closing / h_s : std::min(-gap_m * pace.correction / h_s, cap_m_per_s);
    if (separating >= wanted) return std::nullopt;
    const double push = (wanted - separating) * mass_kg;
    const Vector3 sliding = relative - separating * normal;
    const double slide = sliding.norm() * mass_kg;
    const double drag = std::min(slide, friction * push);
    return push * normal - (slide > 0.0 ? drag / slide : 0.0) * mass_kg * sliding;
  }
};

}  // namespace spoonbill
