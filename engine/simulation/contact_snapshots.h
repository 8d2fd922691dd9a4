// What a snapshot tells of the contacts of a tick. Private to Simulation.
#pragma once

#include <vector>

#include "engine/simulation/simulation_state.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Allocates only where `contacts` has not been written before.
void write_contacts(const Simulation::State& state, std::vector<ContactSnapshot>& contacts);

}  // namespace spoonbill
