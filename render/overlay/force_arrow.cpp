#include "render/overlay/force_arrow.h"

#include <algorithm>

#include "render/overlay/solid_tool.h"

namespace spoonbill {
namespace {

// Where the tool ends in that direction.
Vector3 start_of(const Snapshot& snapshot, const Vector3& direction) {
  const ToolSnapshot& tool = snapshot.tool;
  const ToolBody* body = rigid_body(tool);
  if (body != nullptr) return way_out(bounding_box(body->solid), tool_frame(snapshot), direction);
  if (is_soft(tool)) return tool.proxy.position_m;
  return tool.proxy.position_m + tool.radius_m * direction;
}

}  // namespace

std::optional<ForceArrow> force_arrow(const Snapshot& snapshot, const ViewSettings& settings) {
  constexpr double smallest_n = 0.005;
  const double newtons = snapshot.force_n.norm();
  if (!settings.overlays.force || !(newtons >= smallest_n)) return std::nullopt;
  constexpr double longest_m = 0.060;
  // Shorter than its own head an arrow would have no shaft.
  constexpr double shortest_m = 0.006;
  const double reach_m = std::max(longest_m, 5.0 * snapshot.tool.radius_m);
  const double length_m = std::clamp(newtons * settings.arrow_m_per_n, shortest_m, reach_m);
  const Vector3 direction = snapshot.force_n / newtons;
  const Vector3 start = start_of(snapshot, direction);
  return ForceArrow{start, start + length_m * direction, newtons};
}

}  // namespace spoonbill
