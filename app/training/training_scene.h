// The scene of a task: a spoon in a hand, with food just above its bowl or above a dish; or a soft block with
// a finger above it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "app/training/spoon_hold.h"
#include "app/training/task.h"
#include "engine/base/result.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Plain data. With a spoon, the centre of its rim is the origin, its bowl is level, and its front is along x.
struct TrainingScene {
  Scene scene;  // with a spoon: has a trial that lowers the food
  int food = 0;
  double dish_top_m = 0.0;            // highest point of the dish, if there is one
  std::optional<HeldSpoon> spoon;     // empty for a palpation
  std::optional<Vector3> lump_m;      // palpation: centre of the lump
  Vector3 start_m = Vector3::Zero();  // of the rim's centre, or of the finger
};

// Lays the food of a task over the bowl of a spoon that a hand holds at a third of its handle, or over a
// dish. `spoon` is the spoon's document; empty for that of the task. Fails where read_spoon() and
// make_case_scene() do, and for a spoon without a handle.
//
// For a palpation, hides the lump in the block; `seed` selects where. Fails for a `spoon`, for a document
// that is not one deformable body, and for a lump that does not fit into the block.
Result<TrainingScene> make_training_scene(const Task& task, const std::filesystem::path& spoon,
                                          std::uint32_t seed = 1);

}  // namespace spoonbill
