// The signed distance of an ellipsoid, by its one scalar equation.
#pragma once

#include "engine/collision/solids/implicit/implicit_shapes.h"

namespace spoonbill {

// With the semi-axes e_i and the shortest e_m, the point of the surface nearest to y is
// x_i = r_i y_i / (w + r_i - 1), r_i = (e_i / e_m)^2, where w >= 0 solves sum (x_i / e_i)^2 = 1 (Eberly 2013,
// who writes s for w - 1). Written by w, nothing cancels inside, where w goes to 0; and y_i - x_i =
// y_i (w - 1) / (w + r_i - 1), so that nothing cancels near the surface either.
class EllipsoidDistance final : public SignedDistance {
 public:
  explicit EllipsoidDistance(const EllipsoidShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-axes_, axes_}; }

 private:
  DistanceSample in_middle(const Vector3& point_m) const;
  double solve(const Vector3& scaled, double low) const;

  Vector3 axes_;
  int shortest_ = 0;
  Vector3 ratio_, excess_;  // r_i, r_i - 1
};

}  // namespace spoonbill
