// A small clay handle for the simulation's tests: 60 x 10 x 5 mm along x, wide along z, coarse enough to be
// quick.
#pragma once

#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

Scene small_handle();

Simulation simulate(const Scene& scene, InstructionSet set = InstructionSet::baseline);

// A rigid hand at that place over the handle's middle line.
ToolInput above(double x_m, double y_m, bool gripping = false);

}  // namespace spoonbill
