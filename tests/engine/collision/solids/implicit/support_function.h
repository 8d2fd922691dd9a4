// What is known of a convex solid without its distance: its support function, and from it, by search over all
// directions, the distance.
#pragma once

#include "engine/collision/solids/implicit_shapes.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {

// The farthest that the solid reaches along a unit direction. Not for a torus or a half-space.
double support(const ImplicitShape& shape, const Vector3& direction);

// The largest of direction . point - support(direction): the signed distance of a convex solid, from below,
// by many directions and a search around the best of them.
double distance_by_support(const ImplicitShape& shape, const Vector3& point);

// Valid, of every convex kind but the half-space in turn, 1 to 100 mm, thin ones among them.
ImplicitShape random_convex_shape(Random& random, int kind);
inline constexpr int convex_shape_kinds = 7;

// Any of unit length, or within the unit cube.
Vector3 random_direction(Random& random);
Vector3 random_in_cube(Random& random);
// About any axis, by less than half a turn.
Quaternion random_turn(Random& random);

}  // namespace spoonbill
