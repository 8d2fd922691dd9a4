// What an action of a tool does in a tick. The row of the action is in scene/tool_actions.h; its kernel is
// the one file of its name in tool_actions/, which defines tool_kernel() for it:
//
//   ToolKernel tool_kernel(KernelOf<ToolAction::push>) {
//     return {.constrain = push};
//   }
//
// In each tick first constrain() of the tool and of its mirror image, then the bodies move, then reform() of
// both. They run in the haptic thread: no allocation, no lock, no clock, no error.
#pragma once

#include <span>

#include "engine/scene/tool_actions.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

// What a tool that acts has found.
struct ToolTouch {
  std::span<const BodyState> bodies;
  const ToolHold& hold;
  bool inside = false;  // it is inside a body
};

struct ToolKernel {
  // Sets the constraints of this tick.
  void (*constrain)(ToolContact& contact, const ToolTouch& touch);
  // Changes the form of the bodies under the tool; none: what the constraints do is all.
  void (*reform)(Simulation::State& state, const HeldTool& held) = nullptr;
  // Whether a body that the tool presses gives way (ToolMotion).
  bool body_yields = true;
};

// Declares the kernel of an action, so that a row of the table without one does not link.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-template-friend"
template <ToolAction action>
struct KernelOf {
  friend ToolKernel tool_kernel(KernelOf);
};
#pragma GCC diagnostic pop

ToolKernel kernel_of(ToolAction action);

}  // namespace spoonbill
