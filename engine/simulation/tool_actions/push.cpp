// Push: the surface of the bodies stays out of the tool. It lets go as the tool leaves.
#include "engine/simulation/tool_kernel.h"

namespace spoonbill {
namespace {

void push(ToolContact& contact, const ToolTouch& touch) {
  contact.push(touch.bodies, touch.hold);
}

}  // namespace

ToolKernel tool_kernel(KernelOf<ToolAction::push>) {
  return {.constrain = push};
}

}  // namespace spoonbill
