#include "engine/simulation/simulation.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "engine/denormals.h"
#include "engine/simulation/command_applier.h"
#include "engine/simulation/simulation_state.h"
#include "engine/simulation/snapshot_parts.h"
#include "engine/simulation/state_hash.h"
#include "engine/simulation/symmetry.h"

namespace spoonbill {

namespace {

// Each with the nodes around it; some hundreds act at once where two handles lie on each other.
constexpr int between_capacity = 8192;

Status check_scene(const Scene& scene) {
  if (Status status = check_tool(scene.tool); !status.ok()) return status;
  if (Status status = check_sculpting(scene.sculpting); !status.ok()) return status;
  if (Status status = check_range("bodies", static_cast<int>(scene.bodies.size()), body_count_range);
      !status.ok()) {
    return status;
  }
  for (const Body& body : scene.bodies) {
    if (Status status = check_lattice_request(body.lattice); !status.ok()) return status;
  }
  for (const FixingPlane& plane : scene.planes) {
    if (Status status = check_fixing_plane(plane); !status.ok()) return status;
  }
  return check_symmetry(scene.symmetry);
}

// Among several bodies the one that is wrong is named.
Error about(const Body& body, const Scene& scene, const Error& error) {
  return scene.bodies.size() == 1 ? error : Error{"body \"" + body.name + "\": " + error.message};
}

}  // namespace

Result<Simulation> Simulation::make(Scene scene, InstructionSet set) {
  if (const Status status = check_scene(scene); !status.ok()) return status.error();
  std::vector<BodyState> bodies;
  for (const Body& body : scene.bodies) {
    Result<BodyState> state = make_body_state(body, scene.planes, set);
    if (!state.ok()) return about(body, scene, state.error());
    bodies.push_back(std::move(state).value());
  }
  HeldTool tool{ToolContact(bodies)};
  HeldTool mirrored{ToolContact(bodies)};
  std::vector<BodyPairContact> pairs = make_pairs(bodies);
  const int capacity = pairs.empty() ? 0 : between_capacity;
  return Simulation(
      std::make_unique<State>(State{std::move(scene), set, std::move(bodies), std::move(tool),
                                    std::move(mirrored), BodyContacts(capacity), std::move(pairs)}));
}

Simulation::Simulation(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Status Simulation::apply(const Command& command) {
  const DenormalsFlushed flushed;  // the same bits, whichever thread asks
  return std::visit(CommandApplier{*state_}, command);
}

namespace {

double real_over_felt(const Simulation::State& s, std::size_t body) {
  return s.scene.bodies[body].material.youngs_modulus_pa / s.bodies[body].lattice.youngs_modulus_pa();
}

// The coupling is held against the body that was softened most of those that the tool may touch.
double softest_ratio(const Simulation::State& s) {
  double ratio = real_over_felt(s, 0);
  for (std::size_t body = 1; body < s.bodies.size(); ++body) {
    ratio = std::max(ratio, real_over_felt(s, body));
  }
  return ratio;
}

ToolMotion motion_of(const Simulation::State& s, const Pose& from, const Pose& to, double coupling_n_per_m) {
  const Tool& tool = s.scene.tool;
  ToolMotion motion;
  motion.start_m = from.position_m;
  motion.end_m = to.position_m;
  motion.orientation = to.orientation;
  motion.radius_m = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  motion.coupling_n_per_m = coupling_n_per_m / softest_ratio(s);
  motion.body_yields = tool.action != ToolAction::smooth;
  return motion;
}

// Finds the contact of a tool and how the hand moves it from the last tick's pose to `pose`.
TouchingTool touch(const Simulation::State& s, HeldTool& held, const Pose& pose, const ToolInput& input) {
  if (!held.placed) held.place(pose);
  held.contact.prepare(s.bodies, s.scene.tool, {held.state.position_m, pose.orientation}, input.gripping,
                       input.hovering);
  const ToolMotion motion = motion_of(s, held.hand, pose, input.coupling_n_per_m);
  held.hand = pose;
  return {motion, &held.state, &held.contact.constraints()};
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
}

void find_contacts_between(Simulation::State& s) {
  s.between.clear();
  s.pairs_overflow = false;
  auto pair = s.pairs.begin();
  for (std::size_t second = 1; second < s.bodies.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first, ++pair) {
      s.pairs_overflow |= !pair->add_contacts({static_cast<int>(first), &s.bodies[first]},
                                              {static_cast<int>(second), &s.bodies[second]}, s.between);
    }
  }
  s.between.begin(0.0);
}

void relax_bodies(Simulation::State& s, std::span<const TouchingTool> tools) {
  std::array<RelaxedLattice, lattice_capacity> lattices{};
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    // What a body sags at rest is its weight over its stiffness: a softer one must weigh less to sag the
    // same.
    lattices[b] = {&s.bodies[b].lattice, s.scene.sculpting.gravity_m_per_s2 / real_over_felt(s, b)};
  }
  const RelaxSettings settings{s.tick, s.scene.tool.iterations, tick_s, s.scene.sculpting.damping_per_s};
  s.relaxed = relax({lattices.data(), s.bodies.size()}, settings, tools, &s.between);
}

std::uint32_t flags_of(const Simulation::State& s) {
  std::uint32_t flags = tick_flag_none;
  if (s.relaxed.nodes_slowed) flags |= tick_flag_nodes_slowed;
  if (s.relaxed.speed_capped) flags |= tick_flag_speed_capped;
  if (s.tool.contact.overflow() || s.mirrored.contact.overflow() || s.pairs_overflow) {
    flags |= tick_flag_contact_overflow;
  }
  return flags;
}

// The force of the real stiffnesses on the hand.
Vector3 force_of(const Simulation::State& s) {
  Vector3 force = Vector3::Zero();
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    force += s.tool.contact.constraints().tool_impulse(static_cast<int>(b)) *
             (real_over_felt(s, b) / s.relaxed.material_time_s);
  }
  return force;
}

void mark_touched(Simulation::State& s) {
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    std::vector<std::uint8_t>& touched = s.bodies[b].touched;
    std::fill(touched.begin(), touched.end(), std::uint8_t{0});
    const int body = static_cast<int>(b);
    s.tool.contact.constraints().mark_touched(body, touched.data());
    if (s.scene.symmetry.on) s.mirrored.contact.constraints().mark_touched(body, touched.data());
    s.between.mark_touched(body, touched.data());
  }
}

}  // namespace

Reaction Simulation::advance(const ToolInput& input) {
  const DenormalsFlushed flushed;
  State& s = *state_;
  const bool both = s.scene.symmetry.on;
  std::array<TouchingTool, 2> tools;
  tools[0] = touch(s, s.tool, input.pose, input);
  if (both) tools[1] = touch(s, s.mirrored, mirrored_pose(s.scene.symmetry, input.pose), input);
  find_contacts_between(s);
  relax_bodies(s, {tools.data(), both ? std::size_t{2} : std::size_t{1}});
  if (s.scene.tool.action == ToolAction::smooth) {
    smooth(s, s.tool);
    if (both) smooth(s, s.mirrored);
  }
  for (BodyState& body : s.bodies) body.mapping.update(body.lattice);
  ++s.tick;

  s.reaction.force_n = force_of(s);
  s.reaction.proxy = {s.tool.state.position_m, input.pose.orientation};
  s.reaction.touching = s.tool.contact.constraints().acted();
  s.reaction.mirror_touching = both && s.mirrored.contact.constraints().acted();
  s.reaction.flags = flags_of(s);
  mark_touched(s);
  return s.reaction;
}

const Scene& Simulation::scene() const {
  return state_->scene;
}
void Simulation::write_scene(Scene& scene) const {
  scene = state_->scene;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    scene.bodies[b].surface = state_->bodies[b].mapping.current();
  }
}
std::uint64_t Simulation::tick() const {
  return state_->tick;
}
const SpringLattice& Simulation::lattice(int body) const {
  return state_->bodies[static_cast<std::size_t>(body)].lattice;
}
const Surface& Simulation::surface(int body) const {
  return state_->bodies[static_cast<std::size_t>(body)].mapping.current();
}

namespace {

void add_to_hash(const HeldTool& held, StateHash& hash) {
  for (const Vector3& vector : {held.hand.position_m, held.state.position_m, held.state.velocity_m_per_s}) {
    for (int axis = 0; axis < 3; ++axis) hash.add(vector[axis]);
  }
  for (int c = 0; c < 4; ++c) hash.add(held.hand.orientation.coeffs()[c]);
  const std::uint64_t lifted = held.contact.lifted() ? std::uint64_t{1} << 32 : 0;
  const std::uint64_t hovered = held.contact.hovered() ? std::uint64_t{1} << 33 : 0;
  hash.add(lifted | hovered | static_cast<std::uint64_t>(held.contact.constraints().count()));
}

}  // namespace

std::uint64_t Simulation::state_hash() const {
  const State& s = *state_;
  StateHash hash;
  hash.add(s.tick);
  for (const BodyState& body : s.bodies) {
    body.lattice.visit_state([&](const float* data, std::size_t count) { hash.add(data, count); });
    const ControlNet& net = body.mapping.current().net;
    for (const std::vector<double>* coordinate : {&net.x, &net.y, &net.z}) {
      for (const double value : *coordinate) hash.add(value);
    }
  }
  add_to_hash(s.tool, hash);
  if (s.scene.symmetry.on) add_to_hash(s.mirrored, hash);
  return hash.value();
}

ShapeState Simulation::shape() const {
  ShapeState shape;
  write_shape(shape);
  return shape;
}

void Simulation::write_shape(ShapeState& shape) const {
  shape.lattices.resize(state_->bodies.size());
  for (std::size_t b = 0; b < shape.lattices.size(); ++b) {
    state_->bodies[b].lattice.write_shape(shape.lattices[b]);
  }
}

Status Simulation::restore(const ShapeState& shape) {
  const DenormalsFlushed flushed;
  bool fits = shape.lattices.size() == state_->bodies.size();
  for (std::size_t b = 0; fits && b < shape.lattices.size(); ++b) {
    fits = shape.lattices[b].size() == state_->bodies[b].lattice.shape_size();
  }
  if (!fits) return Error{"shape: it belongs to another lattice"};
  for (std::size_t b = 0; b < shape.lattices.size(); ++b) {
    BodyState& body = state_->bodies[b];
    body.lattice.set_shape(shape.lattices[b]);
    body.mapping.update(body.lattice);
  }
  state_->tool.contact.release();
  state_->mirrored.contact.release();
  return {};
}

namespace {

void write_symmetry(const Simulation::State& s, Snapshot& snapshot) {
  snapshot.symmetric = s.scene.symmetry.on;
  snapshot.symmetry = {s.scene.symmetry.point_m, s.scene.symmetry.normal};
  snapshot.mirrored_proxy = {s.mirrored.state.position_m, s.mirrored.hand.orientation};
}

void write_contacts(const Simulation::State& s, std::vector<ContactSnapshot>& contacts) {
  contacts.reserve(s.bodies.size());  // before the first contact, which must not allocate
  contacts.clear();
  if (!s.reaction.touching) return;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const CollisionResult& collision = s.tool.contact.collision(static_cast<int>(b));
    if (!collision.found) continue;
    const SurfaceContact& nearest = collision.nearest;
    contacts.push_back({nearest.point_m, nearest.normal, nearest.depth_m, nearest.u, nearest.v});
  }
}

}  // namespace

void Simulation::write_snapshot(Snapshot& snapshot) const {
  const State& s = *state_;
  snapshot.tick = s.tick;
  write_bodies(s.bodies, s.scene, snapshot.bodies);
  snapshot.tool.kind = s.scene.tool.kind;
  snapshot.tool.action = s.scene.tool.action;
  snapshot.tool.iterations = s.scene.tool.iterations;
  snapshot.tool.radius_m = s.scene.tool.kind == ToolKind::point ? 0.0 : s.scene.tool.radius_m;
  snapshot.tool.device = s.tool.hand;
  snapshot.tool.proxy = s.reaction.proxy;
  write_symmetry(s, snapshot);
  snapshot.planes.clear();
  for (const FixingPlane& plane : s.scene.planes) snapshot.planes.push_back({plane.point_m, plane.normal});
  write_contacts(s, snapshot.contacts);
  snapshot.device.force_scale = s.scene.sculpting.force_scale;
  snapshot.substeps = s.relaxed.substeps * s.scene.tool.iterations;
  snapshot.flags = s.reaction.flags;
}

}  // namespace spoonbill
