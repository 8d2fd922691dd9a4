// Velocity constraint between two points that may push each other but never pull. All contacts use it.
#pragma once

#include <algorithm>
#include <span>

#include "engine/base/geometry.h"

namespace spoonbill {

// Limits on how fast a contact changes its gap.
struct ContactPace {
  double closing;           // largest fraction of a gap that may close in a substep
  double correction_per_s;  // rate of correcting a penetration, at most max_correction of it in a substep
};

// Largest fraction of a penetration that a substep corrects. It is below 1, so that neighbouring points that
// push the same node do not overshoot together.
inline constexpr double max_correction = 0.7;

// State of a contact between two points before the drift of a substep, and the impulse that keeps the points
// from passing each other.
struct ContactPush {
  double gap_m;                    // distance of the points; negative if they penetrate
  Vector3 normal;                  // unit vector along which the points separate
  Vector3 relative;                // separation velocity, m/s
  double mass_kg;                  // effective mass, which is 1 / the sum of the points' compliances (1/kg)
  double slide_mass_kg = mass_kg;  // the same for sliding; smaller where it depends on the direction

  // Returns the smallest admissible separation speed, m/s. Points with a gap may approach but must not pass
  // each other. A penetration is partly corrected, at `cap_m_per_s` at most.
  double target_m_per_s(double h_s, const ContactPace& pace, double cap_m_per_s) const {
    if (gap_m > 0.0) return -gap_m * pace.closing / h_s;
    return std::min(-gap_m * std::min(pace.correction_per_s, max_correction / h_s), cap_m_per_s);
  }
  // Returns the impulse along the normal with which the points reach the smallest admissible separation
  // speed, N s; never negative. It includes the impulse `started_ns`, which has already acted.
  double normal_impulse(double h_s, const ContactPace& pace, double cap_m_per_s, double started_ns) const {
    const double missing = target_m_per_s(h_s, pace, cap_m_per_s) - relative.dot(normal);
    return std::max(0.0, started_ns + missing * mass_kg);
  }
  // Returns the friction impulse that stops the sliding, limited to `max_ns`. It includes `started_ns`, which
  // has already acted. Subtract it from the normal impulse. By Coulomb's law, the limit is the friction
  // coefficient times the normal impulse.
  Vector3 drag(double max_ns, const Vector3& started_ns = Vector3::Zero()) const {
    const Vector3 stop = started_ns + slide_mass_kg * (relative - relative.dot(normal) * normal);
    const double size = stop.norm();
    return (size > max_ns ? max_ns / size : 1.0) * stop;
  }
};

// Kind of solver that advances the lattices of a contact. `solvers`: the contact is solved once a step,
// because each lattice is stepped implicitly, or is the frame of a fixed body beside one that is. `springs`:
// at least one lattice is stepped explicitly by its springs, and the contact is solved in each substep.
enum class MovedBy { springs, solvers };

// One pass over the contacts. It solves each contact of the kind `moved_by` once.
struct ContactPass {
  double h_s;
  MovedBy moved_by;
  // Solves the constraints from last to first. A pass favours the constraints that it solves last; a second,
  // reversed pass balances this.
  bool is_reversed;
  std::span<const float> push_speed_caps_m_per_s;  // largest correction speed for each body
  bool is_of_implicit = false;                     // skips contacts of which no body is stepped implicitly
};

}  // namespace spoonbill
