#include "app/report/task_facts.h"

#include <numbers>
#include <string>

#include "app/report/quantity_text.h"

namespace spoonbill {
namespace {

void add_wrist(const TaskResult& result, const HandModel& hand, FactSheet& facts) {
  Json wrist = Json::object();
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const Range<double>& used = result.wrist_rad[k];
    wrist[wrist_turn_names[k]] = {used.low, used.high};
    constexpr double degrees = 180.0 / std::numbers::pi;
    std::string text =
        decimals_text(degrees * used.low, 1) + " to " + decimals_text(degrees * used.high, 1) + "°";
    if (hand.wrist) {
      const Range<double>& range = hand.wrist->range_rad[k];
      text += " of " + decimals_text(degrees * range.low, 1) + " to " +
              decimals_text(degrees * range.high, 1) + "°";
    }
    facts.add("Wrist " + std::string(wrist_turn_names[k]), text, "", nullptr);
  }
  facts.add("", "", "wrist_rad", wrist);
}

}  // namespace

void add_task_result(const Task& task, const HandModel& hand, const TaskResult& result, FactSheet& facts) {
  const bool success = result.end == TaskEnd::success;
  facts.add("Success",
            success ? "yes" : "no, " + std::string(task_end_names[static_cast<std::size_t>(result.end)]),
            "success", success);
  facts.add("", "", "end", task_end_names[static_cast<std::size_t>(result.end)]);
  facts.add("Time", decimals_text(result.time_s, 2) + " s", "time_s", result.time_s);
  if (result.error_m) facts.add("Error", short_length_text(*result.error_m), "error_m", *result.error_m);
  if (task.has_spoon()) {
    facts.add("Food lost", percent_text(result.food_lost_fraction), "food_lost_fraction",
              result.food_lost_fraction);
  }
  facts.add("Score", decimals_text(result.score(task), 1), "score", result.score(task));
  facts.add("Path", short_length_text(result.path_m), "path_m", result.path_m);
  facts.add("Smoothness", decimals_text(result.smoothness, 2) + " (spectral arc length)", "smoothness",
            result.smoothness);
  facts.add("Tremor", short_length_text(result.tremor_m), "tremor_m", result.tremor_m);
  if (task.has_spoon()) {
    facts.add("Largest tilt", decimals_text(result.largest_tilt_rad * 180.0 / std::numbers::pi, 1) + "°",
              "largest_tilt_rad", result.largest_tilt_rad);
  }
  add_wrist(result, hand, facts);
  if (hand.grip && task.has_spoon()) {
    facts.add("Grip", percent_text(result.grip_used) + " of what it holds", "grip_used", result.grip_used);
    facts.add("Turned in hand", decimals_text(result.turned_in_hand_rad * 180.0 / std::numbers::pi, 1) + "°",
              "turned_in_hand_rad", result.turned_in_hand_rad);
  }
  facts.add("Largest force", newtons_text(result.largest_force_n), "largest_force_n", result.largest_force_n);
}

}  // namespace spoonbill
