#include "engine/scene/scene.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

Vector3 mirror_point(const Symmetry& symmetry, const Vector3& point_m) {
  SPOONBILL_ASSERT_DEBUG(std::abs(symmetry.normal.squaredNorm() - 1.0) < 1e-5);
  return point_m - 2.0 * symmetry.normal.dot(point_m - symmetry.point_m) * symmetry.normal;
}

// A reflection reverses rotations. The rotation axis, a pseudovector, keeps its component along the normal;
// its other components are negated.
Pose mirror_pose(const Symmetry& symmetry, const Pose& pose) {
  SPOONBILL_ASSERT_DEBUG(std::abs(symmetry.normal.squaredNorm() - 1.0) < 1e-5);
  const Vector3 axis = pose.orientation.vec();
  const Vector3 mirrored = 2.0 * symmetry.normal.dot(axis) * symmetry.normal - axis;
  return {mirror_point(symmetry, pose.position_m),
          Quaternion(pose.orientation.w(), mirrored.x(), mirrored.y(), mirrored.z())};
}

Status check_body_count(const Scene& scene) {
  const auto count = static_cast<int>(scene.bodies.size());
  if (count <= sculpted_body_count_range.high) return check_range("bodies", count, sculpted_body_count_range);
  return Error{
      ErrorCode::too_many,
      "holds " + std::to_string(count) + " bodies, and at most " +
          std::to_string(sculpted_body_count_range.high) +
          " are sculpted together; choose some with `spoonbill convert MODEL OUT.json --bodies 1,3-5`",
      "bodies"};
}

Status check_sculpting(const Sculpting& sculpting) {
  return check_fields("sculpting: ", sculpting);
}

Status check_symmetry(const Symmetry& symmetry) {
  return check_fields("symmetry: ", symmetry);
}

namespace {

// Checks that a body has this name and that `fits` accepts it. `wanted` says what the body must be. The error
// is about the field of the trial that names the body. An empty name passes.
Status check_named_body(const Scene& scene, const std::string& name, const char* field, const char* wanted,
                        bool (*fits)(const Body&)) {
  if (name.empty()) return {};
  const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& candidate) { return candidate.name == name; });
  if (body == scene.bodies.end()) {
    return Error{ErrorCode::unknown, "trial: " + std::string(field) + ": no body is called \"" + name + "\"",
                 field};
  }
  if (fits(*body)) return {};
  return Error{ErrorCode::inconsistent,
               "trial: " + std::string(field) + ": the body \"" + name + "\" must be " + wanted, field};
}

}  // namespace

Status check_trial(const Scene& scene) {
  if (!scene.trial) return {};
  const TrialPlan& plan = *scene.trial;
  if (Status status = check_fields("trial: ", plan); !status.ok()) return status;
  const auto is_free = [](const Body& body) { return body.kind != BodyKind::fixed && !body.hand; };
  const auto turns = [](const Body& body) { return body.kind == BodyKind::fixed || body.hand.has_value(); };
  if (Status status = check_named_body(scene, plan.lowered_body, "lowered_body",
                                       "deformable, or rigid and without a hand", is_free);
      !status.ok()) {
    return status;
  }
  return check_named_body(scene, plan.turned_body, "turned_body", "fixed, or rigid and held by a hand",
                          turns);
}

std::string drop_unfit_trial(Scene& scene) {
  const Status status = check_trial(scene);
  if (status.ok()) return {};
  scene.trial.reset();
  return "the trial is left out: " + status.error().message;
}

namespace {

// A turn speeds up for `ramp_s`, turns at constant speed, and slows down for `ramp_s`.
struct TurnProfile {
  double ramp_s, top_deg_per_s, duration_s;
};

TurnProfile find_profile(const TurnBody& turn) {
  const double angle = std::abs(turn.angle_deg), speed = turn.speed_deg_per_s;
  SPOONBILL_ASSERT(speed > 0.0);
  if (angle >= speed * turn_ramp_s) return {turn_ramp_s, speed, angle / speed + turn_ramp_s};
  // The angle is reached while the turn still speeds up at the same acceleration.
  const double ramp_s = std::sqrt(angle * turn_ramp_s / speed);
  return {ramp_s, speed * ramp_s / turn_ramp_s, 2.0 * ramp_s};
}

}  // namespace

double turn_duration_s(const TurnBody& turn) {
  return find_profile(turn).duration_s;
}

double turned_angle_deg(const TurnBody& turn, double time_s) {
  const TurnProfile profile = find_profile(turn);
  if (time_s >= profile.duration_s) return turn.angle_deg;
  if (!(time_s > 0.0)) return 0.0;
  const double left_s = profile.duration_s - time_s;
  // Angle covered while the speed rises from 0 for `seconds`, at most ramp_s.
  const auto ramp_deg = [&](double seconds) {
    return 0.5 * profile.top_deg_per_s * seconds * seconds / profile.ramp_s;
  };
  const double angle = std::abs(turn.angle_deg);
  const double turned = time_s < profile.ramp_s   ? ramp_deg(time_s)
                        : left_s < profile.ramp_s ? angle - ramp_deg(left_s)
                                                  : profile.top_deg_per_s * (time_s - 0.5 * profile.ramp_s);
  return std::copysign(turned, turn.angle_deg);
}

Status check_tool_and_symmetry(const Tool& tool, const Symmetry& symmetry) {
  if (tool.kind != ToolKind::solid || !tool.body->soft) return {};
  if (!row_of(tool.action).allows_soft_tool) {
    return Error{ErrorCode::unsupported, "tool: a soft tool can only push; make it rigid for other actions",
                 "action"};
  }
  if (symmetry.on) {
    return Error{ErrorCode::unsupported,
                 "tool: a soft tool has no mirror image; make it rigid or turn symmetry off", "symmetry"};
  }
  return {};
}

}  // namespace spoonbill
