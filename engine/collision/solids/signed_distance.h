// Solids as signed distances with gradients.
#pragma once

#include <limits>

#include "engine/base/geometry.h"

namespace spoonbill {

// Signed distance from a point to a solid, and its gradient.
struct DistanceSample {
  double distance_m = 0.0;  // negative inside
  // Unit vector. If several points of the solid's surface are nearest, the gradient belongs to one of them.
  Vector3 gradient = Vector3::UnitY();
};

// Signed distance of a solid in its own frame. Immutable, so any thread may use it. at() allocates nothing
// and never throws.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  // Returns the distance and its gradient at a point. When the point moves, the distance changes by at most
  // the distance moved. The value at the centre of a ball, minus the radius, is therefore a lower bound
  // within the ball.
  virtual DistanceSample at(const Vector3& point_m) const = 0;

  // Returns the distance if it is less than `enough_m`. If it is not, a convex solid may return the distance
  // to any bounding plane that is at least `enough_m` away, which saves time if the exact distance is costly.
  virtual DistanceSample at_within(const Vector3& point_m, double enough_m) const {
    (void)enough_m;
    return at(point_m);
  }

  // Returns true if the distance exceeds limit_m, which must not be negative.
  virtual bool is_beyond(const Vector3& point_m, double limit_m) const {
    return at_within(point_m, limit_m).distance_m > limit_m;
  }

  // Returns true for a convex solid. The distance of a convex solid is nowhere below its tangents: at(a) +
  // gradient . (b - a) <= at(b). This bound is much tighter than at(a) - |b - a|.
  virtual bool is_convex() const = 0;

  // Returns a box around the solid; an infinite box if the solid is unbounded.
  virtual Box bounds() const = 0;

  // Returns a bound K, in 1/m, of the concavity of the distance within a ball: at(a) + gradient . (b - a) - K
  // |b - a|^2 / 2 <= at(b). Infinite if unknown.
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
