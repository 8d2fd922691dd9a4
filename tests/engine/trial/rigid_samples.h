// Runs of rigid bodies that more than one test file shares.
#pragma once

#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// Returns the simulation of a scene as a trial on a slope along x.
Simulation make_trial_of(Scene scene, double slope_rad = 0.0);

// Advances a trial. Returns the largest overlap of its bodies, m.
double run_trial_ticks(Simulation& simulation, int ticks);

// Checks that the first body, a rigid block on a level surface, obeys the friction coefficient once the
// surface slopes: above the angle of friction by 5 degrees, it slides with g (sin t - mu cos t); 0.3 degrees
// below it, it sticks. The first second is left out, in which it settles.
void check_friction(const Scene& scene, double friction);

// Lets a stack of bodies settle, and checks that its top, a rigid body, then stands still, and that the
// bodies do not overlap.
void check_stands_still(Simulation& simulation, int top);

}  // namespace spoonbill
