#include "engine/simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/simulation/contact_area.h"
#include "engine/simulation/simulation_build.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {
namespace {

// Adds the body's name to an error if the scene has several bodies.
Error name_body(const Body& body, const Scene& scene, const Error& error) {
  return scene.bodies.size() == 1 ? error : error.in("body \"" + body.name + "\"");
}

Status check_scene(const Scene& scene) {
  if (Status status = check_tool(scene.tool); !status.ok()) return status;
  if (Status status = check_tool_and_symmetry(scene.tool, scene.symmetry); !status.ok()) return status;
  if (Status status = check_sculpting(scene.sculpting); !status.ok()) return status;
  if (Status status = check_body_count(scene); !status.ok()) return status;
  for (const Body& body : scene.bodies) {
    if (Status status = check_lattice_request(body.lattice); !status.ok()) return status;
    if (Status status = check_loads(body); !status.ok()) return status;
    if (Status status = check_kind(body); !status.ok()) return name_body(body, scene, status.error());
  }
  if (Status status = check_trial(scene); !status.ok()) return status;
  for (const FixingPlane& plane : scene.planes) {
    if (Status status = check_fixing_plane(plane); !status.ok()) return status;
  }
  if (scene.ground) {
    if (Status status = check_ground(*scene.ground); !status.ok()) return status;
  }
  return check_symmetry(scene.symmetry);
}

// Returns the box around the first `count` bodies at rest.
Box find_scene_box(const std::vector<BodyState>& bodies, std::size_t count) {
  Box box;
  for (std::size_t b = 0; b < count; ++b) {
    for (const Vector3& node : bodies[b].lattice.mesh().nodes) box.include(node);
  }
  return box;
}

}  // namespace

Result<Simulation> Simulation::make(Scene scene, InstructionSet set, const FeatureMapWatch& watch) {
  if (const Status status = check_scene(scene); !status.ok()) return status.error();
  std::vector<BodyState> bodies;
  for (const Body& body : scene.bodies) {
    Result<BodyState> state = make_body_state(body, scene.planes, set, watch, scene.sculpting.real_time);
    if (!state.ok()) return name_body(body, scene, state.error());
    bodies.push_back(std::move(state).value());
  }
  Result<ToolModel> model = make_tool_model(scene.tool, set);
  if (!model.ok()) return model.error();
  if (model->soft) bodies.push_back(*std::move(model->soft));
  model->soft.reset();
  SceneContacts contacts = make_scene_contacts(bodies, find_contact_scene(scene), model.value());
  std::vector<std::shared_ptr<const ToolBody>> retired_bodies = {find_model_body(scene.tool)};
  const Box scene_box = find_scene_box(bodies, scene.bodies.size());
  auto made = std::make_unique<State>(State{std::move(scene),
                                            set,
                                            std::move(bodies),
                                            std::move(model).value(),
                                            HeldTool{std::move(contacts.tool)},
                                            HeldTool{std::move(contacts.mirrored)},
                                            std::move(contacts.between),
                                            std::move(contacts.pairs),
                                            std::move(contacts.self),
                                            std::move(contacts.ground),
                                            std::move(contacts.rigid_ground),
                                            std::move(contacts.sampled_ground),
                                            false,
                                            0.0,
                                            scene_box,
                                            -1,
                                            std::move(retired_bodies),
                                            {}});
  made->searched = std::move(contacts.searched);
  update_inertia(*made);
  return Simulation(std::move(made));
}

Simulation::Simulation(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

void update_inertia(Simulation::State& s) {
  const auto is_fixed = [](const BodyState& body) { return body.lattice.has_fixed_nodes(); };
  const std::span<BodyState> bodies(s.bodies.data(), s.stepped_count());
  const int wanted = s.scene.tool.substeps;
  double real_time_step_s = tick_s / wanted;
  for (BodyState& body : bodies) {
    if (!body.solver() && !body.rigid)
      real_time_step_s = body.lattice.find_real_time_step_s(real_time_step_s);
  }
  const Sculpting& sculpting = s.scene.sculpting;
  s.real_time_substeps = sculpting.step_division * static_cast<int>(std::lround(tick_s / real_time_step_s));
  s.substeps = sculpting.real_time ? s.real_time_substeps : wanted;
  const double step_s = tick_s / s.substeps;
  const auto own_scale = [&](BodyState& body) {
    return body.solver() || body.rigid ? 1.0 : body.lattice.find_inertia_scale(step_s);
  };
  double shared = 1.0;
  for (BodyState& body : bodies) {
    if (!is_fixed(body)) shared = std::max(shared, own_scale(body));
  }
  const auto is_held = [&](const BodyState& body) {
    return is_fixed(body) || (body.rigid && body.rigid->hand() != nullptr);
  };
  for (BodyState& body : bodies) body.set_inertia(is_held(body) ? own_scale(body) : shared, step_s);
}

Status Simulation::apply(const Command& command) {
  const DenormalsFlushed flushed;  // every thread then computes the same bits
  const Status applied = std::visit(CommandApplier{*state_}, command);
  if (applied.ok()) state_->searched.forget();
  return applied;
}

const Scene& Simulation::scene() const {
  return state_->scene;
}
void Simulation::write_scene(Scene& scene) const {
  scene = state_->scene;
  reserve_for_refinement(scene);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (state_->bodies[b].mesh()) {
      scene.bodies[b].mesh_pose = composed(state_->bodies[b].rigid->pose(), scene.bodies[b].mesh_pose);
    } else {
      scene.bodies[b].surface = state_->bodies[b].mapping().current();
    }
    carry_motion(state_->bodies[b], scene.bodies[b]);
  }
}

const std::optional<RefineKnots>& Simulation::wanted_refinement() const {
  return state_->wanted_refinement;
}
std::vector<std::string> Simulation::warnings() const {
  std::vector<std::string> warnings;
  for (const Body& body : state_->scene.bodies) {
    const auto at = static_cast<std::size_t>(&body - state_->scene.bodies.data());
    const std::string warning = describe_lattice_warning(state_->bodies[at], body.lattice);
    if (!warning.empty())
      warnings.push_back(name_body(body, state_->scene, Error{ErrorCode::internal, warning}).message);
  }
  return warnings;
}
std::uint64_t Simulation::tick() const {
  return state_->tick;
}
const SpringLattice& Simulation::lattice(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->bodies[static_cast<std::size_t>(body)].lattice;
}
Vector3 Simulation::support_force_n(int support, int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  const auto at = static_cast<std::size_t>(body);
  return state_->bodies[at].supports.supports()[static_cast<std::size_t>(support)].impulse_ns / tick_s;
}
Vector3 Simulation::contact_force_n(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->pushes[static_cast<std::size_t>(body)].impulse_ns / tick_s;
}
double Simulation::contact_work_j(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->pushes[static_cast<std::size_t>(body)].work_j;
}
Vector3 Simulation::tool_force_n(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->scene.bodies.size()));
  Vector3 impulse_ns = -state_->tool.contact.constraints().tool_impulse(body);
  if (state_->scene.symmetry.on) impulse_ns -= state_->mirrored.contact.constraints().tool_impulse(body);
  return impulse_ns / tick_s;
}
double Simulation::contact_area_m2(int body) const {
  return find_contact_area_m2(*state_, body);
}
bool Simulation::is_gone(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->bodies[static_cast<std::size_t>(body)].is_gone;
}
std::optional<Pose> Simulation::rigid_pose(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  const std::optional<RigidBody>& rigid = state_->bodies[static_cast<std::size_t>(body)].rigid;
  return rigid ? std::optional(rigid->pose()) : std::nullopt;
}
const RigidDynamics* Simulation::rigid_dynamics(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  const std::optional<RigidBody>& rigid = state_->bodies[static_cast<std::size_t>(body)].rigid;
  return rigid ? rigid->dynamics() : nullptr;
}
double Simulation::fastest_m_per_s(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->bodies[static_cast<std::size_t>(body)].fastest_m_per_s();
}
bool Simulation::is_moving_bodies() const {
  return std::any_of(state_->bodies.begin(), state_->bodies.end(), [](const BodyState& body) {
    return body.lowering_m_per_s > 0.0 || (body.rigid && body.rigid->is_driven());
  });
}
int Simulation::body_at_fault() const {
  return state_->limited_body >= 0 ? state_->limited_body : state_->relaxed.at_fault;
}
double Simulation::largest_overlap_m() const {
  return state_->overlap_m;
}
Vector3 Simulation::ground_force_n(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->pushes[static_cast<std::size_t>(body)].ground_impulse_ns / tick_s;
}
int Simulation::substeps() const {
  return state_->substeps;
}
int Simulation::real_time_substeps() const {
  return state_->real_time_substeps;
}
double Simulation::smallest_contact_radius_m(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  const BodyState& state = state_->bodies[static_cast<std::size_t>(body)];
  return state.rigid ? 0.0 : find_smallest_contact_radius_m(state);
}
const LatticeReport& Simulation::report(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->bodies[static_cast<std::size_t>(body)].report();
}
Box Simulation::bounds(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  const BodyState& state = state_->bodies[static_cast<std::size_t>(body)];
  const MeshMapping* const mesh = state.mesh();
  return mesh ? mesh->current().bounds() : bounding_box(state.mapping().current().net);
}
const Surface& Simulation::surface(int body) const {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state_->bodies.size()));
  return state_->bodies[static_cast<std::size_t>(body)].mapping().current();
}

namespace {

void add_to_hash(const HeldTool& held, StateHash& hash) {
  for (const Vector3& vector : {held.hand.position_m, held.state.position_m, held.state.velocity_m_per_s}) {
    for (int axis = 0; axis < 3; ++axis) hash.add(vector[axis]);
  }
  for (int c = 0; c < 4; ++c) hash.add(held.hand.orientation.coeffs()[c]);
  const std::uint64_t lifted = held.contact.lifted() ? std::uint64_t{1} << 32 : 0;
  const std::uint64_t hovered = held.contact.hovered() ? std::uint64_t{1} << 33 : 0;
  held.contact.visit_state([&](const double* data, std::size_t count) { hash.add(data, count); });
  hash.add(lifted | hovered | static_cast<std::uint64_t>(held.contact.constraints().count()));
}

}  // namespace

std::uint64_t Simulation::state_hash() const {
  const State& s = *state_;
  StateHash hash;
  hash.add(s.tick);
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    const BodyState& body = s.bodies[b];
    body.lattice.visit_state([&](const float* data, std::size_t count) { hash.add(data, count); });
    if (body.implicit_solver) {
      body.implicit_solver->visit_state(
          [&](const double* data, std::size_t count) { hash.add(data, count); });
    }
    if (body.rigid) {
      body.rigid->visit_state([&](const double* data, std::size_t count) { hash.add(data, count); });
    }
    if (body.lowering_m_per_s > 0.0) hash.add(body.lowering_m_per_s);
    if (!body.mesh() && body.mapping().catch_up_ticks_left() > 0) {
      hash.add(static_cast<std::uint64_t>(body.mapping().catch_up_ticks_left()));
    }
    if (body.is_gone) hash.add(std::uint64_t{1});
    if (s.scene.ground && body.implicit_solver) {
      body.implicit_solver->visit_state_on_ground(
          [&](const double* data, std::size_t count) { hash.add(data, count); });
    }
    if (body.mesh()) continue;  // the vertices of a mesh follow from the nodes
    const ControlNet& net = body.mapping().current().net;
    for (const std::vector<double>* coordinate : {&net.x, &net.y, &net.z}) {
      for (const double value : *coordinate) hash.add(value);
    }
  }
  if (s.scene.ground) {
    s.ground_contact.visit_state([&](const double* data, std::size_t count) { hash.add(data, count); });
  }
  s.between.visit_state([&](const double* data, std::size_t count) { hash.add(data, count); });
  if (s.between.count() > 0) {
    s.searched.visit_state([&](const double* data, std::size_t count) { hash.add(data, count); });
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
  shape.lattices.resize(state_->scene.bodies.size());
  shape.poses.resize(state_->scene.bodies.size());
  shape.hands.resize(state_->scene.bodies.size());
  shape.solver_rests.resize(state_->scene.bodies.size());
  for (std::size_t b = 0; b < shape.lattices.size(); ++b) {
    state_->bodies[b].lattice.write_shape(shape.lattices[b]);
    if (const ImplicitSolver* const solver = state_->bodies[b].solver()) {
      shape.solver_rests[b].assign(solver->rest_m().begin(), solver->rest_m().end());
    } else {
      shape.solver_rests[b].clear();
    }
    if (!state_->bodies[b].rigid) continue;
    shape.poses[b] = state_->bodies[b].rigid->pose();
    shape.hands[b] = state_->bodies[b].rigid->motion().end;
  }
}

std::shared_ptr<SimulationBuild> copy_mappings(std::span<const BodyState> bodies) {
  auto build = std::make_shared<SimulationBuild>();
  for (const BodyState& body : bodies) {
    build->mappings.push_back(body.mesh() ? std::nullopt : std::optional(body.mapping()));
  }
  return build;
}

std::shared_ptr<SimulationBuild> Simulation::copy_build(BuildPart part) const {
  const std::span<BodyState> bodies = state_->scene_bodies();
  if (part == BuildPart::mappings) return copy_mappings(bodies);
  return std::make_shared<SimulationBuild>(
      SimulationBuild{{bodies.begin(), bodies.end()}, state_->scene.bodies, state_->scene.planes});
}

std::shared_ptr<SimulationBuild> Simulation::exchange_build(std::shared_ptr<SimulationBuild> build) {
  const std::span<BodyState> bodies = state_->scene_bodies();
  SPOONBILL_ASSERT(build != nullptr && (build->mappings.empty() ? build->states.size()
                                                                : build->mappings.size()) == bodies.size());
  const DenormalsFlushed flushed;
  if (build->mappings.empty()) {
    std::swap_ranges(build->states.begin(), build->states.end(), bodies.begin());
    std::swap(build->bodies, state_->scene.bodies);
    std::swap(build->planes, state_->scene.planes);
    update_inertia(*state_);
  }
  for (std::size_t b = 0; b < build->mappings.size(); ++b) {
    if (!build->mappings[b]) continue;
    std::swap(*build->mappings[b], bodies[b].mapping());
    bodies[b].is_refined_enough = false;
    state_->scene.bodies[b].surface = bodies[b].mapping().current();
  }
  state_->wanted_refinement.reset();
  const ToolContact tool = std::move(state_->tool.contact), mirrored = std::move(state_->mirrored.contact);
  make_contacts(*state_);
  state_->tool.contact.keep_suspension(tool);
  state_->mirrored.contact.keep_suspension(mirrored);
  return build;
}

Status Simulation::restore(const ShapeState& shape) {
  const DenormalsFlushed flushed;
  bool fits = shape.lattices.size() == state_->scene.bodies.size() &&
              shape.poses.size() == state_->scene.bodies.size() && shape.hands.size() == shape.poses.size();
  for (std::size_t b = 0; fits && b < shape.lattices.size(); ++b) {
    const ImplicitSolver* const solver = state_->bodies[b].solver();
    fits = shape.lattices[b].size() == state_->bodies[b].lattice.shape_size() &&
           (!solver ||
            (b < shape.solver_rests.size() && shape.solver_rests[b].size() == solver->rest_m().size()));
  }
  if (!fits) return Error{ErrorCode::mismatch, "shape: belongs to another lattice"};
  for (std::size_t b = 0; b < shape.lattices.size(); ++b) {
    BodyState& body = state_->bodies[b];
    body.lattice.set_shape(shape.lattices[b]);
    if (body.rigid) {
      body.rigid->place(shape.poses[b]);
      if (body.rigid->hand()) body.rigid->place_hand(shape.hands[b]);
    }
    body.lowering_m_per_s = 0.0;
    if (body.solver()) {
      body.solver()->restore_rest(shape.solver_rests[b]);
      body.solver()->adopt_shape(body.lattice);
    }
    if (!body.mesh()) body.mapping().finish_catching_up();
    body.update_skin();
  }
  state_->ground_contact.forget();
  for (BodyPairContact& pair : state_->pairs) pair.forget();
  state_->between.forget();
  state_->searched.forget();
  state_->tool.contact.release();
  state_->mirrored.contact.release();
  state_->wanted_refinement.reset();
  return {};
}

namespace {

void write_local_reach(const Simulation::State& s, ToolSnapshot& tool) {
  tool.local_radius_m = 0.0;
  tool.is_local = s.scene.tool.is_local();
  if (!tool.is_local) return;
  const LocalStroke& stroke = s.tool.contact.local_stroke();
  if (stroke.is_active()) {
    tool.local_body = stroke.body();
    tool.local_point_m = stroke.point_m(s.bodies[static_cast<std::size_t>(stroke.body())].lattice);
    tool.local_radius_m = stroke.radius_m();
    return;
  }
  const int body = s.tool.contact.deepest_body();
  const CollisionResult& collision = s.tool.contact.collision(body);
  if (!collision.found) return;
  tool.local_body = body;
  tool.local_point_m = collision.nearest.point_m;
  tool.local_radius_m = choose_local_radius_m(s.scene.tool, s.bodies[static_cast<std::size_t>(body)]);
}

void write_symmetry(const Simulation::State& s, Snapshot& snapshot) {
  snapshot.symmetric = s.scene.symmetry.on;
  snapshot.symmetry = {s.scene.symmetry.point_m, s.scene.symmetry.normal};
  snapshot.mirrored_proxy = {s.mirrored.state.position_m, s.mirrored.hand.orientation};
}

}  // namespace

void Simulation::write_snapshot(Snapshot& snapshot) const {
  const State& s = *state_;
  snapshot.tick = s.tick;
  // A soft tool has no position before the first tick after it appears.
  const std::size_t drawn =
      s.tool.placed && s.tool.lattice_placed ? s.stepped_count() : s.scene.bodies.size();
  write_bodies({s.bodies.data(), drawn}, s.scene, snapshot.bodies);
  snapshot.tool.kind = s.scene.tool.kind;
  snapshot.tool.action = s.scene.tool.action;
  snapshot.tool.substeps = s.scene.tool.substeps;
  snapshot.tool.radius_m = s.scene.tool.kind == ToolKind::point ? 0.0 : s.scene.tool.radius_m;
  snapshot.tool.body = s.scene.tool.body;
  write_local_reach(s, snapshot.tool);
  snapshot.tool.device = s.tool.hand;
  snapshot.tool.proxy = s.reaction.proxy;
  write_symmetry(s, snapshot);
  snapshot.planes.clear();
  for (const FixingPlane& plane : s.scene.planes) snapshot.planes.push_back({plane.point_m, plane.normal});
  write_contacts(s, snapshot.contacts);
  snapshot.device.force_scale = s.scene.sculpting.force_scale;
  snapshot.substeps = s.relaxed.substeps;
  snapshot.real_time_substeps = s.real_time_substeps;
  snapshot.flags = s.reaction.flags;
}

}  // namespace spoonbill
