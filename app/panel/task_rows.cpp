#include "app/panel/task_rows.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "app/report/quantity_text.h"
#include "app/training/exact_angles.h"

namespace spoonbill {
namespace {

std::string angle_text(double angle_rad) {
  return decimals_text(angle_rad / degree_rad, 1) + "°";
}

std::string pitch_text(double pitch_rad) {
  constexpr double shown_from_rad = 0.05 * degree_rad;
  if (std::abs(pitch_rad) < shown_from_rad) return "level";
  return angle_text(std::abs(pitch_rad)) + ", front " + (pitch_rad < 0.0 ? "down" : "up");
}

std::string end_text(TaskEnd end) {
  switch (end) {
    case TaskEnd::success:
      return "done";
    case TaskEnd::lost:
      return "failed";
    case TaskEnd::late:
      return "out of time";
    default:
      return "under way";
  }
}

TaskRows::Row held_row(const char* name, double held_s, double needed_s) {
  return {name, decimals_text(std::min(held_s, needed_s), 1) + " of " + decimals_text(needed_s, 1) + " s",
          std::clamp(held_s / needed_s, 0.0, 1.0)};
}

void add_goal_rows(const Task& task, const TrainingFacts& facts, TaskRows& rows) {
  const TaskResult& progress = facts.progress;
  const double left_s = std::max(0.0, task.time_limit_s - progress.time_s);
  rows.goal.push_back({"Time left", decimals_text(left_s, 1) + " s", left_s / task.time_limit_s});
  rows.goal.push_back({"State", end_text(progress.end)});
  const double away_m = (facts.reached.position_m - task.mouth_m).norm();
  if (task.kind == TaskKind::carry || task.kind == TaskKind::eat) {
    rows.goal.push_back({"To the mouth", decimals_text(1e3 * away_m, 0) + " mm"});
  }
  if (task.kind == TaskKind::level) rows.goal.push_back(held_row("Level", facts.held_s, task.hold_s));
  if (task.kind == TaskKind::scoop) rows.goal.push_back(held_row("Lifted", facts.held_s, scooped_s));
  if (progress.error_m) {
    rows.goal.push_back({"Error", decimals_text(1e3 * *progress.error_m, 1) + " mm, at most " +
                                      decimals_text(1e3 * task.reach_m, 1) + " mm"});
  }
  if (progress.end != TaskEnd::under_way) {
    rows.goal.push_back({"Score", decimals_text(progress.score(task), 0) + " of 100"});
  }
}

void add_hand_rows(const HandModel& hand, const TrainingFacts& facts, TaskRows& rows) {
  const double lag_m = (facts.wanted.position_m - facts.reached.position_m).norm();
  rows.hand.push_back({"Behind", decimals_text(1e3 * lag_m, 1) + " mm"});
  if (hand.wrist) {
    for (std::size_t k = 0; k < wrist_turn_count; ++k) {
      const Range<double>& range = hand.wrist->range_rad[k];
      const double angle = facts.wrist_rad[k];
      std::string name = wrist_turn_names[k];
      name.front() = static_cast<char>(name.front() - 'a' + 'A');
      rows.hand.push_back(
          {name, angle_text(angle) + " of " + angle_text(range.low) + " to " + angle_text(range.high),
           std::clamp((angle - range.low) / (range.high - range.low), 0.0, 1.0)});
    }
  }
  if (hand.grip) {
    rows.hand.push_back({"Grip", percent_text(facts.grip_used), std::clamp(facts.grip_used, 0.0, 1.0)});
  }
}

}  // namespace

TaskRows make_task_rows(const Task& task, const HandModel& hand, const TrainingFacts& facts) {
  TaskRows rows;
  rows.note = task.note;
  rows.hand_name = name_of_hand(hand.name);
  add_goal_rows(task, facts, rows);
  if (task.has_spoon()) {
    const double pitch_rad =
        std::asin(std::clamp((facts.reached.orientation * Vector3::UnitX()).y(), -1.0, 1.0));
    rows.spoon.push_back({"Angle", pitch_text(pitch_rad)});
    const bool is_in_dish =
        task.kind == TaskKind::scoop && facts.held_s == 0.0 && facts.progress.end == TaskEnd::under_way;
    if (!is_in_dish) {
      rows.spoon.push_back({"Food lost", percent_text(facts.progress.food_lost_fraction),
                            std::clamp(facts.progress.food_lost_fraction, 0.0, 1.0)});
    }
  }
  add_hand_rows(hand, facts, rows);
  return rows;
}

}  // namespace spoonbill
