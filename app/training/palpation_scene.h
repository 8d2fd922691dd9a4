// The scene of a palpation: a soft block with a stiff lump under its skin, and a finger above it.
#pragma once

#include <cstdint>

#include "app/training/task.h"
#include "app/training/training_scene.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the scene of make_training_scene() for a palpation.
Result<TrainingScene> make_palpation_scene(const Task& task, std::uint32_t seed);

}  // namespace spoonbill
