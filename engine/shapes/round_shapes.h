// Starting shapes that are turned about the y axis, and the torus. The origin is their middle.
#pragma once

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

Result<ExactShape> sphere_shape(double radius_m);

struct CylinderSize {
  double radius_m = 0.02, height_m = 0.06;
  double rounding_m = 0.002;  // of both edges; at most the radius and half the height
};
Result<ExactShape> cylinder_shape(const CylinderSize& size);

// A cone, or with a top a part of one. Radii and height are those of the sharp one, which the roundings lie
// within: that of the tip, or of the edges about both faces.
struct ConeSize {
  double radius_m = 0.03, height_m = 0.06;
  double top_radius_m = 0.0;
  double rounding_m = 0.003;
};
Result<ExactShape> cone_shape(const ConeSize& size);

// Closed both ways: u around the tube, v around the ring, which lies level. Refused: a tube as thick as the
// ring is wide.
struct TorusSize {
  double ring_radius_m = 0.04, tube_radius_m = 0.01;
};
Result<ExactShape> torus_shape(const TorusSize& size);

// The rounding that a cylinder or cone gets where none is named.
double usual_rounding_m(const CylinderSize& size);
double usual_rounding_m(const ConeSize& size);

}  // namespace spoonbill
