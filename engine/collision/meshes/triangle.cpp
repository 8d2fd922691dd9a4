#include "engine/collision/meshes/triangle.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

struct Span {
  double low, high;
};

Span span_along(const Triangle& triangle, const Vector3& axis) {
  const double a = axis.dot(triangle[0]), b = axis.dot(triangle[1]), c = axis.dot(triangle[2]);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

class Separation {
 public:
  Separation(const Triangle& a, const Triangle& b, double slack) : a_(a), b_(b), slack_(slack) {}

  bool along(const Vector3& axis) const {
    const Span a = span_along(a_, axis), b = span_along(b_, axis);
    const double gap = std::max(a.low - b.high, b.low - a.high);
    return gap > 0.0 && gap * gap > slack_ * slack_ * axis.squaredNorm();
  }

 private:
  const Triangle& a_;
  const Triangle& b_;
  double slack_;
};

}  // namespace

bool triangles_meet(const Triangle& first, const Triangle& second, double slack_m) {
  SPOONBILL_ASSERT_DEBUG(slack_m >= 0.0);
  // Seen from a corner, so that coordinates far from the origin cost no digits.
  const Vector3& origin = first[0];
  const Triangle a = {Vector3::Zero(), first[1] - origin, first[2] - origin};
  const Triangle b = {second[0] - origin, second[1] - origin, second[2] - origin};
  const Separation separated(a, b, slack_m);
  const std::array<Vector3, 3> edges_a = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const std::array<Vector3, 3> edges_b = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vector3 normal_a = edges_a[0].cross(edges_a[1]), normal_b = edges_b[0].cross(edges_b[1]);
  if (separated.along(normal_a) || separated.along(normal_b)) return false;
  for (const Vector3& edge_a : edges_a) {
    for (const Vector3& edge_b : edges_b) {
      if (separated.along(edge_a.cross(edge_b))) return false;
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (separated.along(normal_a.cross(edges_a[k])) || separated.along(normal_b.cross(edges_b[k]))) {
      return false;
    }
  }
  return true;
}

}  // namespace spoonbill
