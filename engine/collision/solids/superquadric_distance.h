// Signed distance of a superquadric, which has no closed form.
#pragma once

#include "engine/collision/solids/implicit_shapes.h"

namespace spoonbill {

// Signed distance of the solid |(|(x/a, z/c)|_q2, y/b)|_q1 <= 1 with q1 = 2 / e1 and q2 = 2 / e2, the unit
// ball of nested norms.
//
// Outside, the surface point x nearest to p satisfies p_i - x_i = mu_i |x_i / a_i|^(q-1) / a_i. The
// multiplier mu_i is mu for x and z, and lambda for y. Each of these equations has one root. The multipliers
// are related by lambda = mu rho^(q2-q1), where rho = |(x/a, z/c)|_q2. For a given lambda, which acts as a
// price of violating the constraint, the minimisation is convex, so lambda and mu increase together. Only one
// monotone equation in mu remains to be solved.
//
// Inside, the distance to the surface has several local minima. Newton's method searches for them from
// several starting points, in logit coordinates of the surface (Spot). The nearest of the tangent planes at
// the points found gives the distance.
class SuperquadricDistance final : public SignedDistance {
 public:
  explicit SuperquadricDistance(const SuperquadricShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  // Returns the distance to a tangent plane if that distance is at least `enough_m`; otherwise the distance
  // to the solid. The plane touches the solid where the ray from the solid's centre to the point leaves the
  // solid.
  DistanceSample at_within(const Vector3& point_m, double enough_m) const override;
  // Returns true if the distance exceeds `limit_m`. For a point inside the solid, returns false without
  // computing the distance.
  bool is_beyond(const Vector3& point_m, double limit_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-axes_, axes_}; }

 private:
  // A point of the surface in the first octant, in coordinates that keep their precision near an edge.
  // `around` is the logit of (x/a)^q2 / ((x/a)^q2 + (z/c)^q2). `along` is the logit of rho^q1 / (rho^q1 +
  // (y/b)^q1), where rho = |(x/a, z/c)|_q2.
  struct Spot {
    double around, along;
  };
  struct Expansion;

  double log_gauge(const Vector3& point) const;
  DistanceSample outside(const Vector3& point) const;
  DistanceSample inside(const Vector3& point) const;
  DistanceSample at_surface(const Vector3& point) const;
  Spot radial_exit(const Vector3& point) const;
  Spot axis_exit(const Vector3& point, int axis) const;
  void expand(const Spot& spot, const Vector3& point, Expansion& out) const;
  DistanceSample tangent(const Spot& spot, const Vector3& point) const;
  Spot improve(Spot spot, const Vector3& point) const;

  Vector3 axes_, log_axes_;
  double along_, around_;  // the exponents q1 and q2
};

}  // namespace spoonbill
