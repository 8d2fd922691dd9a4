// The parameters of the surface points nearest to given points.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {

struct ClosestPoint {
  Vector2 uv = Vector2::Zero();
  double distance_m = 0.0;
  Vector3 point_m = Vector3::Zero();
};

// Holds what a search on one surface shares: the surface must outlive it and stay as it is. Any thread may
// ask.
class ClosestParameters {
 public:
  explicit ClosestParameters(const Surface& surface);
  ClosestParameters(const ClosestParameters&) = delete;
  ClosestParameters& operator=(const ClosestParameters&) = delete;

  // The stationary point that Gauss-Newton steps reach from a start, each shortened until it comes nearer and
  // none longer than half a span.
  ClosestPoint from(const Vector3& point, const Vector2& start, int steps) const;

  // From the nearest of the surface's samples.
  ClosestPoint anywhere(const Vector3& point, int steps) const;

 private:
  Vector3 position_at(const Vector2& uv) const;

  const Surface* surface_;
  PieceBasis u_, v_;
  Vector2 longest_step_;
  std::vector<Vector3> samples_;
  std::vector<Vector2> places_;
  NearestPoints nearest_;
};

}  // namespace spoonbill
