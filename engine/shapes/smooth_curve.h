// A curve through points: a cubic spline with continuous curvature, by the lengths of the chords between them
// (de Boor 1978, chapter 4). Immutable once made; any thread may read it.
#pragma once

#include <vector>

#include "engine/base/assert.h"
#include "engine/base/pose.h"
#include "engine/base/result.h"

namespace spoonbill {

// How an open curve ends, by coordinate: straight (no second derivative) or level (no first one).
struct CurveEnds {
  bool level_x = false, level_y = false, level_z = false;
};

class SmoothCurve {
 public:
  // No curve; to be assigned before anything is asked of it.
  SmoothCurve() = default;

  // Through at least two points, three of a closed one, which goes on from the last to the first. Refused:
  // too few of them, two following ones in one place, naming them by their number from 1.
  static Result<SmoothCurve> through(std::vector<Vector3> points_m, bool closed, const CurveEnds& first = {},
                                     const CurveEnds& last = {});
  // The same at parameters of one's own, which increase; a closed one has one more than points, its end.
  // The points may coincide.
  static SmoothCurve at_parameters(std::vector<Vector3> points_m, std::vector<double> parameters, bool closed,
                                   const CurveEnds& first = {}, const CurveEnds& last = {});

  bool closed() const { return closed_; }
  // The sum of the chords: parameters run from 0 to it.
  double end() const {
    SPOONBILL_ASSERT(!parameters_.empty());
    return parameters_.back();
  }

  Vector3 at(double t) const;
  Vector3 first_derivative(double t) const;
  Vector3 second_derivative(double t) const;

  // By the points, the second derivatives there: what is linear in the points can be blended.
  const std::vector<Vector3>& bends() const { return bends_; }

 private:
  struct Place {
    std::size_t piece;
    double length, share;
  };
  Place place_of(double t) const;
  const Vector3& point(std::size_t k) const { return points_[k % points_.size()]; }
  const Vector3& bend(std::size_t k) const { return bends_[k % bends_.size()]; }

  bool closed_ = false;
  std::vector<Vector3> points_, bends_;
  std::vector<double> parameters_;
};

}  // namespace spoonbill
