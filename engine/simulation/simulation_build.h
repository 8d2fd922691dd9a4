// Builds of a simulation, which undo exchanges. Private to engine/simulation.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// The scene's bodies as a whole or, if only knots differ, their mappings to surfaces alone. `mappings` is
// empty for a whole build.
struct SimulationBuild {
  std::vector<BodyState> states = {};
  std::vector<Body> bodies = {};
  std::vector<FixingPlane> planes = {};
  std::vector<std::optional<BodyMapping>> mappings = {};
};

// Returns a build of the mappings of these bodies, which are all of a scene.
std::shared_ptr<SimulationBuild> copy_mappings(std::span<const BodyState> bodies);

}  // namespace spoonbill
