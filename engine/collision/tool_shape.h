// The shapes of tools as signed distances: negative inside the tool.
#pragma once

#include "engine/pose.h"

namespace spoonbill {

// A sphere about `centre_m`; a point where the radius is 0; or the half-space behind a plane through
// `centre_m` with the unit normal `normal`.
struct ToolShape {
  enum class Kind { sphere, half_space };
  Kind kind = Kind::sphere;
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 normal = Vector3::UnitX();

  static ToolShape sphere(const Vector3& centre_m, double radius_m) {
    return {Kind::sphere, centre_m, radius_m, Vector3::UnitX()};
  }
  static ToolShape half_space(const Vector3& point_m, const Vector3& normal) {
    return {Kind::half_space, point_m, 0.0, normal};
  }

  // Changes by at most the distance moved, which is what makes a ball's bound distance(centre) - radius.
  double distance(const Vector3& point) const {
    return kind == Kind::sphere ? (point - centre_m).norm() - radius_m : normal.dot(point - centre_m);
  }
};

}  // namespace spoonbill
