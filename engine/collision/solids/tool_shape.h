// Tool shapes with their signed distances, which are negative inside the tool, and lower bounds of the
// distance over boxes and patches.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// A tool of one of three kinds. A sphere is centred at `centre_m`; with a radius of 0 it is a point. A
// half-space is behind the plane through `centre_m` with the unit normal `normal`. A solid has its own frame,
// whose origin is at `centre_m` and which is rotated by `turn`.
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
  // Makes a tool from a solid, which must outlive the tool.
  static ToolShape solid(const SignedDistance& distance_field, const Pose& pose) {
    return solid(distance_field, pose.position_m, pose.orientation.normalized().toRotationMatrix());
  }
  // Makes a tool from a solid, which must outlive the tool. `turn` must be orthogonal and may mirror the
  // frame.
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

  // Returns the signed distance from a point. When the point moves, the distance changes by at most the
  // distance moved. The value at the centre of a ball, minus the radius, is therefore a lower bound within
  // the ball.
  double distance(const Vector3& point) const {
    if (is_solid()) return distance_field->at(into_frame(point)).distance_m;
    return kind == Kind::sphere ? (point - centre_m).norm() - radius_m : normal.dot(point - centre_m);
  }

  // Returns the distance if it is less than `enough`; otherwise a lower bound of the distance that is at
  // least `enough`.
  double distance_within(const Vector3& point, double enough) const {
    return is_solid() ? distance_field->at_within(into_frame(point), enough).distance_m : distance(point);
  }

  // Returns true if no point of a ball is within `reach` of the tool; `reach` must not be negative.
  bool is_beyond(const Vector3& centre, double radius, double reach) const {
    return is_solid() ? distance_field->is_beyond(into_frame(centre), reach + radius)
                      : distance(centre) - radius > reach;
  }

  // Returns the distance and its gradient in the world frame, as SignedDistance::at_within() does. The tool
  // must be a solid.
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

// Returns a lower bound, in metres, of the tool's distance over a patch of a surface. The surface deviates
// from the bilinear patch of the corners by at most `bulge`. A bound of at least `enough` is not improved
// further.
double lower_bound(const ToolShape& tool, const PatchCorners& corners, double bulge, double enough);

// Returns the distance, in metres, by which the tool must move along the unit normal until it is in front of
// the plane through `point`. Infinite if the tool is unbounded. Exact to 1e-5 of the tool's size.
double depth_behind(const ToolShape& tool, const Vector3& point, const Vector3& normal);

}  // namespace spoonbill
