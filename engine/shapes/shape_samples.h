// Samples of an exact shape with what a fit asks of them. One owner.
#pragma once

#include <optional>

#include "engine/bspline/surface.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// The derivatives by differences of the function itself, one-sided at the ends of an open direction; the
// normal is zero where they are parallel, as at a pole.
struct ShapeTangents {
  Vector3 du, dv;
  Vector3 normal = Vector3::Zero();
};
ShapeTangents tangents(const ExactShape& shape, double u, double v);

// How far a point is from the shape: from the point at u, v by steps of Gauss and Newton along the tangents
// to a nearer one.
double distance_near(const ExactShape& shape, const Vector3& point_m, double u, double v);

// The unit normal at a pole, at the start or the end of v, where the shape has a tangent plane there.
std::optional<Vector3> pole_normal(const ExactShape& shape, bool at_start);

}  // namespace spoonbill
