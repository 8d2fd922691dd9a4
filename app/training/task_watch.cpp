#include "app/training/task_watch.h"

#include <algorithm>
#include <cmath>

#include "app/training/motion_measures.h"
#include "engine/simulation/body_hold.h"
#include "engine/trial/spill.h"

namespace spoonbill {
namespace {

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
  const double missed_part = error_m ? *error_m / task.reach_m : food_lost_fraction;
  return 100.0 - 50.0 * std::min(1.0, time_s / task.time_limit_s) - 50.0 * missed_part;
}

TaskWatch::TaskWatch(const Task& task, const TrainingScene& scene, const Simulation& simulation)
    : task_(task),
      food_(scene.food),
      lump_m_(scene.lump_m.value_or(Vector3::Zero())),
      dish_top_m_(scene.dish_top_m),
      spills_(simulation.scene()) {
  if (task.has_spoon()) spills_.follow(simulation, 0.0, true);
  path_m_.reserve(static_cast<std::size_t>(task.time_limit_s / (path_ticks * tick_s)) + 2);
}

void TaskWatch::follow(const Simulation& simulation, const Training& training, const Vector3& force_n) {
  if (has_ended()) return;
  const Pose& reached = training.reached();
  measures_.time_s = training.time_s();
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const double angle = training.wrist_angles()[k];
    Range<double>& used = measures_.wrist_rad[k];
    used = path_m_.empty() ? Range<double>{angle, angle}
                           : Range<double>{std::min(used.low, angle), std::max(used.high, angle)};
  }
  if (const SpoonHold* const hold = training.hold()) {
    measures_.grip_used = std::max(measures_.grip_used, hold->torque().used());
    measures_.turned_in_hand_rad = hold->turned_rad();
    measures_.largest_tilt_rad = std::max(measures_.largest_tilt_rad, tilt_rad(reached));
  }
  measures_.largest_force_n = std::max(measures_.largest_force_n, force_n.norm());
  if (std::lround(measures_.time_s / tick_s) % path_ticks == 1) path_m_.push_back(reached.position_m);
  measures_.end = task_.has_spoon() ? judge_food(simulation, reached) : judge_mark(training);
  if (!has_ended() && measures_.time_s >= task_.time_limit_s) measures_.end = TaskEnd::late;
}

TaskEnd TaskWatch::judge_mark(const Training& training) {
  if (!training.is_marking()) return TaskEnd::under_way;
  const Vector3 miss_m = training.reached().position_m - lump_m_;
  measures_.error_m = std::hypot(miss_m.x(), miss_m.z());
  return *measures_.error_m <= task_.reach_m ? TaskEnd::success : TaskEnd::lost;
}

TaskEnd TaskWatch::judge_food(const Simulation& simulation, const Pose& bowl) {
  spills_.follow(simulation, measures_.time_s);
  const Spill* const spill = spills_.find(static_cast<std::size_t>(food_));
  measures_.food_lost_fraction = spill ? spill->spilled_fraction : 1.0;
  const bool is_lost = !spill || spill->spilled_fraction > spill_limit_fraction || spill->left_s;
  if (task_.kind == TaskKind::scoop) return judge_scoop(simulation, is_lost);
  if (task_.kind == TaskKind::eat) return judge_bite(simulation, bowl, spill);
  if (is_lost) return TaskEnd::lost;
  if (task_.kind == TaskKind::level) {
    held_s_ = tilt_rad(bowl) <= task_.angle_rad ? held_s_ + tick_s : 0.0;
    return held_s_ >= task_.hold_s ? TaskEnd::success : TaskEnd::under_way;
  }
  const bool has_arrived = (bowl.position_m - task_.mouth_m).norm() <= task_.reach_m;
  return has_arrived ? TaskEnd::success : TaskEnd::under_way;
}

TaskEnd TaskWatch::judge_scoop(const Simulation& simulation, bool is_lost) {
  const bool is_clear = simulation.bounds(food_).low.y() > dish_top_m_;
  if (is_clear && is_lost) return TaskEnd::lost;
  held_s_ = is_clear ? held_s_ + tick_s : 0.0;
  return held_s_ >= scooped_s ? TaskEnd::success : TaskEnd::under_way;
}

TaskEnd TaskWatch::judge_bite(const Simulation& simulation, const Pose& bowl, const Spill* spill) {
  const Vector3 food_m = find_mass_centre(simulation.lattice(food_)).position_m;
  const bool is_inside = bowl.position_m.x() >= task_.mouth_m.x();
  if (is_inside && !has_pitch_) has_pitch_ = std::abs(pitch_rad(bowl) - task_.pitch_rad) <= task_.angle_rad;
  if (!spill || !spill->left_s) return TaskEnd::under_way;
  const bool is_eaten = is_inside && has_pitch_.value_or(false) && food_m.x() >= task_.mouth_m.x();
  measures_.food_lost_fraction = is_eaten ? 0.0 : 1.0;
  return is_eaten ? TaskEnd::success : TaskEnd::lost;
}

TaskResult TaskWatch::result() const {
  TaskResult result = measures_;
  constexpr double rate_hz = 1.0 / (path_ticks * tick_s);
  result.path_m = find_path_length_m(path_m_);
  std::vector<double> speeds;
  for (std::size_t k = 1; k < path_m_.size(); ++k) {
    speeds.push_back(rate_hz * (path_m_[k] - path_m_[k - 1]).norm());
  }
  result.smoothness = find_spectral_arc_length(speeds, rate_hz);
  result.tremor_m = find_tremor_m(path_m_, rate_hz);
  return result;
}

}  // namespace spoonbill
