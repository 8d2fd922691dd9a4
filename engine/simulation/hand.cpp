#include "engine/simulation/hand.h"

#include <algorithm>
#include <cmath>

#include "engine/simulation/symmetry.h"
#include "engine/simulation/tool_kernel.h"

namespace spoonbill {

double real_over_felt(const Simulation::State& s, std::size_t body) {
  return s.material(body).youngs_modulus_pa / s.bodies[body].felt_youngs_modulus_pa();
}

namespace {

// The coupling is held against the body that was softened most of those that the tool may touch.
double softest_ratio(const Simulation::State& s) {
  double ratio = real_over_felt(s, 0);
  for (std::size_t body = 1; body < s.stepped(); ++body) ratio = std::max(ratio, real_over_felt(s, body));
  return ratio;
}

// A stiff body does not yield to a hand that nothing moves: the tool is then held by a spring all the same.
double coupling_of(const Simulation::State& s, double wanted_n_per_m) {
  constexpr double hold_n_per_m = 1000.0;
  const auto is_stiff = [](const BodyState& body) { return body.mover() != nullptr; };
  if (wanted_n_per_m > 0.0) return wanted_n_per_m;
  return std::any_of(s.bodies.begin(), s.bodies.end(), is_stiff) ? hold_n_per_m : 0.0;
}

ToolMotion motion_of(const Simulation::State& s, const Pose& from, const Pose& to, double coupling_n_per_m) {
  const Tool& tool = s.scene.tool;
  ToolMotion motion;
  motion.start_m = from.position_m;
  motion.end_m = to.position_m;
  motion.orientation = to.orientation;
  motion.radius_m = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  motion.coupling_n_per_m = coupling_of(s, coupling_n_per_m) / softest_ratio(s);
  motion.body_yields = kernel_of(tool.action).body_yields;
  return motion;
}

// A soft tool as it was made, at the hand.
void place_soft(BodyState& tool, const Pose& pose) {
  for (int n = 0; n < tool.lattice.mesh().node_count(); ++n) {
    const Vector3& rest = tool.lattice.mesh().nodes[n];
    tool.lattice.set_displacement(n, pose.position_m + pose.orientation * rest - rest);
    tool.lattice.set_velocity(n, Vector3::Zero());
  }
  tool.update_skin();
}

// How far any part of the tool may come in this tick.
double reach_of(const Simulation::State& s, const HeldTool& held, const Pose& hand) {
  const double time_s = s.scene.tool.iterations * tick_s;
  const double way =
      std::max((hand.position_m - held.hand.position_m).norm(), time_s * held.state.velocity_m_per_s.norm());
  if (s.scene.tool.kind != ToolKind::solid) return way;
  return way + held.hand.orientation.angularDistance(hand.orientation) * s.model.extent_m;
}

}  // namespace

TouchingTool touch(Simulation::State& s, HeldTool& held, ToolHold hold, double coupling_n_per_m) {
  const Pose hand = hold.pose;
  const bool appears = !held.placed;
  if (appears) held.place(hand);
  hold.pose.position_m = held.state.position_m;
  hold.reach_m = reach_of(s, held, hand);
  if (s.tool_is_soft()) {
    if (appears) place_soft(s.bodies.back(), hand);
    held.contact.prepare_soft();
  } else {
    held.contact.prepare(s.scene_bodies(), s.scene.tool, s.model, hold);
  }
  ToolMotion motion = motion_of(s, held.hand, hand, coupling_n_per_m);
  if (s.tool_is_soft()) {
    motion.coupling_n_per_m = 0.0;
    motion.carried = {static_cast<int>(s.bodies.size()) - 1, s.model.gripped};
  }
  held.hand = hand;
  return {motion, &held.state, &held.contact.constraints()};
}

ToolHold hold_of(const ToolInput& input) {
  return {input.pose, input.pose.orientation.toRotationMatrix(), 0.0, input.gripping, input.hovering};
}

ToolHold mirrored_hold(const Symmetry& symmetry, const ToolInput& input) {
  ToolHold hold = hold_of(input);
  hold.pose = mirrored_pose(symmetry, input.pose);
  hold.turn -= 2.0 * symmetry.normal * (symmetry.normal.transpose() * hold.turn);
  return hold;
}

namespace {

// The force of the real stiffnesses on the hand.
Vector3 force_of(const Simulation::State& s) {
  Vector3 force = Vector3::Zero();
  for (std::size_t b = 0; b < s.stepped(); ++b) {
    force += s.tool.contact.constraints().tool_impulse(static_cast<int>(b)) *
             (real_over_felt(s, b) / s.relaxed.material_time_s);
  }
  return force;
}

// The same of a soft tool. It and what it presses were softened each by its own share: of two in a row the
// real force is that of the softer.
Vector3 force_of_soft(const Simulation::State& s) {
  const std::size_t tool = s.bodies.size() - 1;
  double ratio = real_over_felt(s, tool);
  for (std::size_t b = 0; b < tool; ++b) ratio = std::min(ratio, real_over_felt(s, b));
  return s.tool.contact.constraints().tool_impulse(static_cast<int>(tool)) *
         (ratio / s.relaxed.material_time_s);
}

// It touches from when a contact acts until it is no longer near.
bool soft_touches(Simulation::State& s) {
  HeldTool& held = s.tool;
  const int tool = static_cast<int>(s.bodies.size()) - 1;
  bool acted = false;
  for (int body = 0; body < tool; ++body) acted |= s.between.acted(tool, body);
  if (acted && !held.touched) held.touch_m = held.hand.position_m;
  held.touched = std::isfinite(s.tool_gap_m) && (acted || held.touched);
  return held.touched;
}

// A soft tool has no coupling spring: its flesh takes the place of one. What the hand feels of it rises no
// faster than one would let it, and the proxy is where one would hold it.
void react_softly(Simulation::State& s, double coupling_n_per_m) {
  s.reaction.touching = soft_touches(s);
  Vector3 force = s.reaction.touching ? force_of_soft(s) : Vector3::Zero();
  const double size = force.norm();
  if (coupling_n_per_m > 0.0 && size > 0.0) {
    const double travel = std::max(0.0, force.dot(s.tool.touch_m - s.tool.hand.position_m) / size);
    force *= std::min(1.0, coupling_n_per_m * travel / size);
    s.reaction.proxy.position_m += force / coupling_n_per_m;
  }
  s.reaction.force_n = force;
}

}  // namespace

void react(Simulation::State& s, const ToolInput& input) {
  s.reaction.proxy = {s.tool.state.position_m, input.pose.orientation};
  if (s.tool_is_soft()) {
    react_softly(s, input.coupling_n_per_m);
  } else {
    s.reaction.touching = s.tool.contact.constraints().acted();
    s.reaction.force_n = force_of(s);
  }
}

}  // namespace spoonbill
