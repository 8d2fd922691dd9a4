// Solids as signed distances with their gradient: what a tool may be made of.
#pragma once

#include <limits>

#include "engine/base/geometry.h"

namespace spoonbill {

struct DistanceSample {
  double distance_m = 0.0;              // negative inside
  Vector3 gradient = Vector3::UnitY();  // unit; where several ways lead to the surface, that of one of them
};

// A solid in its own frame. Never changes once made, so any thread may ask; at() allocates nothing and never
// throws.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  // Changes by at most the distance moved, which is what makes a ball's bound at(centre) - radius.
  virtual DistanceSample at(const Vector3& point_m) const = 0;

  // The same where the distance is less than enough_m. Beyond, a convex solid may answer by any plane that
  // leaves it on one side and is at least so far: for solids whose distance takes long.
  virtual DistanceSample at_within(const Vector3& point_m, double enough_m) const {
    (void)enough_m;
    return at(point_m);
  }

  // Whether the distance is more than limit_m, which is not below 0.
  virtual bool is_beyond(const Vector3& point_m, double limit_m) const {
    return at_within(point_m, limit_m).distance_m > limit_m;
  }

  // Of a convex solid the distance lies above each of its tangents: at(a) + gradient . (b - a) <= at(b),
  // which bounds it far better than the way moved alone.
  virtual bool is_convex() const = 0;

  // About the solid; infinite where the solid is.
  virtual Box bounds() const = 0;

  // K per metre, such that at(a) + gradient . (b - a) - K |b - a|^2 / 2 <= at(b) within the ball: how far a
  // tangent can fail a solid that is not convex. Infinite where that is not known.
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
