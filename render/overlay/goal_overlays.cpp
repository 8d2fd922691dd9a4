#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

constexpr float goal_width_px = 2.6f;
constexpr float reference_width_px = 1.3f;
constexpr double dash_m = 0.006;  // length of a dash and its gap along a path
constexpr double head_m = 0.007;  // length of an arrow head
constexpr int ring_sides = 48;
constexpr float point_radius_m = 0.0025f;

OverlayLine make_goal_line(const Vector3& start_m, const Vector3& end_m, Colour colour, float width_px) {
  return {start_m.cast<float>(), end_m.cast<float>(), colour, colour, width_px};
}

// Appends dashes along a path, and a head at its end, in the plane of its last side and the vertical.
void append_goal_path(const std::vector<Vector3>& path_m, Colour colour, std::vector<OverlayLine>& lines) {
  for (std::size_t k = 1; k < path_m.size(); ++k) {
    const Vector3 side = path_m[k] - path_m[k - 1];
    const int dashes = std::max(1, static_cast<int>(std::lround(side.norm() / dash_m)));
    for (int d = 0; d < dashes; ++d) {
      const double from = static_cast<double>(d) / dashes, to = (d + 0.55) / dashes;
      lines.push_back(
          make_goal_line(path_m[k - 1] + from * side, path_m[k - 1] + to * side, colour, goal_width_px));
    }
  }
  if (path_m.size() < 2) return;
  const Vector3& tip = path_m.back();
  const Vector3 last = tip - path_m[path_m.size() - 2];
  if (!(last.norm() > 0.0)) return;
  const Vector3 along = last.normalized();
  const Vector3 level =
      std::abs(along.y()) > 0.99 ? Vector3(Vector3::UnitZ()) : along.cross(Vector3::UnitY()).normalized();
  const Vector3 side = level.cross(along);
  for (const double sign : {-1.0, 1.0}) {
    lines.push_back(make_goal_line(tip, tip - head_m * (along + 0.6 * sign * side), colour, goal_width_px));
  }
}

void append_goal_ring(const GoalMarks::Ring& ring, Colour colour, std::vector<OverlayLine>& lines) {
  const Vector3 first = ring.normal.unitOrthogonal(), second = ring.normal.cross(first);
  const auto at = [&](int k) {
    const double angle = 2.0 * std::numbers::pi * k / ring_sides;
    return Vector3(ring.centre_m + ring.radius_m * (std::cos(angle) * first + std::sin(angle) * second));
  };
  for (int k = 0; k < ring_sides; ++k)
    lines.push_back(make_goal_line(at(k), at(k + 1), colour, goal_width_px));
}

}  // namespace

void append_goal(const GoalMarks& goal, std::vector<OverlayLine>& lines, std::vector<OverlayMark>& marks) {
  const Colour colour = goal.is_reached ? palette::reached_goal : palette::goal;
  for (const auto& [start_m, end_m] : goal.lines)
    lines.push_back(make_goal_line(start_m, end_m, palette::goal, reference_width_px));
  for (const std::vector<Vector3>& path_m : goal.paths_m) append_goal_path(path_m, palette::goal, lines);
  for (const GoalMarks::Ring& ring : goal.rings) append_goal_ring(ring, colour, lines);
  for (const Vector3& point_m : goal.points_m) {
    marks.push_back({point_m.cast<float>(), palette::touched_node, point_radius_m, 5.0f,
                     static_cast<float>(MarkShape::diamond)});
  }
}

}  // namespace spoonbill
