#include "render/tessellation/facing_order.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <limits>

namespace spoonbill {
namespace {

constexpr std::uint32_t bucket_count = 1U << 14;

}  // namespace

void FacingOrder::find_facing(const ToolMesh& mesh, const Eigen::Vector3f& eye_m) {
  facing_.clear();
  float nearest_m = std::numeric_limits<float>::max();
  farthest_m_ = 0.0F;
  const auto at = [&](std::size_t i) -> const Eigen::Vector3f& {
    return mesh.vertices[mesh.indices[i]].position_m;
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Eigen::Vector3f &a = at(i), &b = at(i + 1), &c = at(i + 2);
    if (!((b - a).cross(c - a).dot(eye_m - a) > 0.0F)) continue;
    const float distance_m = ((a + b + c) / 3.0F - eye_m).norm();
    nearest_m = std::min(nearest_m, distance_m);
    farthest_m_ = std::max(farthest_m_, distance_m);
    facing_.push_back({distance_m, static_cast<std::uint32_t>(i)});
  }
  const float range_m = farthest_m_ - nearest_m;
  buckets_per_m_ = range_m > 0.0F ? static_cast<float>(bucket_count) / range_m : 0.0F;
}

// Without an order where a distance is too large for one.
std::uint32_t FacingOrder::bucket_of(float distance_m) const {
  const float bucket = (farthest_m_ - distance_m) * buckets_per_m_;
  if (!(bucket > 0.0F)) return 0;
  return bucket < static_cast<float>(bucket_count) ? static_cast<std::uint32_t>(bucket) : bucket_count - 1;
}

const std::vector<std::uint32_t>& FacingOrder::of(const ToolMesh& mesh, const Eigen::Vector3f& eye_m) {
  find_facing(mesh, eye_m);
  ends_.assign(bucket_count, 0);
  for (const Facing& triangle : facing_) ++ends_[bucket_of(triangle.distance_m)];
  for (std::uint32_t b = 1; b < bucket_count; ++b) ends_[b] += ends_[b - 1];
  indices_.resize(3 * facing_.size());
  for (auto triangle = facing_.rbegin(); triangle != facing_.rend(); ++triangle) {
    const std::size_t place = 3 * static_cast<std::size_t>(--ends_[bucket_of(triangle->distance_m)]);
    std::copy_n(mesh.indices.begin() + triangle->first_index, 3,
                indices_.begin() + static_cast<std::ptrdiff_t>(place));
  }
  return indices_;
}

}  // namespace spoonbill
