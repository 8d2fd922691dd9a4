#include "haptic/recording/script.h"

#include <algorithm>

namespace spoonbill {

namespace {

// Starts and ends at rest with no jump in acceleration (minimum jerk).
double eased(double t) {
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

// The normalised blend of the two along the shorter way: no sine, so no difference among machines.
Quaternion blended(const Quaternion& from, const Quaternion& to, double share) {
  const double sign = from.dot(to) < 0.0 ? -1.0 : 1.0;
  Quaternion blend;
  blend.coeffs() = (1.0 - share) * from.coeffs() + (sign * share) * to.coeffs();
  return blend.normalized();
}

}  // namespace

HandTarget Script::target_at(std::uint64_t tick) const {
  if (motions.empty()) return start;
  if (tick >= motions.back().end) return motions.back().to;
  const auto motion =
      std::upper_bound(motions.begin(), motions.end(), tick,
                       [](std::uint64_t value, const ScriptMotion& m) { return value < m.end; });
  const double share =
      eased(static_cast<double>(tick + 1 - motion->begin) / static_cast<double>(motion->end - motion->begin));
  HandTarget target = motion->from;
  const Vector3& from_m = motion->from.pose.position_m;
  target.pose.position_m = from_m + share * (motion->to.pose.position_m - from_m);
  target.pose.orientation = blended(motion->from.pose.orientation, motion->to.pose.orientation, share);
  return target;
}

}  // namespace spoonbill
