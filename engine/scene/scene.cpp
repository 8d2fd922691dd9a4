#include "engine/scene/scene.h"

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
