// Whether two triangles meet, in double precision: the separating axes of both planes, of their edges against
// each other and, for coplanar ones, across their edges.
#pragma once

#include <array>

#include "engine/pose.h"

namespace spoonbill {

using Triangle = std::array<Vector3, 3>;

// Touching counts as meeting. With a slack, in metres, also those that no plane separates by more than that:
// every pair nearer than the slack, and some a little farther apart where two corners face each other.
bool triangles_meet(const Triangle& a, const Triangle& b, double slack_m = 0.0);

}  // namespace spoonbill
