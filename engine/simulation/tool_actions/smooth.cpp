// Smooth: the tool rests on the surface, which does not give way, and evens out what strokes have done to it
// (smoothing.h).
#include <algorithm>

#include "engine/simulation/tool_kernel.h"

namespace spoonbill {
namespace {

void rest_on(ToolContact& contact, const ToolTouch& touch) {
  contact.push(touch.bodies, touch.hold);
}

// The surface under the tool, as far as the tool reaches, or as a few cells do where it is small.
void smooth(Simulation::State& s, const HeldTool& held) {
  constexpr double least_reach_cells = 2.5;
  const int number = held.contact.deepest_body();
  BodyState& body = s.bodies[static_cast<std::size_t>(number)];
  const CollisionResult& collision = held.contact.collision(number);
  const ContactConstraints& constraints = held.contact.constraints();
  const bool rests_on_it = constraints.acted() || (collision.found && collision.nearest.depth_m >= 0.0);
  if (constraints.count() == 0 || !rests_on_it) return;
  const Tool& tool = s.scene.tool;
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  const double least = least_reach_cells * static_cast<double>(body.lattice.cell_size_m());
  body.smoothing.apply(body.lattice, {collision.nearest.point_m, std::max(radius, least)}, s.tick);
  if (body.mover()) body.mover()->take_moved_nodes(body.lattice);
}

}  // namespace

ToolKernel tool_kernel(KernelOf<ToolAction::smooth>) {
  return {.constrain = rest_on, .reform = smooth, .body_yields = false};
}

}  // namespace spoonbill
