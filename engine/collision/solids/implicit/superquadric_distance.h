// The signed distance of a superquadric, for which there is no closed form.
#pragma once

#include "engine/collision/solids/implicit/implicit_shapes.h"

namespace spoonbill {

// With q1 = 2 / e1, q2 = 2 / e2 the solid is where |(|(x/a, z/c)|_q2, y/b)|_q1 <= 1: a ball of nested norms.
//
// Outside, the nearest point x of p solves p_i - x_i = mu_i |x_i / a_i|^(q-1) / a_i with one multiplier mu
// for x and z and another, lambda, for y: each of these has one root by itself. The multipliers hang together
// by lambda = mu rho^(q2-q1), rho = |(x/a, z/c)|_q2. Minimising the distance for a given price lambda of the
// constraint is convex, so that lambda and mu grow together, and one equation in mu remains, monotone.
//
// Inside, the distance has several local minima over the surface. Each is searched by Newton's method from a
// start of its own, on the surface's shares (below), and of every point found the tangent plane counts.
class SuperquadricDistance final : public SignedDistance {
 public:
  explicit SuperquadricDistance(const SuperquadricShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  // By the tangent plane where the ray from the middle leaves the solid, if that tells.
  DistanceSample at_within(const Vector3& point_m, double enough_m) const override;
  // Most that are not are inside, which the gauge tells.
  bool is_beyond(const Vector3& point_m, double limit_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-axes_, axes_}; }

 private:
  // A point of the surface in the first octant: (x/a)^q2 : (z/c)^q2 = share : 1 - share, and rho^q1 :
  // (y/b)^q1 likewise, both as log(share / (1 - share)), so that none is lost near an edge.
  struct Spot {
    double around, along;
  };
  struct Expansion;

  double log_gauge(const Vector3& point) const;
  DistanceSample outside(const Vector3& point) const;
  DistanceSample inside(const Vector3& point) const;
  DistanceSample at_surface(const Vector3& point) const;
  Spot radial(const Vector3& point) const;
  Spot foot(const Vector3& point, int axis) const;
  void expand(const Spot& spot, const Vector3& point, Expansion& out) const;
  DistanceSample tangent(const Spot& spot, const Vector3& point) const;
  Spot improve(Spot spot, const Vector3& point) const;

  Vector3 axes_, log_axes_;
  double along_, around_;  // q1, q2
};

}  // namespace spoonbill
