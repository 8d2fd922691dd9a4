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
  // Coordinates are relative to a corner, so that a large distance from the origin costs no precision.
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

NearestOnTriangle nearest_on_triangle(const Vector3& a, const Vector3& b, const Vector3& c,
                                      const Vector3& point) {
  using On = NearestOnTriangle::On;
  const Vector3 ab = b - a, bc = c - b, ca = a - c;
  const Vector3 ap = point - a, bp = point - b, cp = point - c;
  const double along_ab = ab.dot(ap), along_bc = bc.dot(bp), along_ca = ca.dot(cp);
  const double before_ab = -ab.dot(bp), before_bc = -bc.dot(cp), before_ca = -ca.dot(ap);
  if (along_ab <= 0.0 && before_ca <= 0.0) return {a, On::corner, 0};
  if (along_bc <= 0.0 && before_ab <= 0.0) return {b, On::corner, 1};
  if (along_ca <= 0.0 && before_bc <= 0.0) return {c, On::corner, 2};

  // The barycentric weights are computed from the normal. Formulas with dot products alone lose all digits in
  // slivers.
  const Vector3 normal = ab.cross(-ca);
  const double past_ab = normal.dot(ab.cross(ap)), past_bc = normal.dot(bc.cross(bp)),
               past_ca = normal.dot(ca.cross(cp));
  if (past_ab <= 0.0 && along_ab >= 0.0 && before_ab >= 0.0) {
    return {a + along_ab / (along_ab + before_ab) * ab, On::side, 0};
  }
  if (past_bc <= 0.0 && along_bc >= 0.0 && before_bc >= 0.0) {
    return {b + along_bc / (along_bc + before_bc) * bc, On::side, 1};
  }
  if (past_ca <= 0.0 && along_ca >= 0.0 && before_ca >= 0.0) {
    return {c + along_ca / (along_ca + before_ca) * ca, On::side, 2};
  }
  // Negative weights are set to zero, so that rounding cannot move the point out of the triangle.
  const double weight_a = std::max(past_bc, 0.0), weight_b = std::max(past_ca, 0.0),
               weight_c = std::max(past_ab, 0.0);
  const double sum = weight_a + weight_b + weight_c;
  if (!(sum > 0.0)) return {a, On::corner, 0};
  return {a + (weight_b / sum) * ab - (weight_c / sum) * ca, On::face, 0};
}

}  // namespace spoonbill
