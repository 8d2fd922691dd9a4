// Pull: what the tool is in when the button is first down stays where it is in the tool's frame until the
// button is released.
#include "engine/simulation/tool_kernel.h"

namespace spoonbill {
namespace {

void pull(ToolContact& contact, const ToolTouch& touch) {
  if (!touch.hold.gripping) return contact.release();
  if (touch.inside && !contact.gripped()) contact.grip(touch.bodies, touch.hold);
}

}  // namespace

ToolKernel tool_kernel(KernelOf<ToolAction::pull>) {
  return {.constrain = pull};
}

}  // namespace spoonbill
