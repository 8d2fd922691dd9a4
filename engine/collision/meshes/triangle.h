// Whether two triangles meet, in double precision: the separating axes of both planes, of their edges against
// each other and, for coplanar ones, across their edges.
#pragma once

#include <array>

#include "engine/base/geometry.h"

namespace spoonbill {

using Triangle = std::array<Vector3, 3>;

inline Box bounding_box(const Triangle& t) {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}

// Touching counts as meeting. With a slack, in metres, also those that no plane separates by more than that:
// every pair nearer than the slack, and some a little farther apart where two corners face each other.
bool triangles_meet(const Triangle& a, const Triangle& b, double slack_m = 0.0);

}  // namespace spoonbill
