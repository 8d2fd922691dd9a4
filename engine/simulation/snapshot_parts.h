// The part of a snapshot that bodies fill in. Sizes settle at the first call; later
// ones of the same structure allocate nothing.
#pragma once

#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

void write_bodies(std::span<const BodyState> bodies, const Scene& scene, std::vector<BodySnapshot>& out);

}  // namespace spoonbill
