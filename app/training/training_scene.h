// The scene of a task: a spoon in a hand, with food just above its bowl or above a dish.
#pragma once

#include <filesystem>

#include "app/training/spoon_hold.h"
#include "app/training/task.h"
#include "engine/base/result.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Plain data. The centre of the spoon's rim is the origin, its bowl is level, and its front is along x.
struct TrainingScene {
  Scene scene;  // with a trial that lowers the food
  int food = 0;
  double dish_top_m = 0.0;  // highest point of the dish, if there is one
  HeldSpoon spoon;
};

// Lays the food of a task over the bowl of a spoon that a hand holds at a third of its handle, or over a
// dish. `spoon` is the spoon's document; empty for that of the task. Fails where read_spoon() and
// make_case_scene() do, and for a spoon without a handle.
Result<TrainingScene> make_training_scene(const Task& task, const std::filesystem::path& spoon);

}  // namespace spoonbill
