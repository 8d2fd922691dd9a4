#include "app/training/task_watch.h"

#include <algorithm>
#include <cmath>

#include "engine/simulation/body_hold.h"
#include "engine/trial/spill.h"

namespace spoonbill {
namespace {

constexpr double scooped_s = 0.5;  // time for which food that is scooped has stayed on the spoon

// Angle by which the front of a bowl is lifted, and the angle of its rim's plane to the level, rad.
double pitch_rad(const Pose& bowl) {
  return std::asin(std::clamp((bowl.orientation * Vector3::UnitX()).y(), -1.0, 1.0));
}
double tilt_rad(const Pose& bowl) {
  return std::acos(std::clamp((bowl.orientation * Vector3::UnitY()).y(), -1.0, 1.0));
}

}  // namespace

double TaskResult::score(const Task& task) const {
  if (end != TaskEnd::success) return 0.0;
  return 100.0 - 50.0 * std::min(1.0, time_s / task.time_limit_s) - 50.0 * food_lost_fraction;
}

TaskWatch::TaskWatch(const Task& task, const TrainingScene& scene, const Simulation& simulation)
    : task_(task),
      food_(scene.food),
      spoon_(scene.spoon.body),
      dish_top_m_(scene.dish_top_m),
      spills_(simulation.scene()) {
  spills_.follow(simulation, 0.0, true);
}

void TaskWatch::follow(const Simulation& simulation, const Training& training, const Vector3& force_n) {
  if (has_ended()) return;
  const Pose bowl = simulation.rigid_dynamics(spoon_)->pose();
  measures_.time_s = training.time_s();
  spills_.follow(simulation, measures_.time_s);
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const double angle = training.wrist_angles()[k];
    Range<double>& used = measures_.wrist_rad[k];
    used = path_m_.empty() ? Range<double>{angle, angle}
                           : Range<double>{std::min(used.low, angle), std::max(used.high, angle)};
  }
  measures_.grip_used = std::max(measures_.grip_used, training.hold().torque().used());
  measures_.turned_in_hand_rad = training.hold().turned_rad();
  measures_.largest_force_n = std::max(measures_.largest_force_n, force_n.norm());
  measures_.largest_tilt_rad = std::max(measures_.largest_tilt_rad, tilt_rad(bowl));
  if (std::lround(measures_.time_s / tick_s) % path_ticks == 1) path_m_.push_back(bowl.position_m);
  end_ = judge(simulation, bowl, measures_.time_s);
}

TaskEnd TaskWatch::judge(const Simulation& simulation, const Pose& bowl, double time_s) {
  const Spill* const spill = spills_.find(static_cast<std::size_t>(food_));
  measures_.food_lost_fraction = spill ? spill->spilled_fraction : 1.0;
  const bool is_lost = !spill || spill->spilled_fraction > spill_limit_fraction || spill->left_s;
  if (task_.kind == TaskKind::scoop) {
    const bool is_clear = simulation.bounds(food_).low.y() > dish_top_m_;
    if (is_clear && is_lost) return TaskEnd::lost;
    held_s_ = is_clear ? held_s_ + tick_s : 0.0;
    if (held_s_ >= scooped_s) return TaskEnd::success;
  } else if (task_.kind == TaskKind::eat) {
    const Vector3 food_m = find_mass_centre(simulation.lattice(food_)).position_m;
    const bool is_inside = bowl.position_m.x() >= task_.mouth_m.x();
    if (is_inside && !has_pitch_) has_pitch_ = std::abs(pitch_rad(bowl) - task_.pitch_rad) <= task_.angle_rad;
    if (spill && spill->left_s) {
      const bool is_eaten = is_inside && has_pitch_.value_or(false) && food_m.x() >= task_.mouth_m.x();
      measures_.food_lost_fraction = is_eaten ? 0.0 : 1.0;
      return is_eaten ? TaskEnd::success : TaskEnd::lost;
    }
  } else if (is_lost) {
    return TaskEnd::lost;
  }
  if (task_.kind == TaskKind::level) {
    held_s_ = tilt_rad(bowl) <= task_.angle_rad ? held_s_ + tick_s : 0.0;
    if (held_s_ >= task_.hold_s) return TaskEnd::success;
  }
  if (task_.kind == TaskKind::carry && (bowl.position_m - task_.mouth_m).norm() <= task_.reach_m)
    return TaskEnd::success;
  return time_s >= task_.time_limit_s ? TaskEnd::late : TaskEnd::under_way;
}

TaskResult TaskWatch::result() const {
  TaskResult result = measures_;
  result.end = end_;
  constexpr double rate_hz = 1.0 / (path_ticks * tick_s);
  result.path_m = find_path_length_m(path_m_);
  std::vector<double> speeds;
  for (std::size_t k = 1; k < path_m_.size(); ++k)
    speeds.push_back(rate_hz * (path_m_[k] - path_m_[k - 1]).norm());
  result.smoothness = find_spectral_arc_length(speeds, rate_hz);
  result.tremor_m = find_tremor_m(path_m_, rate_hz);
  return result;
}

}  // namespace spoonbill
