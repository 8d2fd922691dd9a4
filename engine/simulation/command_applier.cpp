#include <utility>

#include "engine/simulation/refinement.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

std::vector<FixingPlane> planes_through(const BodyState& body, const std::vector<FixingPlane>& planes) {
  return body.rigid ? std::vector<FixingPlane>() : planes;
}

void carry_motion(const BodyState& state, Body& body) {
  if (!body.motion || !state.rigid) return;
  const Pose& pose = state.rigid->motion().end;
  body.motion->point_m = pose.position_m + pose.orientation * body.motion->point_m;
}

namespace {

// Returns the mapping of a body whose rest shape is the present one, with a lattice at rest there.
Result<SkinMapping> make_present_skin(const BodyState& body, const SpringLattice& lattice,
                                      const std::vector<FixingPlane>& planes, InstructionSet set) {
  if (const MeshMapping* const mesh = body.mesh()) return SkinMapping(mesh->rebased(lattice));
  const Surface& surface = body.mapping().current();
  Result<BodyMapping> mapping = BodyMapping::make(surface, surface, lattice, planes_through(body, planes),
                                                  set, body.mapping().contact_cell_m());
  if (!mapping.ok()) return mapping.error();
  return SkinMapping(std::move(mapping).value());
}

}  // namespace

Result<std::optional<ImplicitSolver>> CommandApplier::make_solver_of(
    const BodyState& body, const SpringLattice& lattice, const std::vector<Vector3>& rest_m) const {
  if (body.rigid) return std::optional<ImplicitSolver>();
  return make_implicit_solver(lattice, rest_m, state.set);
}

Status CommandApplier::operator()(const PlacePlane& command) {
  if (Status status = check_fixing_plane(command.plane); !status.ok()) return status;
  std::vector<FixingPlane> planes = state.scene.planes;
  planes.push_back(command.plane);
  if (Status status = check_range("fixing planes", static_cast<int>(planes.size()), fixing_plane_count_range);
      !status.ok()) {
    return status;
  }
  return set_planes(std::move(planes));
}

Status CommandApplier::operator()(const RemovePlanes&) {
  return set_planes({});
}

Status CommandApplier::check_changes(const Tool& tool) const {
  if (tool.kind != ToolKind::solid || !tool.body || tool.body != state.retired_bodies.back())
    return check_tool(tool);
  Tool bodiless = tool;
  bodiless.kind = ToolKind::point;
  return check_tool(bodiless);
}

Status CommandApplier::operator()(const SetTool& command) {
  const Tool& tool = command.tool;
  if (Status status = check_changes(tool); !status.ok()) return status;
  if (Status status = check_tool_and_symmetry(tool, state.scene.symmetry); !status.ok()) return status;
  const bool stays_soft =
      state.tool_is_soft() && tool.kind == ToolKind::solid && tool.body == state.scene.tool.body;
  if (tool.kind == ToolKind::solid && tool.body != state.retired_bodies.back()) {
    Result<ToolModel> model = make_tool_model(tool, state.set);
    if (!model.ok()) return model.error();
    state.retired_bodies.push_back(tool.body);
    adopt_model(std::move(model).value());
  }
  state.scene.tool = tool;
  update_inertia(state);
  if (!stays_soft) state.tool.lattice_placed = false;
  release();
  return {};
}

Status CommandApplier::operator()(const SetSymmetry& command) {
  if (Status status = check_symmetry(command.symmetry); !status.ok()) return status;
  if (Status status = check_tool_and_symmetry(state.scene.tool, command.symmetry); !status.ok())
    return status;
  state.scene.symmetry = command.symmetry;
  state.mirrored.contact.release();
  state.mirrored.placed = false;
  return {};
}

Status CommandApplier::operator()(const ResetProxy&) {
  release();
  state.tool.placed = state.mirrored.placed = false;
  return {};
}

Status CommandApplier::operator()(const LiftTool&) {
  state.tool.contact.lift();
  state.mirrored.contact.lift();
  return {};
}

Status CommandApplier::operator()(const SetSculpting& command) {
  if (Status status = check_sculpting(command.sculpting); !status.ok()) return status;
  state.scene.sculpting = command.sculpting;
  update_inertia(state);
  return {};
}

Status CommandApplier::operator()(const SetMaterial& command) {
  if (Status status = check_body(command.body); !status.ok()) return status;
  const std::size_t index = static_cast<std::size_t>(command.body);
  BodyState& body = state.bodies[index];
  LatticeMaterials materials = body.lattice.materials();
  materials.set_own(command.material);
  Result<SpringLattice> lattice = SpringLattice::make(body.lattice.mesh(), materials, state.set);
  if (!lattice.ok()) return lattice.error();
  lattice->set_shape(body.lattice.shape());
  // Rest shape of the new solver: the present shape if the body had no solver, otherwise the rest shape of
  // the old solver.
  Result<std::optional<ImplicitSolver>> solver =
      make_solver_of(body, lattice.value(),
                     body.implicit_solver ? body.implicit_solver->rest_m() : body.lattice.positions());
  if (!solver.ok()) return solver.error();
  body.set_lattice(std::move(lattice).value());
  body.set_implicit_solver(std::move(solver).value());
  Material& material = state.scene.bodies[index].material;
  if (body.is_movable_rigid()) {
    body.rigid->dynamics()->scale_mass(command.material.density_kg_per_m3 / material.density_kg_per_m3);
    body.rigid->dynamics()->place_nodes(body.lattice.view());
  }
  material = command.material;
  update_inertia(state);
  release();
  return {};
}

Status CommandApplier::operator()(const KeepShape&) {
  std::vector<SpringLattice> lattices;
  std::vector<std::optional<ImplicitSolver>> solvers;
  std::vector<SkinMapping> skins;
  for (std::size_t b = 0; b < state.scene.bodies.size(); ++b) {
    const BodyState& body = state.bodies[b];
    LatticeMesh mesh = body.lattice.mesh();
    mesh.nodes = body.lattice.positions();
    Result<SpringLattice> lattice = SpringLattice::make(mesh, body.lattice.materials(), state.set);
    if (!lattice.ok()) return lattice.error();
    lattice->fix_nodes(body.fixed);
    Result<SkinMapping> skin = make_present_skin(body, lattice.value(), state.scene.planes, state.set);
    if (!skin.ok()) return skin.error();
    Result<std::optional<ImplicitSolver>> solver = make_solver_of(body, lattice.value(), mesh.nodes);
    if (!solver.ok()) return solver.error();
    solvers.push_back(std::move(solver).value());
    lattices.push_back(std::move(lattice).value());
    skins.push_back(std::move(skin).value());
  }
  for (std::size_t b = 0; b < state.scene.bodies.size(); ++b) {
    state.bodies[b].smoothing = Smoothing(lattices[b].mesh());
    state.bodies[b].supports.rebase(state.bodies[b].lattice, lattices[b]);
    state.bodies[b].set_lattice(std::move(lattices[b]));
    state.bodies[b].set_implicit_solver(std::move(solvers[b]));
    carry_motion(state.bodies[b], state.scene.bodies[b]);
    if (std::optional<RigidBody>& rigid = state.bodies[b].rigid) {
      Pose& mesh_pose = state.scene.bodies[b].mesh_pose;
      if (state.bodies[b].mesh()) mesh_pose = composed(rigid->pose(), mesh_pose);
      rigid->keep_shape(state.bodies[b].lattice.mesh());
    }
  }
  update_inertia(state);
  set_skins(std::move(skins));
  return {};
}

Status CommandApplier::operator()(const RefineKnots& command) {
  if (Status status = check_body(command.body); !status.ok()) return status;
  const std::size_t index = static_cast<std::size_t>(command.body);
  if (!state.bodies[index].mesh() && !state.bodies[index].rigid)
    state.bodies[index].mapping().measure_residual();
  Result<PreparedRefinement> prepared = prepare_refinement(
      command, state.bodies, {find_contact_scene(state.scene), state.scene.planes, state.model});
  if (!prepared.ok()) return prepared.error();
  adopt_refinement(state, prepared.value());
  return {};
}

Result<RigidBody*> CommandApplier::find_driven(int body) const {
  if (Status status = check_body(body); !status.ok()) return status.error();
  std::optional<RigidBody>& rigid = state.bodies[static_cast<std::size_t>(body)].rigid;
  if (rigid && !rigid->is_free()) return &*rigid;
  return Error{ErrorCode::inconsistent, "only a fixed body moves so, or a rigid one that a hand holds",
               "body"};
}

Status CommandApplier::operator()(const TurnBody& command) {
  const Result<RigidBody*> rigid = find_driven(command.body);
  if (!rigid.ok()) return rigid.error().in("turn_body");
  if (Status status = check_fields("turn_body: ", command); !status.ok()) return status;
  rigid.value()->turn(command);
  return {};
}

Status CommandApplier::operator()(const MoveBody& command) {
  const Result<RigidBody*> rigid = find_driven(command.body);
  if (!rigid.ok()) return rigid.error().in("move_body");
  if (Status status = check_motion(command.motion); !status.ok()) return status.error().in("move_body");
  rigid.value()->move(command.motion);
  return {};
}

Status CommandApplier::operator()(const LowerBody& command) {
  if (Status status = check_body(command.body); !status.ok()) return status;
  if (Status status = check_fields("lower_body: ", command); !status.ok()) return status;
  BodyState& body = state.bodies[static_cast<std::size_t>(command.body)];
  if (body.rigid ? !body.rigid->is_free() : body.lattice.has_fixed_nodes()) {
    return Error{ErrorCode::inconsistent,
                 "lower_body: the body is fixed or held by a hand; only a free body is lowered", "body"};
  }
  if (state.scene.sculpting.gravity_m_per_s2.isZero(0.0)) {
    return Error{ErrorCode::missing, "lower_body: without gravity nothing is lowered", "gravity_m_per_s2"};
  }
  body.lowering_m_per_s = command.speed_m_per_s;
  return {};
}

Status CommandApplier::check_body(int body) const {
  return check_range("body", body, {0, static_cast<int>(state.scene.bodies.size()) - 1});
}

void CommandApplier::release() {
  state.between.forget();
  state.searched.forget();
  state.tool.contact.release();
  state.mirrored.contact.release();
}

Status CommandApplier::set_planes(std::vector<FixingPlane> planes) {
  std::vector<SkinMapping> skins;
  for (const BodyState& body : state.scene_bodies()) {
    if (body.mesh()) {
      skins.push_back(body.skin);
      continue;
    }
    Result<BodyMapping> mapping =
        BodyMapping::make(body.mapping().rest(), body.mapping().current(), body.lattice,
                          planes_through(body, planes), state.set, body.mapping().contact_cell_m());
    if (!mapping.ok()) return mapping.error();
    skins.push_back(std::move(mapping).value());
  }
  for (BodyState& body : state.scene_bodies()) {
    body.fix_nodes_behind(planes);
  }
  state.scene.planes = std::move(planes);
  update_inertia(state);
  set_skins(std::move(skins));
  return {};
}

void CommandApplier::set_skins(std::vector<SkinMapping> skins) {
  for (std::size_t b = 0; b < skins.size(); ++b) {
    state.bodies[b].skin = std::move(skins[b]);
    if (!state.bodies[b].mesh()) state.scene.bodies[b].surface = state.bodies[b].mapping().current();
  }
  state.wanted_refinement.reset();
  make_contacts(state);
}

// Replaces the model of the previous solid tool, and the body of a previous soft tool at the end of the list
// of bodies.
void CommandApplier::adopt_model(ToolModel model) {
  while (state.bodies.size() > state.scene.bodies.size()) state.bodies.pop_back();
  if (model.soft) state.bodies.push_back(*std::move(model.soft));
  model.soft.reset();
  if (state.model.triangles) state.retired_triangles.push_back(std::move(state.model.triangles));
  state.model = std::move(model);
  make_contacts(state);
}

}  // namespace spoonbill
