#include "app/session/task_goal.h"

#include <array>
#include <cmath>

namespace spoonbill {
namespace {

constexpr double mouth_radius_m = 0.022;
constexpr double level_radius_m = 0.045;  // of the circle that shows the level about a bowl
constexpr double ray_m = 0.065;           // length of the lines at the angle that is allowed

void add_mouth(const Task& task, GoalMarks& goal) {
  goal.rings.push_back({task.mouth_m, Vector3::UnitX(), mouth_radius_m});
  if (task.kind == TaskKind::carry) {
    goal.rings.push_back({task.mouth_m, Vector3::UnitZ(), task.reach_m});
    return;
  }
  // The food slides off behind the mouth's plane.
  const Vector3 inside_m = task.mouth_m + Vector3(0.03, 0.0, 0.0);
  goal.paths_m.push_back({inside_m, inside_m + Vector3(0.02, -0.03, 0.0)});
}

void add_level(const Task& task, GoalMarks& goal) {
  goal.rings.push_back({Vector3::Zero(), Vector3::UnitY(), level_radius_m});
  for (const double side : {-1.0, 1.0}) {
    for (const double angle : {-task.angle_rad, task.angle_rad}) {
      const Vector3 direction(side * std::cos(angle), std::sin(angle), 0.0);
      goal.lines.push_back({Vector3(level_radius_m * direction), Vector3(ray_m * direction)});
    }
  }
}

void add_search(const Task& task, const TrainingScene& scene, const TrainingFacts& facts, GoalMarks& goal) {
  const Box block = find_bounds(scene.scene.bodies.front());
  const Vector3 half(0.5 * task.lump.area_m.x() + task.lump.radius_m, 0.0,
                     0.5 * task.lump.area_m.y() + task.lump.radius_m);
  Vector3 centre_m = block.centre();
  centre_m.y() = block.high.y();
  std::array<Vector3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3 side(k == 0 || k == 3 ? -half.x() : half.x(), 0.0, k < 2 ? -half.z() : half.z());
    corners[k] = centre_m + side;
  }
  for (std::size_t k = 0; k < 4; ++k) goal.lines.push_back({corners[k], corners[(k + 1) % 4]});
  if (facts.progress.end == TaskEnd::under_way) return;
  Vector3 lump_m = scene.lump_m.value_or(centre_m);
  lump_m.y() = block.high.y();
  goal.rings.push_back({lump_m, Vector3::UnitY(), task.reach_m});
  if (facts.progress.error_m) {
    goal.points_m.push_back(facts.reached.position_m - Vector3(0.0, task.lump.tool_radius_m, 0.0));
  }
}

}  // namespace

GoalMarks make_goal(const Task& task, const TrainingScene& scene, const TrainingFacts& facts) {
  GoalMarks goal;
  goal.is_reached = facts.progress.end == TaskEnd::success;
  if (task.path_m.size() > 1) goal.paths_m.push_back(task.path_m);
  if (task.kind == TaskKind::carry || task.kind == TaskKind::eat) add_mouth(task, goal);
  if (task.kind == TaskKind::level) add_level(task, goal);
  if (task.kind == TaskKind::palpate) add_search(task, scene, facts, goal);
  if (task.kind == TaskKind::scoop) {
    Vector3 above_m = task.dish_m;
    above_m.y() = scene.dish_top_m + 0.02;
    goal.rings.push_back({above_m, Vector3::UnitY(), level_radius_m});
  }
  return goal;
}

void add_wanted_pose(const TrainingScene& scene, const TrainingFacts& facts, GoalMarks& goal) {
  constexpr double shown_from_m = 0.002, shown_from_rad = 0.01, arm_m = 0.004;
  const Pose& wanted = facts.wanted;
  const bool is_apart = (wanted.position_m - facts.reached.position_m).norm() > shown_from_m ||
                        wanted.orientation.angularDistance(facts.reached.orientation) > shown_from_rad;
  if (!is_apart) return;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 arm = arm_m * (wanted.orientation * Vector3::Unit(axis));
    goal.lines.push_back({Vector3(wanted.position_m - arm), Vector3(wanted.position_m + arm)});
  }
  if (!scene.spoon) return;
  const auto place = [&](const Vector3& point_m) {
    return Vector3(wanted.position_m + wanted.orientation * point_m);
  };
  goal.lines.push_back({place(Vector3::Zero()), place(scene.spoon->grip_m)});
}

Box find_bounds(const GoalMarks& goal) {
  Box box;
  for (const GoalMarks::Ring& ring : goal.rings) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3 reach = side * ring.radius_m * (Vector3::Ones() - ring.normal.cwiseAbs());
      box.include(ring.centre_m + reach);
    }
  }
  for (const std::vector<Vector3>& path_m : goal.paths_m) {
    for (const Vector3& corner_m : path_m) box.include(corner_m);
  }
  for (const auto& line : goal.lines) {
    for (const Vector3& end_m : line) box.include(end_m);
  }
  return box;
}

}  // namespace spoonbill
