// Smooth curves through points: cubic splines with continuous curvature (de Boor 1978, chapter 4).
#pragma once

#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// End conditions of an open curve, for each coordinate: the first derivative is zero (level) or, by default,
// the second derivative is zero.
struct CurveEnds {
  bool level_x = false, level_y = false, level_z = false;
};

// A cubic spline. Immutable once made; any thread may read it.
class SmoothCurve {
 public:
  // Constructs an empty curve, to be assigned before any use.
  SmoothCurve() = default;

  // Makes a curve through at least two points, or three if closed, parametrised by chord length. A closed
  // curve continues from the last point to the first. Refuses too few points, and successive points that
  // coincide; the error numbers points from 1.
  static Result<SmoothCurve> through(std::vector<Vector3> points_m, bool closed, const CurveEnds& first = {},
                                     const CurveEnds& last = {});
  // Makes a curve with the given increasing parameters, which start at 0: one for each point and, for a
  // closed curve, one more for its end. Points may coincide.
  static SmoothCurve at_parameters(std::vector<Vector3> points_m, std::vector<double> parameters, bool closed,
                                   const CurveEnds& first = {}, const CurveEnds& last = {});

  bool closed() const { return closed_; }
  // Returns the largest parameter; the smallest is 0. For a curve made by through(), it is the sum of the
  // chord lengths.
  double end() const {
    SPOONBILL_ASSERT(!parameters_.empty());
    return parameters_.back();
  }

  Vector3 at(double t) const;
  Vector3 first_derivative(double t) const;
  Vector3 second_derivative(double t) const;

  // Returns the second derivatives at the points. They depend linearly on the points. If the points of two
  // curves with the same parameters are blended, the derivatives are therefore blended too.
  const std::vector<Vector3>& second_derivatives() const { return second_derivatives_; }

 private:
  struct Location {
    std::size_t piece;
    double length, fraction;
  };
  Location find_piece(double t) const;
  const Vector3& point(std::size_t k) const { return points_[k % points_.size()]; }
  const Vector3& second(std::size_t k) const { return second_derivatives_[k % second_derivatives_.size()]; }

  bool closed_ = false;
  std::vector<Vector3> points_, second_derivatives_;
  std::vector<double> parameters_;
};

}  // namespace spoonbill
