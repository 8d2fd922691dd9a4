// Provides trim loops of known area.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/bspline/knot_vector.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

KnotVector open_domain(double start, double end);
KnotVector periodic_domain(double start, double end);
inline const KnotVector open_u = open_domain(0.0, 2.0), open_v = open_domain(-1.0, 1.0),
                        periodic_u = periodic_domain(0.0, 1.0);

// rectangle() returns the corners counter-clockwise, for an outer loop; backwards() reverses the order, for a
// hole.
std::vector<Eigen::Vector2d> rectangle(double low_u, double low_v, double high_u, double high_v);
std::vector<Eigen::Vector2d> backwards(std::vector<Eigen::Vector2d> points);

// Returns the closed polygon through the points. Fails whenever make_trim_loop() fails.
Result<TrimLoop> make_polygon_loop(const KnotVector& along_u, const KnotVector& along_v,
                                   const std::vector<Eigen::Vector2d>& points);
TrimLoop polygon_loop(const KnotVector& u, const KnotVector& v, const std::vector<Eigen::Vector2d>& points);

// Returns a periodic cubic curve with uniform knots whose `count` control points are evenly spaced on a
// circle. Use clockwise for a hole.
TrimLoop round_loop(const KnotVector& u, const KnotVector& v, const Eigen::Vector2d& middle, double radius,
                    int count, bool clockwise);

// Returns the area inside round_loop(). It is half the sum of the cross products of pairs of control points,
// each times the integral of one uniform cubic basis function times the derivative of another. These
// integrals are 245/720, 56/720 and 1/720 for neighbours one, two and three apart (derivatives of the
// B-spline of degree 7 at its knots).
double round_loop_area(double radius, int count);

}  // namespace spoonbill
