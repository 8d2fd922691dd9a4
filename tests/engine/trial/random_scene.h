// Scenes of random bodies of random materials, which drop into fixed dishes, on plates and on the ground.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/scene/scene.h"

namespace spoonbill {

struct RandomScene {
  Scene scene;
  std::optional<TurnBody> shake;  // of the dish, to and fro
};

// Returns a scene of one to six bodies, which is the same on every machine.
RandomScene make_random_scene(std::uint32_t seed);

}  // namespace spoonbill
