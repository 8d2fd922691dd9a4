// The impulse of one contact in one substep.
#pragma once

#include <algorithm>
#include <optional>

#include "engine/base/geometry.h"

namespace spoonbill {

// What one substep may do to a gap, as shares of it.
struct ContactPace {
  double closing;     // the most of a gap that may close
  double correction;  // of a penetration, how much is taken back
};

// On the ground each node has a contact of its own, and meets it as soon as it can.
inline constexpr ContactPace ground_pace{1.0, 0.7};

// Two points that may not pass each other: what they are like before the substep's drift.
struct ContactPush {
  double gap_m;      // below zero, how deep they have passed
  Vector3 normal;    // unit, along which they part
  Vector3 relative;  // velocity with which they part, m/s
  double mass_kg;    // effective: 1 / the sum of their compliances

  // Of the speed with which they part, what they must have at least: so that they do not pass, or take back a
  // share of what they have. `cap` limits the speed of taking back.
  double wanted_m_per_s(double h_s, const ContactPace& pace, double cap_m_per_s) const {
    return gap_m > 0.0 ? -gap_m * pace.closing / h_s : std::min(-gap_m * pace.correction / h_s, cap_m_per_s);
  }
  // That gives them the speed; pushes only.
  double normal_impulse(double h_s, const ContactPace& pace, double cap_m_per_s) const {
    return std::max(0.0, (wanted_m_per_s(h_s, pace, cap_m_per_s) - relative.dot(normal)) * mass_kg);
  }
  // That stops the sliding, but for `most_ns`: to be taken off.
  Vector3 drag(double most_ns) const {
    const Vector3 sliding = relative - relative.dot(normal) * normal;
    const double slide = sliding.norm() * mass_kg;
    return (slide > 0.0 ? std::min(slide, most_ns) / slide : 0.0) * mass_kg * sliding;
  }

  // Both. Coulomb: friction stops the sliding where it can, and is the coefficient times the push where it
  // cannot.
  std::optional<Vector3> impulse(double h_s, const ContactPace& pace, double cap_m_per_s,
                                 double friction) const {
    const double separating = relative.dot(normal);
    const double wanted = wanted_m_per_s(h_s, pace, cap_m_per_s);
    if (separating >= wanted) return std::nullopt;
    const double push = (wanted - separating) * mass_kg;
    return push * normal - drag(friction * push);
  }
};

}  // namespace spoonbill
