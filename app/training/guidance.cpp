#include "app/training/guidance.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

Guidance::Guidance(std::vector<Vector3> path_m, double strength)
    : path_m_(std::move(path_m)), strength_(strength) {
  SPOONBILL_ASSERT(guidance_range.contains(strength));
}

Vector3 Guidance::force_n(const Vector3& position_m) const {
  if (path_m_.empty() || strength_ == 0.0) return Vector3::Zero();
  const Vector3 offset_m = find_nearest_on_path(path_m_, position_m) - position_m;
  const double distance_m = offset_m.norm();
  if (!(distance_m > 0.0)) return Vector3::Zero();
  const double force_n = std::min(largest_force_n, stiffness_n_per_m * distance_m);
  return strength_ * force_n / distance_m * offset_m;
}

Vector3 find_nearest_on_path(const std::vector<Vector3>& path_m, const Vector3& position_m) {
  SPOONBILL_ASSERT(!path_m.empty());
  Vector3 nearest_m = path_m.front();
  for (std::size_t k = 1; k < path_m.size(); ++k) {
    const Vector3 side_m = path_m[k] - path_m[k - 1];
    const double squared = side_m.squaredNorm();
    const double at =
        squared > 0.0 ? std::clamp((position_m - path_m[k - 1]).dot(side_m) / squared, 0.0, 1.0) : 0.0;
    const Vector3 point_m = path_m[k - 1] + at * side_m;
    if ((point_m - position_m).squaredNorm() < (nearest_m - position_m).squaredNorm()) nearest_m = point_m;
  }
  return nearest_m;
}

}  // namespace spoonbill
