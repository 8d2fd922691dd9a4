// Advances all lattices of a scene by one tick. Springs are stepped by the symplectic Euler method in several
// substeps; an implicit solver takes one step. Contacts are solved within the substeps. Does not allocate.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/contact/body_contacts.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/material/contact/ground_contacts.h"
#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/rigid/rigid_dynamics.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Nodes of a lattice that one support fixes, and the support's motion through a tick. Plain data that the
// owner of the body stores from tick to tick. Nodes are in ascending order and must be fixed in the lattice.
// The displacement of each node is its `base_m` plus the displacement of the support.
struct SupportedNodes {
  std::vector<int> nodes;
  std::vector<Vector3> base_m;
  bool moves = false;
  Vector3 start_m = Vector3::Zero();  // displacement of the support at the start of the tick
  Vector3 end_m = Vector3::Zero();
  // Longest distance that the prescribed motion covers in a tick. A support that catches up may move farther.
  double largest_step_m = 0.0;
  Vector3 impulse_ns = Vector3::Zero();  // impulse of the support on the body in the tick, N s
};

// Largest factor by which strain, or in real time the speed of nodes and of impacts, may raise the number of
// substeps. If strain requires more substeps, the inertia of the strained nodes is raised just enough for
// stability. These nodes respond more slowly, which hardly shows in a damped, quasi-static body.
inline constexpr int substep_ceiling = 4;

// Longest substep, as a fraction of the measured stability limit. The reserve is needed because the running
// estimate of the fastest frequency lags a sudden contact by tens of ticks.
inline constexpr double stability_fraction = 0.85;

// Distance in cells that defines the speed cap: a node moves at most this far in the longest of three times.
// They are the substep, the damping time (by which damping extrapolates the node's motion), and 2 / w, the
// longest undamped step that is stable for the lattice, whose fastest angular frequency is w. Speeds are
// relative to the soft tool or support that carries the whole body, or to the mean velocity of a body without
// fixed nodes.
//
// Waves cross a cell in about 2 / w, so nodes stay below about a tenth of the wave speed. An impact strains
// even a soft, undamped body by no more than its springs can restore. In real time, where a body that falls
// may hit another one faster than that, the cap is a tenth of a cell a substep. Damping then follows only the
// part of a node's speed that moves it by extrapolation_cap_cells in the damping time, so that it does not
// extrapolate a spring of a cell's length through zero length.
inline constexpr double speed_cap_cells = 0.1;
inline constexpr double extrapolation_cap_cells = 0.5;

// Settings of relax(). Tracking the fastest frequency costs about as much as a substep, and so does plastic
// flow. The two alternate with `tick`: even ticks track the frequency, and odd ticks compute the flow of two
// ticks.
struct RelaxSettings {
  std::uint64_t tick = 0;
  int substeps = 1;                   // number of substeps at rest; see substep_ceiling
  double time_s = 1e-3;               // duration of the part of the tick
  double drag_per_s = 0.0;            // mass-proportional drag; the least drag if `is_critically_damped`
  bool is_critically_damped = false;  // true if each body is critically damped, see critical_damping_per_s()
  // True if bodies have their real inertia. Nodes may then be faster, see speed_cap_cells; contacts and
  // supports may not. Faster nodes raise the number of substeps, and nodes outside a body follow it (see
  // OutsideNodes).
  bool is_real_time = false;
  int step_division = 1;    // divides each substep further, whatever required it
  int part = 0, parts = 1;  // index of the part of the tick, and number of parts
};

// Prescribed motion of a rigid body, or of the hand that holds it, through a tick. The poses map the rest
// position of a node to its position.
struct RigidMotion {
  Pose start, end;
  bool moves = false;  // false if both poses are the same
};

// A lattice that relax() advances, with its solver, supports and gravity. Pointers must stay valid during the
// call.
struct RelaxedLattice {
  SpringLattice* lattice;
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  // Implicit solver that advances the lattice; null if the lattice is advanced explicitly by its springs.
  ImplicitSolver* implicit_solver = nullptr;
  std::span<SupportedNodes> supports = {};
  // Motion of a rigid body; null for a deformable body. The lattice of a rigid body is the frame to which its
  // surface is attached (rigid_frame()). Its nodes follow the motion, unless `dynamics` moves them.
  const RigidMotion* rigid_motion = nullptr;
  // Dynamics of a rigid body that contacts can move; null for any other body. `hand` is the spring by which a
  // hand, which follows `rigid_motion`, holds the body; null if the body is free.
  RigidDynamics* dynamics = nullptr;
  const HandSpring* hand = nullptr;
};

// Results of relax() for one tick.
struct RelaxReport {
  int substeps = 0;           // number of substeps in the tick
  bool nodes_slowed = false;  // true if strain required more substeps than the ceiling allows
  bool speed_capped = false;
  int at_fault = -1;  // index of a lattice that was slowed or capped, or -1
};

// A tool that acts on the lattices: the motion that the hand prescribes, its state and its contacts in the
// tick.
struct TouchingTool {
  ToolMotion motion;
  ToolState* state;
  ContactConstraints* contacts;
};

// Advances at most lattice_capacity lattices by one tick, in as many substeps as the stiffest or fastest one
// needs. A lattice with an implicit solver takes one implicit step per tick, which computes its velocities
// without the contacts. The lattice moves with these velocities in each substep, and the contacts change
// them. If all lattices have implicit solvers, a tick takes one substep. Rigid bodies that contacts can move
// take the substeps of the settings at least.
//
// In each substep the tools act in their order, then bodies on each other, then the ground. A soft tool moves
// after the bodies have acted on it. A tool that touches only implicitly stepped lattices acts once, at the
// start of the tick. The caller must flush denormals for speed (see DenormalsFlushed).
RelaxReport relax(std::span<const RelaxedLattice> lattices, const RelaxSettings& settings,
                  std::span<const TouchingTool> tools, BodyContacts* between = nullptr,
                  GroundContacts* ground = nullptr);

// Damping relative to the critical damping of a body's present motion. It is slightly above 1, so that other
// modes do not carry the body past its rest shape.
inline constexpr double critical_damping_fraction = 1.1;

// Returns critical_damping_fraction times the critical damping of a motion, mass-proportional, 1/s. Critical
// damping brings the motion to rest soonest. `rayleigh_quotient` is (v.Kv) / (v.Mv) for the velocities v, the
// stiffness K and the mass M: the square of the motion's angular frequency. Damping adapts as in dynamic
// relaxation (Underwood 1983): fast modes decay first, then the slow modes at their smaller critical damping.
double critical_damping_per_s(double rayleigh_quotient);

// Returns the Rayleigh quotient (see critical_damping_per_s()) of a lattice's velocities; 0 at rest. The
// springs must be linearised. Overwrites the forces and the `moved` arrays of the view.
double rayleigh_quotient(const SpringLattice& lattice, const LatticeView& view);

}  // namespace spoonbill
