// Tool shapes as signed distances, negative inside the tool, and lower bounds of the distance over boxes and
// patches.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// A tool of one of three kinds. A sphere is centred on `centre_m`, and is a point if its radius is 0. A
// half-space is behind the plane through `centre_m` with the unit normal `normal`. A solid has its frame at
// `centre_m`, rotated by `turn`.
struct ToolShape {
  enum class Kind { sphere, half_space, solid };
  Kind kind = Kind::sphere;
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 normal = Vector3::UnitX();
  const SignedDistance* distance_field = nullptr;
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
  static ToolShape solid(const SignedDistance& distance_field, const Pose& pose) {
    return solid(distance_field, pose.position_m, pose.orientation.normalized().toRotationMatrix());
  }
  // `turn` must be orthogonal and may mirror the frame. The solid must outlive the tool.
  static ToolShape solid(const SignedDistance& distance_field, const Vector3& centre_m,
                         const Eigen::Matrix3d& turn) {
    ToolShape tool;
    tool.kind = Kind::solid;
    tool.centre_m = centre_m;
    tool.distance_field = &distance_field;
    tool.turn = turn;
    return tool;
  }

  bool is_solid() const { return kind == Kind::solid; }

  // Returns the signed distance. It changes by at most the distance moved, so its value at the centre of a
  // ball, minus the radius, is a lower bound within the ball.
  double distance(const Vector3& point) const {
    if (is_solid()) return distance_field->at(into_frame(point)).distance_m;
    return kind == Kind::sphere ? (point - centre_m).norm() - radius_m : normal.dot(point - centre_m);
  }

  // Returns the distance if it is less than `enough`; otherwise a lower bound of it that is at least
  // `enough`.
  double distance_within(const Vector3& point, double enough) const {
    return is_solid() ? distance_field->at_within(into_frame(point), enough).distance_m : distance(point);
  }

  // Returns true if no point of a ball is within `reach`, which must not be negative.
  bool is_beyond(const Vector3& centre, double radius, double reach) const {
    return is_solid() ? distance_field->is_beyond(into_frame(centre), reach + radius)
                      : distance(centre) - radius > reach;
  }

  // Returns distance and gradient in the world frame. Only for a solid. See SignedDistance::at_within().
  DistanceSample at_within(const Vector3& point, double enough) const {
    const DistanceSample sample = distance_field->at_within(into_frame(point), enough);
    return {sample.distance_m, turn * sample.gradient};
  }
  DistanceSample at(const Vector3& point) const {
    const DistanceSample sample = distance_field->at(into_frame(point));
    return {sample.distance_m, turn * sample.gradient};
  }
  Vector3 into_frame(const Vector3& point) const { return turn.transpose() * (point - centre_m); }
};

// Returns a lower bound of the tool's distance over a box, in metres.
double lower_bound(const ToolShape& tool, const Box& box);

// Returns a lower bound of the tool's distance over a patch that deviates from the bilinear patch of its
// corners by at most `bulge`, in metres. The bound is not improved once it is at least `enough`.
double lower_bound(const ToolShape& tool, const PatchCorners& corners, double bulge, double enough);

// Returns the distance by which the tool must move along the unit normal to be in front of the plane through
// `point`, in metres. Infinite if the tool is unbounded. Exact to 1e-5 of the tool's size.
double depth_behind(const ToolShape& tool, const Vector3& point, const Vector3& normal);

}  // namespace spoonbill
