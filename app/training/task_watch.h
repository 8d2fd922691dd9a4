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

  // 100 for food that is all there at once: a success scores 100 less half of the used part of the time limit
  // and half of the lost part of the food; everything else scores 0.
  double score(const Task& task) const;
};

// Watches a training tick by tick until the task has ended. Does not change it. One owner; allocates.
class TaskWatch {
 public:
  TaskWatch(const Task& task, const TrainingScene& scene, const Simulation& simulation);

  // Called after each tick, with the force on the device.
  void follow(const Simulation& simulation, const Training& training, const Vector3& force_n);

  bool has_ended() const { return end_ != TaskEnd::under_way; }
  // Returns the result so far.
  TaskResult result() const;

 private:
  TaskEnd judge(const Simulation& simulation, const Pose& bowl, double time_s);

  Task task_;
  int food_, spoon_;
  double dish_top_m_;
  SpillWatch spills_;
  TaskEnd end_ = TaskEnd::under_way;
  TaskResult measures_;
  double held_s_ =
      0.0;  // level, scoop: time for which the bowl has been level, or clear of the dish, without a break
  std::optional<bool>
      has_pitch_;  // eat: whether the bowl had the pitch asked for as it passed the mouth's plane
  std::vector<Vector3> path_m_;  // of the rim's centre, every path_ticks ticks
  static constexpr int path_ticks = 10;
};

}  // namespace spoonbill
