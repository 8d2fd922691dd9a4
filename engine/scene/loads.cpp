#include "engine/scene/loads.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

// Returns the sine of an angle in turns. A Taylor series is used for the first quarter turn; its truncation
// error is below 1e-17. The C library's sine depends on the processor. It must not be used for motions,
// because they enter the state of the simulation.
double sine_of_turns(double turns) {
  double t = turns - std::floor(turns);
  if (t > 0.5) return -sine_of_turns(t - 0.5);
  if (t > 0.25) t = 0.5 - t;
  const double x = 2.0 * std::numbers::pi * t, square = x * x;
  double term = x, sum = x;
  for (int k = 1; k <= 10; ++k) {
    term *= -square / (2.0 * k * (2.0 * k + 1.0));
    sum += term;
  }
  return sum;
}

struct LoadChecker {
  template <class RegionLoad>
  Status operator()(const RegionLoad& load) const {
    if (Status status = check_region(load.region); !status.ok()) return status;
    return check_fields("", load);
  }
  // Checks the force only: the limits of u and v depend on the body, and check_loads() checks them.
  Status operator()(const PointLoad& load) const {
    return check_value("", field_of(&PointLoad::force_n).form, load.force_n);
  }
};

Status check_motion(const SupportMotion& motion) {
  if (Status status = check_fields("", motion); !status.ok()) return status;
  const double speed = top_speed_m_per_s(motion);
  if (speed <= motion_speed_limit_m_per_s) return {};
  return Error{ErrorCode::out_of_range,
               "motion reaches " + number_text(speed) + " m/s, must be at most " +
                   number_text(motion_speed_limit_m_per_s) + "; shorten the displacement or allow more time",
               "motion"};
}

}  // namespace

Vector3 displacement_at(const SupportMotion& motion, double time_s) {
  SPOONBILL_ASSERT(time_s >= 0.0);
  if (motion.kind == MotionKind::ramp) return smooth_step(time_s / motion.duration_s) * motion.displacement_m;
  const double turns = time_s * motion.frequency_hz;
  return smooth_step(turns) * sine_of_turns(turns) * motion.displacement_m;
}

// A ramp is fastest at half its duration, where its speed is 15/8 of its mean speed. An oscillation is never
// faster while it grows than at its full amplitude.
double top_speed_m_per_s(const SupportMotion& motion) {
  const double distance_m = motion.displacement_m.norm();
  if (motion.kind == MotionKind::ramp) return 1.875 * distance_m / motion.duration_s;
  return 2.0 * std::numbers::pi * motion.frequency_hz * distance_m;
}

Status check_fixing_plane(const FixingPlane& plane) {
  return check_fields("fixing plane: ", plane);
}

Status check_load(const Load& load) {
  return std::visit(LoadChecker{}, load);
}

Status check_support(const Support& support) {
  if (Status status = check_region(support.region); !status.ok()) return status;
  return support.motion ? check_motion(*support.motion) : Status();
}

Status check_ground(const Ground& ground) {
  return check_fields("ground: ", ground);
}

}  // namespace spoonbill
