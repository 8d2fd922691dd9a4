// What a hand does with its tool in one tick, and what it feels of it. Private to Simulation.
#pragma once

#include "engine/simulation/simulation_state.h"

namespace spoonbill {

// How much stiffer a body is than the lattice that sculpting can hold.
double real_over_felt(const Simulation::State& state, std::size_t body);

ToolHold hold_of(const ToolInput& input);
// The mirror image: of a tool that is not its own, its frame is one too.
ToolHold mirrored_hold(const Symmetry& symmetry, const ToolInput& input);

// Finds the contact of a tool and how the hand moves it from the last tick's pose to that of `hold`.
TouchingTool touch(Simulation::State& state, HeldTool& held, ToolHold hold, double coupling_n_per_m);

// After the bodies have moved: proxy, force and touch of the person's own tool.
void react(Simulation::State& state, const ToolInput& input);

}  // namespace spoonbill
