// Solids as signed distances with gradients.
#pragma once

#include <limits>

#include "engine/base/geometry.h"

namespace spoonbill {

// Signed distance of a point and its gradient.
struct DistanceSample {
  double distance_m = 0.0;              // negative inside
  Vector3 gradient = Vector3::UnitY();  // unit; one of them if several directions lead to the nearest surface
};

// Signed distance of a solid in its own frame. Immutable; any thread. at() allocates nothing and never
// throws.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  // Returns the distance and its gradient. The distance changes by at most the distance moved, so its value
  // at the centre of a ball, minus the radius, is a lower bound within the ball.
  virtual DistanceSample at(const Vector3& point_m) const = 0;

  // Returns the distance if it is less than `enough_m`. Otherwise a convex solid may instead return the
  // distance to any bounding plane that is at least `enough_m` away, which saves time if the exact distance
  // is costly.
  virtual DistanceSample at_within(const Vector3& point_m, double enough_m) const {
    (void)enough_m;
    return at(point_m);
  }

  // Returns true if the distance exceeds limit_m, which must not be negative.
  virtual bool is_beyond(const Vector3& point_m, double limit_m) const {
    return at_within(point_m, limit_m).distance_m > limit_m;
  }

  // Returns true for a convex solid. The distance of a convex solid is nowhere below its tangents: at(a) +
  // gradient . (b - a) <= at(b), a much tighter bound than that by the distance moved.
  virtual bool is_convex() const = 0;

  // Returns a box around the solid; infinite if the solid is.
  virtual Box bounds() const = 0;

  // Returns a bound K of the concavity within the ball, in 1/m: at(a) + gradient . (b - a) - K |b - a|^2 / 2
  // <= at(b). Infinite if unknown.
  virtual double concavity(const Vector3& centre_m, double radius_m) const {
    (void)centre_m, (void)radius_m;
    return is_convex() ? 0.0 : std::numeric_limits<double>::infinity();
  }

 protected:
  SignedDistance() = default;
  SignedDistance(const SignedDistance&) = default;
  SignedDistance& operator=(const SignedDistance&) = default;
};

}  // namespace spoonbill
