#include "engine/simulation/simulation.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "engine/denormals.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/tube_lattice.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/smoothing.h"
#include "engine/simulation/snapshot_parts.h"
#include "engine/simulation/state_hash.h"
#include "engine/simulation/symmetry.h"
#include "engine/simulation/tool_contact.h"

namespace spoonbill {

// A tool in a hand: the person's own, or its mirror image. The contact keeps the address of the mapping's
// grid, which the mapping holds by pointer: both move freely.
struct HeldTool {
  ToolContact contact;
  Pose hand{};  // of the last tick
  ToolState state{};
  bool placed = false;

  void place(const Pose& pose) {
    hand = pose;
    state.position_m = pose.position_m;
    state.velocity_m_per_s.setZero();
    placed = true;
  }
};

struct Simulation::State {
  Scene scene;
  InstructionSet set;
  SpringLattice lattice;
  BodyMapping mapping;
  Smoothing smoothing;
  HeldTool tool;
  HeldTool mirrored;
  std::vector<std::uint8_t> held, touched;
  std::uint64_t tick = 0;
  RelaxReport relaxed{};
  Reaction reaction{};
};

namespace {

// The lattice of a body at the stiffness that sculpting can hold.
Result<SpringLattice> sculpting_lattice(const LatticeMesh& mesh, const Material& material,
                                        InstructionSet set) {
  // Measured at 1 Pa: frequencies scale with the root of the modulus, the springs with the modulus.
  Result<SpringLattice> unit = SpringLattice::make(mesh, material, 1.0, set);
  if (!unit.ok()) return unit;
  const double unit_limit = felt_modulus_limit_pa(unit->fastest_frequency(), material.damping_ratio);
  return SpringLattice::make(mesh, material, std::min(material.youngs_modulus_pa, unit_limit), set);
}

std::vector<std::uint8_t> nodes_behind(const SpringLattice& lattice, const std::vector<FixingPlane>& planes) {
  std::vector<std::uint8_t> held(static_cast<std::size_t>(lattice.mesh().node_count()), 0);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    for (const FixingPlane& plane : planes) {
      if (plane.normal.dot(lattice.position(n) - plane.point_m) <= 0.0) held[static_cast<std::size_t>(n)] = 1;
    }
  }
  return held;
}

Status check_scene(const Scene& scene) {
  if (Status status = check_tool(scene.tool); !status.ok()) return status;
  if (Status status = check_sculpting(scene.sculpting); !status.ok()) return status;
  if (Status status = check_lattice_request(scene.body.lattice); !status.ok()) return status;
  for (const FixingPlane& plane : scene.planes) {
    if (Status status = check_fixing_plane(plane); !status.ok()) return status;
  }
  return check_symmetry(scene.symmetry);
}

}  // namespace

Result<Simulation> Simulation::make(Scene scene, InstructionSet set) {
  if (const Status status = check_scene(scene); !status.ok()) return status.error();
  Result<LatticeMesh> mesh = tube_lattice(scene.body.surface, scene.body.lattice);
  if (!mesh.ok()) return mesh.error();
  Result<SpringLattice> lattice = sculpting_lattice(mesh.value(), scene.body.material, set);
  if (!lattice.ok()) return lattice.error();
  std::vector<std::uint8_t> held = nodes_behind(lattice.value(), scene.planes);
  lattice->hold(held);
  const Surface& surface = scene.body.surface;
  Result<BodyMapping> mapping = BodyMapping::make(surface, surface, lattice.value(), scene.planes, set);
  if (!mapping.ok()) return mapping.error();
  HeldTool tool{ToolContact(mapping.value())};
  HeldTool mirrored{ToolContact(mapping.value())};
  std::vector<std::uint8_t> touched(held.size(), 0);
  return Simulation(std::make_unique<State>(State{
      std::move(scene), set, std::move(lattice).value(), std::move(mapping).value(), Smoothing(mesh.value()),
      std::move(tool), std::move(mirrored), std::move(held), std::move(touched)}));
}

Simulation::Simulation(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

// One apply() a command: each makes everything new first, and changes the state only when all of it
// succeeded.
struct CommandApplier {
  Simulation::State& state;

  Status operator()(const PlacePlane& command) {
    if (Status status = check_fixing_plane(command.plane); !status.ok()) return status;
    std::vector<FixingPlane> planes = state.scene.planes;
    planes.push_back(command.plane);
    if (Status status =
            check_range("fixing planes", static_cast<int>(planes.size()), fixing_plane_count_range);
        !status.ok()) {
      return status;
    }
    return set_planes(std::move(planes));
  }
  Status operator()(const RemovePlanes&) { return set_planes({}); }
  Status operator()(const SetTool& command) {
    if (Status status = check_tool(command.tool); !status.ok()) return status;
    state.scene.tool = command.tool;
    release();
    return {};
  }
  Status operator()(const SetSymmetry& command) {
    if (Status status = check_symmetry(command.symmetry); !status.ok()) return status;
    state.scene.symmetry = command.symmetry;
    state.mirrored.contact.release();
    state.mirrored.placed = false;
    return {};
  }
  Status operator()(const ResetProxy&) {
    release();
    state.tool.placed = state.mirrored.placed = false;
    return {};
  }
  Status operator()(const LiftTool&) {
    state.tool.contact.lift();
    state.mirrored.contact.lift();
    return {};
  }
  Status operator()(const SetSculpting& command) {
    if (Status status = check_sculpting(command.sculpting); !status.ok()) return status;
    state.scene.sculpting = command.sculpting;
    return {};
  }
  Status operator()(const SetMaterial& command) {
    Result<SpringLattice> lattice = sculpting_lattice(state.lattice.mesh(), command.material, state.set);
    if (!lattice.ok()) return lattice.error();
    lattice->set_shape(state.lattice.shape());
    lattice->hold(state.held);
    state.lattice = std::move(lattice).value();
    state.scene.body.material = command.material;
    release();
    return {};
  }
  Status operator()(const KeepShape&) {
    LatticeMesh mesh = state.lattice.mesh();
    for (int n = 0; n < mesh.node_count(); ++n) mesh.nodes[n] = state.lattice.position(n);
    Result<SpringLattice> lattice = sculpting_lattice(mesh, state.scene.body.material, state.set);
    if (!lattice.ok()) return lattice.error();
    lattice->hold(state.held);
    const Surface& surface = state.mapping.current();
    Result<BodyMapping> mapping =
        BodyMapping::make(surface, surface, lattice.value(), state.scene.planes, state.set);
    if (!mapping.ok()) return mapping.error();
    state.smoothing = Smoothing(mesh);
    state.lattice = std::move(lattice).value();
    set_mapping(std::move(mapping).value());
    return {};
  }

 private:
  void release() {
    state.tool.contact.release();
    state.mirrored.contact.release();
  }

  Status set_planes(std::vector<FixingPlane> planes) {
    std::vector<std::uint8_t> held = nodes_behind(state.lattice, planes);
    Result<BodyMapping> mapping =
        BodyMapping::make(state.mapping.rest(), state.mapping.current(), state.lattice, planes, state.set);
    if (!mapping.ok()) return mapping.error();
    state.lattice.hold(held);
    state.held = std::move(held);
    state.scene.planes = std::move(planes);
    set_mapping(std::move(mapping).value());
    return {};
  }

  void set_mapping(BodyMapping mapping) {
    state.mapping = std::move(mapping);
    state.tool.contact = ToolContact(state.mapping);
    state.mirrored.contact = ToolContact(state.mapping);
    state.scene.body.surface = state.mapping.current();
  }
};

Status Simulation::apply(const Command& command) {
  const DenormalsFlushed flushed;  // the same bits, whichever thread asks
  return std::visit(CommandApplier{*state_}, command);
}

namespace {

double real_over_felt(const Simulation::State& s) {
  return s.scene.body.material.youngs_modulus_pa / s.lattice.youngs_modulus_pa();
}

ToolMotion motion_of(const Simulation::State& s, const Pose& from, const Pose& to, double coupling_n_per_m) {
  const Tool& tool = s.scene.tool;
  ToolMotion motion;
  motion.start_m = from.position_m;
  motion.end_m = to.position_m;
  motion.orientation = to.orientation;
  motion.radius_m = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  motion.coupling_n_per_m = coupling_n_per_m / real_over_felt(s);
  motion.body_yields = tool.action != ToolAction::smooth;
  return motion;
}

// Finds the contact of a tool and how the hand moves it from the last tick's pose to `pose`.
TouchingTool touch(const Simulation::State& s, HeldTool& held, const Pose& pose, const ToolInput& input) {
  if (!held.placed) held.place(pose);
  held.contact.prepare(s.mapping, s.lattice, s.scene.tool, {held.state.position_m, pose.orientation},
                       input.gripping, input.hovering);
  const ToolMotion motion = motion_of(s, held.hand, pose, input.coupling_n_per_m);
  held.hand = pose;
  return {motion, &held.state, &held.contact.constraints()};
}

// The surface under the tool, as far as the tool reaches, or as a few cells do where it is small.
void smooth(Simulation::State& s, const HeldTool& held) {
  constexpr double least_reach_cells = 2.5;
  const CollisionResult& collision = held.contact.collision();
  const ContactConstraints& constraints = held.contact.constraints();
  const bool rests_on_it = constraints.acted() || (collision.found && collision.nearest.depth_m >= 0.0);
  if (constraints.count() == 0 || !rests_on_it) return;
  const Tool& tool = s.scene.tool;
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  const double least = least_reach_cells * static_cast<double>(s.lattice.cell_size_m());
  s.smoothing.apply(s.lattice, {collision.nearest.point_m, std::max(radius, least)}, s.tick);
}

RelaxSettings relax_settings(const Simulation::State& s) {
  // What a body sags at rest is its weight over its stiffness: a softer one must weigh less to sag the same.
  return {s.tick, s.scene.tool.iterations, tick_s, s.scene.sculpting.damping_per_s,
          s.scene.sculpting.gravity_m_per_s2 / real_over_felt(s)};
}

std::uint32_t flags_of(const Simulation::State& s) {
  std::uint32_t flags = tick_flag_none;
  if (s.relaxed.nodes_slowed) flags |= tick_flag_nodes_slowed;
  if (s.relaxed.speed_capped) flags |= tick_flag_speed_capped;
  if (s.tool.contact.overflow() || s.mirrored.contact.overflow()) flags |= tick_flag_contact_overflow;
  return flags;
}

}  // namespace

Reaction Simulation::advance(const ToolInput& input) {
  const DenormalsFlushed flushed;
  State& s = *state_;
  const bool both = s.scene.symmetry.on;
  std::array<TouchingTool, 2> tools;
  tools[0] = touch(s, s.tool, input.pose, input);
  if (both) tools[1] = touch(s, s.mirrored, mirrored_pose(s.scene.symmetry, input.pose), input);
  s.relaxed = relax(s.lattice, relax_settings(s), std::span<const TouchingTool>(tools.data(), both ? 2 : 1));
  if (s.scene.tool.action == ToolAction::smooth) {
    smooth(s, s.tool);
    if (both) smooth(s, s.mirrored);
  }
  s.mapping.update(s.lattice);
  ++s.tick;

  const ContactConstraints& constraints = s.tool.contact.constraints();
  const ContactConstraints& mirrored = s.mirrored.contact.constraints();
  s.reaction.force_n = constraints.tool_impulse() * (real_over_felt(s) / s.relaxed.material_time_s);
  s.reaction.proxy = {s.tool.state.position_m, input.pose.orientation};
  s.reaction.touching = constraints.acted();
  s.reaction.mirror_touching = both && mirrored.acted();
  s.reaction.flags = flags_of(s);
  std::fill(s.touched.begin(), s.touched.end(), std::uint8_t{0});
  constraints.mark_touched(s.touched.data());
  if (both) mirrored.mark_touched(s.touched.data());
  return s.reaction;
}

const Scene& Simulation::scene() const {
  return state_->scene;
}
void Simulation::write_scene(Scene& scene) const {
  scene = state_->scene;
  scene.body.surface = state_->mapping.current();
}
std::uint64_t Simulation::tick() const {
  return state_->tick;
}
const SpringLattice& Simulation::lattice() const {
  return state_->lattice;
}
const Surface& Simulation::surface() const {
  return state_->mapping.current();
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
  s.lattice.visit_state([&](const float* data, std::size_t count) { hash.add(data, count); });
  const ControlNet& net = s.mapping.current().net;
  for (const std::vector<double>* coordinate : {&net.x, &net.y, &net.z}) {
    for (const double value : *coordinate) hash.add(value);
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
  state_->lattice.write_shape(shape.lattice);
}

Status Simulation::restore(const ShapeState& shape) {
  const DenormalsFlushed flushed;
  if (!state_->lattice.set_shape(shape.lattice)) return Error{"shape: it belongs to another lattice"};
  state_->tool.contact.release();
  state_->mirrored.contact.release();
  state_->mapping.update(state_->lattice);
  return {};
}

namespace {

void write_symmetry(const Simulation::State& s, Snapshot& snapshot) {
  snapshot.symmetric = s.scene.symmetry.on;
  snapshot.symmetry = {s.scene.symmetry.point_m, s.scene.symmetry.normal};
  snapshot.mirrored_proxy = {s.mirrored.state.position_m, s.mirrored.hand.orientation};
}

}  // namespace

void Simulation::write_snapshot(Snapshot& snapshot) const {
  const State& s = *state_;
  snapshot.tick = s.tick;
  write_surface(s.mapping.current(), snapshot.surfaces);
  write_lattice(s.lattice, s.held, s.touched, snapshot.lattice);
  snapshot.tool.kind = s.scene.tool.kind;
  snapshot.tool.action = s.scene.tool.action;
  snapshot.tool.iterations = s.scene.tool.iterations;
  snapshot.tool.radius_m = s.scene.tool.kind == ToolKind::point ? 0.0 : s.scene.tool.radius_m;
  snapshot.tool.device = s.tool.hand;
  snapshot.tool.proxy = s.reaction.proxy;
  write_symmetry(s, snapshot);
  snapshot.planes.clear();
  for (const FixingPlane& plane : s.scene.planes) snapshot.planes.push_back({plane.point_m, plane.normal});
  snapshot.contacts.reserve(1);  // before the first contact, which must not allocate
  snapshot.contacts.clear();
  const CollisionResult& collision = s.tool.contact.collision();
  if (s.reaction.touching && collision.found) {
    const SurfaceContact& nearest = collision.nearest;
    snapshot.contacts.push_back({nearest.point_m, nearest.normal, nearest.depth_m, nearest.u, nearest.v});
  }
  write_material(s.scene, s.lattice, snapshot.material);
  snapshot.device.force_scale = s.scene.sculpting.force_scale;
  snapshot.substeps = s.relaxed.substeps * s.scene.tool.iterations;
  snapshot.flags = s.reaction.flags;
}

}  // namespace spoonbill
