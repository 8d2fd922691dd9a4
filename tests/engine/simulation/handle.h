// Provides a small clay handle for simulation tests, 60 mm long along x, 10 mm wide along z and 5 mm high.
// Its lattice is coarse, so that tests are fast.
#pragma once

#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

Scene small_handle();

Simulation simulate(const Scene& scene, InstructionSet set = InstructionSet::baseline);

// Returns the input of a rigid hand at a position over the handle's centre line.
ToolInput above(double x_m, double y_m, bool gripping = false);
inline const ToolInput far_away = above(0.03, 0.2);

}  // namespace spoonbill
