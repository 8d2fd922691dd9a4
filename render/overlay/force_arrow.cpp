#include "render/overlay/force_arrow.h"

#include <algorithm>

namespace spoonbill {

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
  const Vector3 start = snapshot.tool.proxy.position_m + snapshot.tool.radius_m * direction;
  return ForceArrow{start, start + length_m * direction, newtons};
}

}  // namespace spoonbill
