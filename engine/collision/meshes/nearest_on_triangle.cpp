#include "engine/collision/meshes/nearest_on_triangle.h"

#include <algorithm>

namespace spoonbill {

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

  // Through the normal: the products of lengths that save it lose all digits in slivers.
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
  // Never outside, whatever rounding does.
  const double of_a = std::max(past_bc, 0.0), of_b = std::max(past_ca, 0.0), of_c = std::max(past_ab, 0.0);
  const double sum = of_a + of_b + of_c;
  if (!(sum > 0.0)) return {a, On::corner, 0};
  return {a + (of_b / sum) * ab - (of_c / sum) * ca, On::face, 0};
}

}  // namespace spoonbill
