// State of a simulation and the steps that change it. Private to engine/simulation.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/scene_contacts.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Tool in the user's hand, or its mirror image. The C++ object may be moved: `contact` stores addresses of
// grids only, and the grids stay where they are, because each mapping holds its grid by a shared pointer.
struct HeldTool {
  ToolContact contact;
  Pose hand{};  // pose of the hand in the last tick
  ToolState state{};
  bool placed = false;
  bool lattice_placed = false;  // true if the lattice of the present soft tool is at the proxy

  void place(const Pose& pose) {
    hand = pose;
    state.position_m = pose.position_m;
    state.velocity_m_per_s.setZero();
    placed = true;
    lattice_placed = false;
  }
};

// Pushes of contacts on a body in a tick.
struct ContactPushes {
  Vector3 impulse_ns = Vector3::Zero();         // of other bodies on the body, N s
  Vector3 ground_impulse_ns = Vector3::Zero();  // of the ground on the body, N s
  double work_j = 0.0;                          // of a body with a prescribed motion on others, J
};

struct Simulation::State {
  Scene scene;
  InstructionSet set;
  std::vector<BodyState> bodies;  // bodies of the scene in its order, then the tool if it is soft
  ToolModel model;                // model of the most recent solid tool
  HeldTool tool;
  HeldTool mirrored;
  BodyContacts between;
  std::vector<BodyPairContact> pairs;                // all pairs: (0, 1), (0, 2), (1, 2), ...
  std::vector<BodySelfContact> self;                 // self-contact of each body
  BodyGroundContact ground_contact;                  // contacts of the scene's bodies; empty without a ground
  std::vector<RigidGroundContact> rigid_ground;      // contacts of each of the scene's bodies
  std::vector<SampledGroundContact> sampled_ground;  // of each of them, for soft bodies in boxes of cells
  bool pairs_overflow = false;                       // whether the last search exceeded a capacity
  double tool_gap_m = 0.0;  // smallest gap between a soft tool and a body; infinite if none is near
  Box scene_box;            // box around the bodies at rest
  int limited_body = -1;    // a body that BodyHold::limit() restored in the last tick, or -1
  // Bodies of all solid tools so far, the last one included, and triangles of replaced soft tools. They are
  // kept, because snapshots share them and no tick may free the last reference.
  std::vector<std::shared_ptr<const ToolBody>> retired_bodies;
  std::vector<std::shared_ptr<const std::vector<TriangleCorners>>> retired_triangles;
  std::uint64_t tick = 0;
  int substeps = 1;            // number of substeps of a tick at rest
  int real_time_substeps = 1;  // number of substeps at rest with an inertia scale of 1
  RelaxReport relaxed{};       // of all parts of the last tick
  std::array<ContactPushes, lattice_capacity> pushes{};  // in the last tick, by body
  double overlap_m = 0.0;          // largest overlap of two bodies that was found in the last tick
  bool contacts_overflow = false;  // whether a search of the last tick exceeded a capacity
  Reaction reaction{};
  std::optional<RefineKnots> wanted_refinement = {};  // see Simulation::wanted_refinement()
  SearchedShapes searched{};                          // the shapes for which `between` was found

  bool tool_is_soft() const {
    return scene.tool.kind == ToolKind::solid && bodies.size() > scene.bodies.size();
  }
  std::span<BodyState> scene_bodies() { return {bodies.data(), scene.bodies.size()}; }
  // Number of bodies that a tick moves. A soft tool pauses while the hand holds another tool.
  std::size_t stepped_count() const { return scene.bodies.size() + (tool_is_soft() ? 1 : 0); }
  std::span<const BodyState> stepped_bodies() const { return {bodies.data(), stepped_count()}; }
  const Material& material(std::size_t body) const {
    return body < scene.bodies.size() ? scene.bodies[body].material : scene.tool.body->soft->material;
  }
};

ContactScene find_contact_scene(const Scene& scene);
// Exchanges the contacts. Allocates nothing.
void exchange_contacts(Simulation::State& state, SceneContacts& contacts);
// Makes all contacts again, without forces.
void make_contacts(Simulation::State& state);
// Returns the planes that fix nodes of the body: none if the body is rigid.
std::vector<FixingPlane> planes_through(const BodyState& body, const std::vector<FixingPlane>& planes);
// Moves the point of a body's motion with the body, or with the hand that holds it, to where it is now.
void carry_motion(const BodyState& state, Body& body);

// Chooses the substeps of a tick and the inertia scale of each body. A body with fixed nodes has its own
// scale, which is 1 if the body uses the implicit solver. All other bodies share the largest of their scales,
// so that momentum is exchanged correctly and all fall alike. Call after a change of bodies, fixed nodes,
// tool or settings; may allocate.
void update_inertia(Simulation::State& state);

// Bodies and tool in a tick, as ToolKernel::constrain() receives them.
struct ToolTouch {
  std::span<const BodyState> bodies;
  const ToolHold& hold;
  bool inside = false;  // true if the tool is inside a body
  bool holds = false;   // true if a push keeps hold of what it touches
};

// Kernel of a tool action. Each tick calls constrain() for the tool and its mirror image, moves the bodies,
// then calls reform() for both tools. Kernels run in the haptic thread: they must not allocate, lock, read a
// clock or throw.
struct ToolKernel {
  // Adds the constraints of this tick to `contact`.
  void (*constrain)(ToolContact& contact, const ToolTouch& touch) = nullptr;
  // Changes the shape of the bodies under the tool; null if the action only adds constraints.
  void (*reform)(Simulation::State& state, HeldTool& held) = nullptr;
  // False if the tool slides on the body without denting it (ToolMotion::body_yields).
  bool body_yields = true;
};

// Returns the kernel of a tool's action and reach. tool_step.cpp defines all kernels.
const ToolKernel& find_kernel(const Tool& tool);

// Returns the radius of a local stroke of the scene's tool on a body.
double choose_local_radius_m(const Tool& tool, const BodyState& body);

ToolHold make_hold(const ToolInput& input);
// Returns the hold of the mirrored tool, with mirrored pose and axes.
ToolHold make_mirrored_hold(const Symmetry& symmetry, const ToolInput& input);

// Finds the contact of a tool and its motion from the last tick's pose to the pose of `hold`.
TouchingTool touch(Simulation::State& state, HeldTool& held, ToolHold hold, double coupling_n_per_m);

// Turns a soft tool about its proxy from the orientation in the last tick to that of the hand. Call after the
// bodies have moved.
void turn_soft_tool(Simulation::State& state, const Quaternion& last);

// Computes the proxy, the force and the touching state of the tool in the user's hand, not of its mirror
// image. Call after the bodies have moved.
void react(Simulation::State& state, const ToolInput& input);

// Carries out commands outside the tick; may allocate. Each command first makes all new parts and changes the
// state only if that succeeds.
struct CommandApplier {
  Simulation::State& state;

  Status operator()(const PlacePlane& command);
  Status operator()(const RemovePlanes& command);
  Status operator()(const SetTool& command);
  Status operator()(const SetSymmetry& command);
  Status operator()(const ResetProxy& command);
  Status operator()(const LiftTool& command);
  Status operator()(const SetSculpting& command);
  Status operator()(const SetMaterial& command);
  Status operator()(const KeepShape& command);
  Status operator()(const RefineKnots& command);
  Status operator()(const TurnBody& command);
  Status operator()(const LowerBody& command);
  Status operator()(const MoveBody& command);

 private:
  void release();
  Status check_body(int body) const;
  // Returns a fixed body, or a rigid one that a hand holds; fails for any other body.
  Result<RigidBody*> find_driven(int body) const;
  // Makes the implicit solver of a body (make_implicit_solver()); a rigid body has none.
  Result<std::optional<ImplicitSolver>> make_solver_of(const BodyState& body, const SpringLattice& lattice,
                                                       const std::vector<Vector3>& rest_m) const;
  // Checks a tool. If the tool is a B-spline body that has already been modelled, does not check this body
  // again, because that takes as long as modelling it.
  Status check_changes(const Tool& tool) const;
  void adopt_model(ToolModel model);
  Status set_planes(std::vector<FixingPlane> planes);
  void set_skins(std::vector<SkinMapping> skins);
};

// Writes bodies and contacts into a snapshot. Allocates only at the first call and after a change of bodies,
// knots or tool.
void write_bodies(std::span<const BodyState> bodies, const Scene& scene, std::vector<BodySnapshot>& out);
void write_contacts(const Simulation::State& state, std::vector<ContactSnapshot>& contacts);

}  // namespace spoonbill
