// Area of a body's surface on which contacts push. Computed outside the tick.
#pragma once

#include "engine/simulation/simulation_state.h"

namespace spoonbill {

// Returns the area, m^2, on which other bodies, the body itself, the ground and the tool pushed the body's
// surface in the last tick. A patch between four samples of the surface counts by the part of them that was
// pushed. Samples closer to another body than a fiftieth of the largest cell count as pushed, and those
// closer to the ground while the ground pushes the body. Contacts at points between samples do not count, so
// the area under a tool that is smaller than a patch is 0. A rigid body that lies on a soft one has at least
// the area of the soft one's patches that it pushes.
double find_contact_area_m2(const Simulation::State& state, int body);

}  // namespace spoonbill
