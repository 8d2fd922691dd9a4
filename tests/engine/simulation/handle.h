// A small clay handle for the simulation's tests: 60 x 10 x 5 mm along x, wide along z, coarse enough to be
// quick.
#pragma once

#include "engine/simulation/scene.h"

namespace spoonbill {

Scene small_handle();

}  // namespace spoonbill
