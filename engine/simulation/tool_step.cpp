// The tool in one tick: the motion of the hand, the kernel of its action, and the force that the hand feels.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/simulation/simulation_state.h"

namespace spoonbill {

double choose_local_radius_m(const Tool& tool, const BodyState& body) {
  constexpr double contact_radii = 1.5, least_cells = 2.0;
  if (tool.local_radius_m > 0.0) return tool.local_radius_m;
  return std::max(contact_radii * contact_radius_m(tool),
                  least_cells * static_cast<double>(body.lattice.cell_size_m()));
}

namespace {

// Push: keeps the surfaces of the bodies out of the tool and never pulls them.
void push(ToolContact& contact, const ToolTouch& touch) {
  contact.push(touch.bodies, touch.hold);
  contact.hold_sideways(touch.bodies, touch.hold, touch.holds);
}

// Pull: grips the surface inside the tool as soon as the button is down and the tool is inside a body. Fixes
// the gripped points in the tool's frame until the button is released.
void pull(ToolContact& contact, const ToolTouch& touch) {
  if (!touch.hold.gripping) return contact.release();
  if (touch.inside && !contact.gripped()) contact.grip(touch.bodies, touch.hold);
}

// Smooth: smooths the surface under the tool (see smoothing.h) within the tool's radius, but at least within
// a few cells. The tool slides on the surface without denting it.
void smooth(Simulation::State& s, HeldTool& held) {
  constexpr double least_reach_cells = 2.5;
  const int number = held.contact.deepest_body();
  BodyState& body = s.bodies[static_cast<std::size_t>(number)];
  if (body.rigid) return;
  const CollisionResult& collision = held.contact.collision(number);
  const ContactConstraints& constraints = held.contact.constraints();
  const bool rests_on_it = constraints.acted() || (collision.found && collision.nearest.depth_m >= 0.0);
  if (constraints.count() == 0 || !rests_on_it) return;
  const Tool& tool = s.scene.tool;
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  const double least = least_reach_cells * static_cast<double>(body.lattice.cell_size_m());
  body.smoothing.apply(body.lattice, {collision.nearest.point_m, std::max(radius, least)}, s.tick);
  if (body.solver()) body.solver()->adopt_moved_nodes(body.lattice);
}

// Push with a local reach: the tool rests on the surface, not on the chords between the nodes of the lattice,
// which are higher in a dent.
void push_nearest(ToolContact& contact, const ToolTouch& touch) {
  contact.push_nearest(touch.bodies, touch.hold);
}

// Pull with a local reach: holds the touched point, from which the stroke then moves the material.
void hold_point(ToolContact& contact, const ToolTouch& touch) {
  if (!touch.hold.gripping) return contact.release();
  if (touch.inside && !contact.gripped()) contact.grip_nearest(touch.bodies, touch.hold);
}

// Part of the way to the hand that a local stroke moves the material in a tick: the material follows the hand
// within about 5 ms, and the tool does not vibrate on it.
constexpr double local_follow = 0.2;

// Largest movement of the material in a tick, in lattice cells.
constexpr double local_step_cells = 0.05;

// Largest resistance of the material to a local stroke, as a fraction of the force that would pull the tool
// back from the hand over the same depth.
constexpr double local_resistance = 0.3;

// Returns the force with which the material resists an elastic depth: that of an elastic half-space against a
// sphere (Hertz 1881), up to what the hand can overcome. As the material takes its new place, the elastic
// depth decays (see LocalStroke::relax()), so that the stroke reaches the hand.
double find_resistance_n(const Tool& tool, const Material& material, double depth_m,
                         double coupling_n_per_m) {
  const double contact_m = std::max(contact_radius_m(tool), 1e-4);
  const double reduced_pa =
      material.youngs_modulus_pa / (1.0 - material.poissons_ratio * material.poissons_ratio);
  const double hertz_n = 4.0 / 3.0 * reduced_pa * std::sqrt(contact_m) * depth_m * std::sqrt(depth_m);
  return std::min(hertz_n, local_resistance * coupling_n_per_m * depth_m);
}

// Returns the radius from which on the dent of a stroke is nowhere narrower than a sphere in it, or a tenth
// more than `now_m` if its sides stop the sphere all the same; 0 if the radius is given. Near its lowest
// point, a dent of depth d and radius R rises as 2 d (s / R)^2, a sphere of radius r as s^2 / (2 r). A fifth
// more leaves room where the body is hollow. The radius ends at the sphere's diameter, beyond which a dent
// would be no local stroke.
double find_fitting_radius_m(const Tool& tool, double depth_m, double now_m, bool sides_stop) {
  if (tool.local_radius_m > 0.0 || tool.kind == ToolKind::point) return 0.0;
  const double fitting_m = 1.2 * std::sqrt(4.0 * std::max(0.0, depth_m) * tool.radius_m);
  return std::min(std::max(fitting_m, sides_stop ? 1.1 * now_m : 0.0), 2.0 * tool.radius_m);
}

// Gap from which on a tool has left the point that it pressed. Nearer, the stroke goes on with the next
// touch.
constexpr double local_release_m = 5e-4;

// Part of a stroke's radius within which two places count as the same.
constexpr double same_place = 0.25;

double find_distance_across(const Vector3& from_m, const Vector3& to_m, const Vector3& normal) {
  const Vector3 way_m = to_m - from_m;
  return (way_m - way_m.dot(normal) * normal).norm();
}

// A tool that slides shapes the material where it is now. Where it is, its position tells, because the
// surface may be behind the material.
bool has_slid(const LocalStroke& stroke, const Vector3& tool_m) {
  const ToolSpot& touch = stroke.touch();
  return find_distance_across(touch.tool_m, tool_m, touch.normal) > same_place * stroke.radius_m();
}

// Progress of a press: how far the material is behind the hand, and whether the sides of the dent stop the
// tool instead of the touched point.
struct PressLag {
  double lag_m = 0.0;
  bool sides_stop = false;
};

// Returns how far the material must follow until the tool is where the hand is, which takes a little more
// than the asked depth while the surface is behind the material. Where the sides of a dent stop the tool,
// only the touched point still follows the hand.
PressLag find_press_lag(const LocalStroke& stroke, const HeldTool& held, const Vector3& nearest_m,
                        const SpringLattice& lattice) {
  constexpr double deepest = 1.05;  // times the asked depth
  const Vector3& normal = stroke.touch().normal;
  const Vector3& hand_m = held.hand.position_m;
  const bool sides_stop =
      find_distance_across(stroke.point_m(lattice), nearest_m, normal) > same_place * stroke.radius_m();
  const double asked_m = -(hand_m - stroke.touch().tool_m).dot(normal);
  const double tool_lag_m = -(hand_m - held.state.position_m).dot(normal);
  const double lag_m =
      sides_stop ? asked_m - stroke.depth_m() : std::min(tool_lag_m, deepest * asked_m - stroke.depth_m());
  return {std::max(0.0, lag_m), sides_stop};
}

// Push or pull with a local reach: moves the material around the touched point to where the hand is, less
// what its resistance takes.
void reform_locally(Simulation::State& s, HeldTool& held) {
  LocalStroke& stroke = held.contact.local_stroke();
  const ContactConstraints& constraints = held.contact.constraints();
  const int number = held.contact.deepest_body();
  const bool pulls = s.scene.tool.action == ToolAction::pull;
  const CollisionResult& collision = held.contact.collision(number);
  const SurfaceContact& nearest = collision.nearest;
  const bool is_rigid = s.bodies[static_cast<std::size_t>(number)].rigid.has_value();
  const bool has_left =
      pulls ? !held.contact.gripped() : !collision.found || -nearest.depth_m > local_release_m;
  if (is_rigid || has_left) return stroke.end();
  // A light touch may push in some ticks only.
  if (constraints.count() == 0 || (!pulls && !constraints.acted())) return stroke.relax(tick_s);
  const bool is_elsewhere = !pulls && (number != stroke.body() || has_slid(stroke, held.state.position_m));
  if (!stroke.is_active() || is_elsewhere) {
    BodyState& touched = s.bodies[static_cast<std::size_t>(number)];
    stroke.begin({number, nearest.u, nearest.v, held.state.position_m, nearest.normal}, touched,
                 choose_local_radius_m(s.scene.tool, touched));
  }
  BodyState& body = s.bodies[static_cast<std::size_t>(stroke.body())];
  const Vector3 pull_m = held.hand.position_m - held.state.position_m;
  const PressLag press =
      pulls ? PressLag{pull_m.norm(), false} : find_press_lag(stroke, held, nearest.point_m, body.lattice);
  const double coupling = constraints.motion().coupling_n_per_m;
  const double resistance_n =
      find_resistance_n(s.scene.tool, body.lattice.material(), stroke.elastic_m(), coupling);
  stroke.relax(tick_s);
  const double largest_m = local_step_cells * static_cast<double>(body.lattice.cell_size_m());
  const double step_m = std::clamp(local_follow * (press.lag_m - resistance_n / coupling), 0.0, largest_m);
  if (pulls) {
    if (step_m > 0.0) stroke.move(body.lattice, step_m / press.lag_m * pull_m);
  } else {
    constexpr double least_growth = 1.09;
    const double wider_m =
        find_fitting_radius_m(s.scene.tool, stroke.depth_m(), stroke.radius_m(), press.sides_stop);
    if (wider_m > least_growth * stroke.radius_m()) stroke.widen(body, wider_m);
    stroke.press(body.lattice, step_m, largest_m);
  }
  if (body.solver()) body.solver()->adopt_moved_nodes(body.lattice);
}

// Kernels in the order of tool_actions, and those of the actions that can have a local reach. A kernel
// without constrain() does not compile.
constexpr ToolKernel kernels[] = {
    {.constrain = push},
    {.constrain = pull},
    {.constrain = push, .reform = smooth, .body_yields = false},
};
constexpr ToolKernel local_push{.constrain = push_nearest, .reform = reform_locally, .body_yields = false};
constexpr ToolKernel local_pull{.constrain = hold_point, .reform = reform_locally, .body_yields = false};
static_assert(std::size(kernels) == tool_actions.size(), "each tool action must have a kernel");
static_assert(std::all_of(std::begin(kernels), std::end(kernels),
                          [](const ToolKernel& kernel) { return kernel.constrain != nullptr; }));

}  // namespace

const ToolKernel& find_kernel(const Tool& tool) {
  if (tool.is_local()) return tool.action == ToolAction::pull ? local_pull : local_push;
  return kernels[static_cast<std::size_t>(tool.action)];
}

namespace {

// Returns the stiffness of the spring between hand and tool. If any body has an implicit solver, or is rigid
// and moves, or if the tool has a local reach, a hand without coupling also gets a spring, because such a
// body does not yield to a rigidly held tool.
double choose_coupling(const Simulation::State& s, double wanted_n_per_m) {
  constexpr double hold_n_per_m = 1000.0;
  const auto is_stiff = [](const BodyState& body) {
    return body.solver() != nullptr || body.is_movable_rigid();
  };
  if (wanted_n_per_m > 0.0) return wanted_n_per_m;
  if (s.scene.tool.is_local()) return hold_n_per_m;
  return std::any_of(s.bodies.begin(), s.bodies.end(), is_stiff) ? hold_n_per_m : 0.0;
}

// Friction coefficient of a tool of local reach that keeps hold of what it touches. It meets the body as a
// rigid wall, and slides only where the hand hardly presses.
constexpr double hold_friction = 100.0;

ToolMotion make_motion(const Simulation::State& s, const Pose& from, const ToolHold& hold,
                       double coupling_n_per_m) {
  const Pose& to = hold.pose;
  const Tool& tool = s.scene.tool;
  ToolMotion motion;
  motion.start_m = from.position_m;
  motion.end_m = to.position_m;
  motion.orientation = to.orientation;
  motion.radius_m = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  motion.coupling_n_per_m = choose_coupling(s, coupling_n_per_m);
  motion.body_yields = find_kernel(tool).body_yields;
  const bool is_local_push = tool.is_local() && tool.action == ToolAction::push;
  if (hold.gripping && tool.sideways == ToolGlide::hold && is_local_push) {
    motion.friction = hold_friction;
  }
  return motion;
}

// Moves a soft tool to the pose, undeformed and at rest in its frame.
void place_soft_tool(BodyState& tool, const Pose& pose) {
  for (int n = 0; n < tool.lattice.mesh().node_count(); ++n) {
    const Vector3& rest = tool.lattice.mesh().nodes[n];
    tool.lattice.set_displacement(n, pose.position_m + pose.orientation * rest - rest);
    tool.lattice.set_velocity(n, Vector3::Zero());
  }
  tool.update_skin();
}

// Returns an upper bound of the movement of any part of the tool in this tick, in metres.
double measure_reach(const Simulation::State& s, const HeldTool& held, const Pose& hand) {
  const double distance_m =
      std::max((hand.position_m - held.hand.position_m).norm(), tick_s * held.state.velocity_m_per_s.norm());
  if (s.scene.tool.kind != ToolKind::solid) return distance_m;
  return distance_m + held.hand.orientation.angularDistance(hand.orientation) * s.model.extent_m;
}

}  // namespace

TouchingTool touch(Simulation::State& s, HeldTool& held, ToolHold hold, double coupling_n_per_m) {
  const Pose hand = hold.pose;
  if (!held.placed) held.place(hand);
  hold.pose.position_m = held.state.position_m;
  hold.reach_m = measure_reach(s, held, hand);
  if (s.tool_is_soft()) {
    if (!held.lattice_placed)
      place_soft_tool(s.bodies.back(), {held.state.position_m, held.hand.orientation});
    held.lattice_placed = true;
    held.contact.prepare_soft();
  } else {
    held.contact.prepare(s.scene_bodies(), s.scene.tool, s.model, hold);
  }
  ToolHold to = hold;
  to.pose = hand;
  ToolMotion motion = make_motion(s, held.hand, to, coupling_n_per_m);
  if (s.tool_is_soft()) {
    motion.orientation = held.hand.orientation;  // turn_soft_tool() turns the tool after it has moved
    motion.carried = {static_cast<int>(s.bodies.size()) - 1, s.model.gripped};
  }
  held.hand = hand;
  return {motion, &held.state, &held.contact.constraints()};
}

ToolHold make_hold(const ToolInput& input) {
  return {input.pose, input.pose.orientation.toRotationMatrix(), 0.0, input.gripping, input.hovering};
}

ToolHold make_mirrored_hold(const Symmetry& symmetry, const ToolInput& input) {
  ToolHold hold = make_hold(input);
  hold.pose = mirror_pose(symmetry, input.pose);
  hold.turn -= 2.0 * symmetry.normal * (symmetry.normal.transpose() * hold.turn);
  return hold;
}

namespace {

// Returns the mean force on the tool over the tick. The contacts of a soft tool push its own lattice, which
// is the last of the stepped bodies.
Vector3 compute_force(const Simulation::State& s) {
  Vector3 impulse = Vector3::Zero();
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    impulse += s.tool.contact.constraints().tool_impulse(static_cast<int>(b));
  }
  return impulse / tick_s;
}

bool is_touching(const Simulation::State& s) {
  if (!s.tool_is_soft()) return s.tool.contact.constraints().acted();
  const int tool = static_cast<int>(s.bodies.size()) - 1;
  for (int body = 0; body < tool; ++body) {
    if (s.between.acted(tool, body)) return true;
  }
  return false;
}

}  // namespace

void turn_soft_tool(Simulation::State& s, const Quaternion& last) {
  const Quaternion& orientation = s.tool.hand.orientation;
  if (orientation.coeffs() == last.coeffs()) return;
  const Vector3& centre = s.tool.state.position_m;
  const Eigen::Matrix3d turn = (orientation * last.conjugate()).toRotationMatrix();
  SpringLattice& lattice = s.bodies.back().lattice;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const Vector3& rest = lattice.mesh().nodes[static_cast<std::size_t>(n)];
    const Vector3 turned =
        lattice.is_fixed(n) ? Vector3(orientation * rest) : Vector3(turn * (lattice.position(n) - centre));
    lattice.set_displacement(n, centre + turned - rest);
    lattice.set_velocity(n, turn * lattice.velocity(n));
  }
}

void react(Simulation::State& s, const ToolInput& input) {
  s.reaction.proxy = {s.tool.state.position_m, input.pose.orientation};
  s.reaction.touching = is_touching(s);
  s.reaction.force_n = compute_force(s);
}

}  // namespace spoonbill
