#include "engine/collision/levels/patch_distance.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace spoonbill {
namespace {

Vector3 centre_of(const PatchCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

// How far the corners of b lie before those of a along a direction of any length.
double gap_along(const Vector3& direction, const PatchCorners& a, const PatchCorners& b) {
  double last_a = -std::numeric_limits<double>::infinity(), first_b = -last_a;
  for (const Vector3& corner : a) last_a = std::max(last_a, direction.dot(corner));
  for (const Vector3& corner : b) first_b = std::min(first_b, direction.dot(corner));
  return first_b - last_a;
}

Vector3 normal_of(const PatchCorners& corners) {
  return (corners[3] - corners[0]).cross(corners[2] - corners[1]);
}

// Of the corners, in pairs.
constexpr std::array<std::array<std::size_t, 2>, 4> sides = {{{0, 1}, {1, 3}, {3, 2}, {2, 0}}};

}  // namespace

double patch_distance(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b) {
  const Vector3 apart = centre_of(b) - centre_of(a);
  const Vector3 normal_a = normal_of(a), normal_b = normal_of(b);
  double gap = 0.0;
  for (const Vector3& direction : {apart, normal_a, normal_b}) {
    const double length = direction.norm();
    if (!(length > 0.0)) continue;
    const Vector3 towards = (apart.dot(direction) < 0.0 ? -1.0 : 1.0) / length * direction;
    gap = std::max(gap, gap_along(towards, a, b));
  }
  return gap - bulge_a - bulge_b;
}

double patch_distance_aside(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b) {
  const Vector3 apart = centre_of(b) - centre_of(a);
  double gap = 0.0;
  for (const PatchCorners* patch : {&a, &b}) {
    const Vector3 normal = normal_of(*patch);
    for (const auto& [from, to] : sides) {
      const Vector3 direction = normal.cross((*patch)[to] - (*patch)[from]);
      const double length = direction.norm();
      if (!(length > 0.0)) continue;
      const Vector3 towards = (apart.dot(direction) < 0.0 ? -1.0 : 1.0) / length * direction;
      gap = std::max(gap, gap_along(towards, a, b));
    }
  }
  return gap - bulge_a - bulge_b;
}

}  // namespace spoonbill
