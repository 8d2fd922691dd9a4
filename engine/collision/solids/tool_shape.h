// The shapes of tools as signed distances: negative inside the tool.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// A sphere about `centre_m`; a point where the radius is 0; or the half-space behind a plane through
// `centre_m` with the unit normal `normal`; or any solid, its frame at `centre_m` and turned by `turn`.
struct ToolShape {
  enum class Kind { sphere, half_space, solid };
  Kind kind = Kind::sphere;
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 normal = Vector3::UnitX();
  const SignedDistance* made_of = nullptr;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  static ToolShape sphere(const Vector3& centre_m, double radius_m) {
    SPOONBILL_ASSERT(radius_m >= 0.0);
    ToolShape tool;
    tool.centre_m = centre_m;
    tool.radius_m = radius_m;
    return tool;
  }
  static ToolShape half_space(const Vector3& point_m, const Vector3& normal) {
    SPOONBILL_ASSERT(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
    ToolShape tool;
    tool.kind = Kind::half_space;
    tool.centre_m = point_m;
    tool.normal = normal;
    return tool;
  }
  // The solid must outlive the tool.
  static ToolShape solid(const SignedDistance& made_of, const Pose& pose) {
    return solid(made_of, pose.position_m, pose.orientation.normalized().toRotationMatrix());
  }
  // Its frame may also be mirrored.
  static ToolShape solid(const SignedDistance& made_of, const Vector3& centre_m,
                         const Eigen::Matrix3d& turn) {
    ToolShape tool;
    tool.kind = Kind::solid;
    tool.centre_m = centre_m;
    tool.made_of = &made_of;
    tool.turn = turn;
    return tool;
  }

  bool is_solid() const { return kind == Kind::solid; }

  // Changes by at most the distance moved, which is what makes a ball's bound distance(centre) - radius.
  double distance(const Vector3& point) const {
    if (is_solid()) return made_of->at(into_frame(point)).distance_m;
    return kind == Kind::sphere ? (point - centre_m).norm() - radius_m : normal.dot(point - centre_m);
  }

  // The same where it is less than `enough`; beyond, a lower bound of it that is at least so far.
  double distance_within(const Vector3& point, double enough) const {
    return is_solid() ? made_of->at_within(into_frame(point), enough).distance_m : distance(point);
  }

  // Whether no point of a ball is within `reach`, which is not below 0.
  bool is_beyond(const Vector3& centre, double radius, double reach) const {
    return is_solid() ? made_of->is_beyond(into_frame(centre), reach + radius)
                      : distance(centre) - radius > reach;
  }

  // Of a solid alone, in the world frame.
  DistanceSample at_within(const Vector3& point, double enough) const {
    const DistanceSample sample = made_of->at_within(into_frame(point), enough);
    return {sample.distance_m, turn * sample.gradient};
  }
  DistanceSample at(const Vector3& point) const {
    const DistanceSample sample = made_of->at(into_frame(point));
    return {sample.distance_m, turn * sample.gradient};
  }
  Vector3 into_frame(const Vector3& point) const { return turn.transpose() * (point - centre_m); }
};

}  // namespace spoonbill
