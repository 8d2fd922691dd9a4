// Follows a task: whether it has succeeded, and how well it was done.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "app/training/task.h"
#include "app/training/training.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/spill.h"

namespace spoonbill {

enum class TaskEnd { under_way, success, lost, late };
inline constexpr const char* task_end_names[] = {"under_way", "success", "lost", "late"};

// Time for which food that is scooped has stayed on the spoon.
inline constexpr double scooped_s = 0.5;

// Result of a task. Plain data.
struct TaskResult {
  TaskEnd end = TaskEnd::under_way;
  double time_s = 0.0;                                    // from the start to the end
  double food_lost_fraction = 0.0;                        // outside the rim and below it, at the end
  double path_m = 0.0;                                    // of the rim's centre
  double smoothness = 0.0;                                // spectral arc length of its speed
  double tremor_m = 0.0;                                  // find_tremor_m() of the rim's centre
  std::array<Range<double>, wrist_turn_count> wrist_rad;  // used range of each turn
  double grip_used = 0.0;                                 // largest torque as a part of what the grip holds
  double turned_in_hand_rad = 0.0;                        // angle by which the spoon has turned in the hand
  double largest_force_n = 0.0;                           // on the device
  double largest_tilt_rad = 0.0;                          // of the bowl from level
  std::optional<double> error_m;                          // palpate: of the mark from the lump, level

  // A success scores 100, less 50 times the used part of the time limit, less 50 times the lost part of the
  // food or, in a palpation, 50 times the error as a part of the largest that is allowed. Everything else
  // scores 0.
  double score(const Task& task) const;
};

// Watches a training tick by tick until the task has ended. Does not change it. One owner. follow() allocates
// nothing.
class TaskWatch {
 public:
  TaskWatch(const Task& task, const TrainingScene& scene, const Simulation& simulation);

  // Called after each tick, with the force on the device.
  void follow(const Simulation& simulation, const Training& training, const Vector3& force_n);

  bool has_ended() const { return measures_.end != TaskEnd::under_way; }
  // Returns the result so far. Allocates.
  TaskResult result() const;
  // Returns the part of the result that needs no path: all but its length, smoothness and tremor.
  const TaskResult& progress() const { return measures_; }
  // Returns the time for which the bowl has been level, or the food clear of the dish, without a break, s.
  double held_s() const { return held_s_; }

 private:
  TaskEnd judge_food(const Simulation& simulation, const Pose& bowl);
  TaskEnd judge_mark(const Training& training);
  TaskEnd judge_scoop(const Simulation& simulation, bool is_lost);
  TaskEnd judge_bite(const Simulation& simulation, const Pose& bowl, const Spill* spill);

  Task task_;
  int food_;
  Vector3 lump_m_;
  double dish_top_m_;
  SpillWatch spills_;
  TaskResult measures_;
  double held_s_ = 0.0;
  // True if the bowl of an eat task had the pitch asked for as it passed the mouth's plane; empty before.
  std::optional<bool> has_pitch_;
  std::vector<Vector3> path_m_;  // of the rim's centre, every path_ticks ticks
  static constexpr int path_ticks = 10;
};

}  // namespace spoonbill
