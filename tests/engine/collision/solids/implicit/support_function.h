// Properties of a convex solid that do not need its distance function: its support function, and its distance
// from a point, found from the support function by a search over all directions.
#pragma once

#include "engine/collision/solids/implicit_shapes.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {

// Returns the support function: how far the solid reaches along a unit direction. For a torus, it is that of
// the convex hull; for a half-space, it is infinite.
double support(const ImplicitShape& shape, const Vector3& direction);

// Returns the maximum of direction . point - support(direction), which is the signed distance of a convex
// solid. The search tries many directions, then finer ones around the best, so the result is a lower bound.
double distance_by_support(const ImplicitShape& shape, const Vector3& point);

// Returns a valid shape with dimensions of 1 to 100 mm, so it may be thin. `kind`, below convex_shape_kinds,
// selects one of the convex kinds, without the half-space.
ImplicitShape random_convex_shape(Random& random, int kind);
inline constexpr int convex_shape_kinds = 7;

// Returns a random unit vector.
Vector3 random_direction(Random& random);
// Returns a random point with coordinates from -1 to 1.
Vector3 random_in_cube(Random& random);
// Returns a rotation about a random axis by less than half a turn.
Quaternion random_turn(Random& random);

}  // namespace spoonbill
