// State of one body of a simulation: lattice, skin, loads, supports and fixed nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_hold.h"
#include "engine/simulation/body_loads.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/mesh_mapping.h"
#include "engine/simulation/rigid_body.h"
#include "engine/simulation/smoothing.h"

namespace spoonbill {

// Mapping to the skin of a body.
using SkinMapping = std::variant<BodyMapping, MeshMapping>;

// State of one body. Plain data with one owner, the simulation.
struct BodyState {
  SpringLattice lattice;
  SkinMapping skin;
  Smoothing smoothing;
  std::vector<std::uint8_t> fixed, touched;            // one byte per node: 1 if fixed, 1 if touched
  std::optional<ImplicitSolver> implicit_solver = {};  // empty: the body uses the spring solver
  BodyHold hold = BodyHold(lattice);
  BodyLoads loads = {};
  BodySupports supports = {};
  double shell_thickness_m = 0.0;                // 0 for a solid
  std::shared_ptr<const TrimmedArea> trim = {};  // area within the trims; null without trims
  // Pose and motion of a rigid body, whose lattice is its frame (rigid_frame()); empty for a deformable body.
  std::optional<RigidBody> rigid = {};
  // Speed at which the body is lowered until contacts bear it; 0 for any other body.
  double lowering_m_per_s = 0.0;

  // is_immovable() returns whether the body is rigid and nothing that touches it can move it,
  // is_movable_rigid() whether it is rigid and moves with its dynamics.
  bool is_immovable() const { return rigid && rigid->dynamics() == nullptr; }
  bool is_movable_rigid() const { return rigid && rigid->dynamics() != nullptr; }

  // Fixes the nodes behind the planes, then the nodes of the supports; frees all others. Planes have no
  // effect on rigid bodies: all nodes of one without dynamics are fixed, and none of one with dynamics.
  void fix_nodes_behind(const std::vector<FixingPlane>& planes);
  // Sets the fixed nodes, one byte per node.
  void fix(std::vector<std::uint8_t> nodes) {
    SPOONBILL_ASSERT(nodes.size() == static_cast<std::size_t>(lattice.mesh().node_count()));
    fixed = std::move(nodes);
    lattice.fix_nodes(fixed);
    if (lattice.has_fixed_nodes()) lowering_m_per_s = 0.0;
    if (implicit_solver) implicit_solver->fix_nodes(fixed);
  }
  void set_lattice(SpringLattice other) {
    lattice = std::move(other);
    hold = BodyHold(lattice);
  }
  void set_implicit_solver(std::optional<ImplicitSolver> solver) {
    implicit_solver = std::move(solver);
    if (implicit_solver) {
      implicit_solver->fix_nodes(fixed);
      implicit_solver->adopt_shape(lattice);
    }
    lattice.fix_nodes(fixed);
    lattice.set_contact_inverse_mass(implicit_solver ? implicit_solver->contact_inverse_mass() : 0.0);
  }
  // Returns the implicit solver of the body; null if the body uses the spring solver.
  ImplicitSolver* solver() { return implicit_solver ? &*implicit_solver : nullptr; }
  const ImplicitSolver* solver() const { return implicit_solver ? &*implicit_solver : nullptr; }
  // Sets the inertia scale for substeps of about step_s.
  void set_inertia(double scale, double step_s) {
    if (is_movable_rigid()) rigid->dynamics()->set_inertia_scale(scale);
    lattice.set_inertia(scale, step_s);
    if (!implicit_solver) return;
    implicit_solver->set_inertia_scale(scale);
    lattice.set_contact_inverse_mass(implicit_solver->contact_inverse_mass());
  }

  const LatticeReport& report() const { return solver() ? solver()->report() : lattice.report(); }

  // Returns the mapping to the surface. Every body has one except a body with a mesh.
  BodyMapping& mapping() {
    SPOONBILL_ASSERT(mesh() == nullptr);
    return *std::get_if<BodyMapping>(&skin);
  }
  const BodyMapping& mapping() const {
    SPOONBILL_ASSERT(mesh() == nullptr);
    return *std::get_if<BodyMapping>(&skin);
  }
  // Returns the triangles of a soft mesh tool or of a body with a mesh; null for any other body.
  const MeshMapping* mesh() const { return std::get_if<MeshMapping>(&skin); }

  bool is_gone = false;  // see Simulation::is_gone()
  // True if the surface is behind the lattice by more than the tolerance, and no refinement brings it closer.
  bool is_refined_enough = false;

  // Returns the highest speed of a node. For a fixed body, it is that of the last tick in which it moved.
  double fastest_m_per_s() const { return lattice.fastest_m_per_s(); }

  // Updates the skin to the present displacements of the lattice, or to the pose of a rigid body.
  void update_skin() {
    const auto update = [this](auto& mapping) {
      rigid ? mapping.place(rigid->pose()) : mapping.update(lattice);
    };
    std::visit(update, skin);
  }
};

// Makes the state of a body at rest. Refuses a body that cannot be simulated; the error names the field.
// If the scene is in real time then, contacts of soft bodies act on denser samples.
Result<BodyState> make_body_state(const Body& body, const std::vector<FixingPlane>& planes,
                                  InstructionSet set, const FeatureMapWatch& watch = {},
                                  bool is_real_time = false);

// Linear elastic bodies with at least this Young's modulus use the implicit solver, at their true stiffness.
// The few newtons of a hand dent such bodies by less than a third of a millimetre, but can bend them. Softer
// bodies can be dented. This requires a finer lattice, for which the spring solver is used.
inline constexpr double stiff_youngs_modulus_pa = 1e6;

// Makes the mapping of a body of a scene to its surface, or to its mesh. `lattice` is that of the body at
// rest. Planes have no effect on rigid bodies. `contact_cell_m` is that of BodyMapping::make().
Result<SkinMapping> make_skin(const Body& body, const SpringLattice& lattice,
                              const std::vector<FixingPlane>& planes, InstructionSet set,
                              double contact_cell_m);

// Makes the implicit solver of a lattice, which is unstrained while its nodes are at `rest_m`. Returns
// nothing if the body uses the spring solver. A body uses the implicit solver if all its materials are linear
// elastic and one of three conditions holds: the stiffest material has at least stiff_youngs_modulus_pa; a
// Poisson's ratio is below min_spring_poissons_ratio; or the body is a shell, which a single layer of springs
// would make twice too stiff in bending.
Result<std::optional<ImplicitSolver>> make_implicit_solver(const SpringLattice& lattice,
                                                           const std::vector<Vector3>& rest_m,
                                                           InstructionSet set);

// Returns the smallest radius of a contact whose force a body's cells resolve, m: 2 cells of springs, or 5 of
// the coarser cells of the implicit solver. Pressed by spheres whose contacts have this radius, blocks of
// springs are within 6 % of axisymmetric finite elements, and 6 to 12 % too stiff at 1.6 cells; at the sharp
// edge of a punch they need 5 cells for 10 %. On cells of the implicit solver, no contact up to 2.5 cells was
// within 10 % for both.
double find_smallest_contact_radius_m(const BodyState& body);

// describe_lattice_warning() warns if the relative error of a lattice's Young's modulus along an axis exceeds
// this value. Cells that are too slender for springs cause such errors.
inline constexpr double slender_stiffness_limit = 0.25;
// Returns one line that warns about a lattice that can be simulated but deviates from its material or from
// the request, and states a remedy. Empty if there is nothing to warn about.
std::string describe_lattice_warning(const BodyState& body, const LatticeRequest& request);

// Returns one byte per node, 1 for nodes behind a plane.
std::vector<std::uint8_t> find_nodes_behind(const SpringLattice& lattice,
                                            const std::vector<FixingPlane>& planes);

}  // namespace spoonbill
