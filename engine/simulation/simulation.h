// The simulation: a scene and its state at a tick. It has one owner. After the start, only the haptic thread
// or the lock-step loop changes it. All other threads send commands and read snapshots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/rigid/rigid_dynamics.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/scene.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

inline constexpr double tick_s = 1e-3;

// A net is not refined by itself to more control points than this. With more, the search for self-contact
// takes so long that a tick of the bundled handle needs more than a millisecond.
inline constexpr int refined_control_point_limit = 1100;

// See Simulation::is_gone().
inline constexpr double gone_distance_m = 1.0;

// A rigid body that is held by a hand (Body::hand), and the pose that maps its rest shape to where the hand
// holds it at the end of a tick.
struct CarriedBody {
  int body = 0;  // index in the scene
  Pose pose;
};

// Input of the hand in one tick.
struct ToolInput {
  Pose pose;
  bool gripping = false;  // true while the button is down; a tool that pulls then keeps its grip
  // Stiffness of the spring between hand and tool, N/m; 0 for a hand that holds the tool rigidly. If a body
  // has an implicit solver, a spring of 1000 N/m replaces a rigid hold.
  double coupling_n_per_m = 0.0;
  // True while the hand moves the tool without touching the bodies, as a mouse moves a pointer. The tool does
  // not act until hovering ends and the tool is outside the bodies.
  bool hovering = false;
  // A body that the hand carries in this tick. It replaces a motion of that body that has not ended.
  std::optional<CarriedBody> carried = {};
};

// Response of the bodies to one tick.
struct Reaction {
  Vector3 force_n = Vector3::Zero();  // force on the tool, averaged over the tick
  Pose proxy;                         // pose at which the material stops the tool
  bool touching = false;
  bool mirror_touching = false;  // true if the mirrored tool touches; its force does not reach the hand
  std::uint32_t flags = tick_flag_none;
};

// State that a stroke can change and that undo restores bit for bit: the displacements, velocities, rest
// lengths, rest volumes and creep strains of the lattices, and the poses of rigid bodies. The control points
// follow from this state.
struct ShapeState {
  std::vector<std::vector<float>> lattices;  // shape of each body's lattice
  std::vector<Pose> poses = {};              // pose of each body that is rigid; the default pose for others
  std::vector<Pose> hands = {};              // pose of the hand that holds each body; the default for others
  // Rest positions of the nodes of each body with an implicit solver, which smoothing and local strokes move;
  // empty for others.
  std::vector<std::vector<Vector3>> solver_rests = {};
  friend bool operator==(const ShapeState&, const ShapeState&) = default;
};

// 64-bit FNV-1a hash of plain values (Fowler, Noll and Vo 1991), applied to words of four bytes instead of
// single bytes. Hashing a float costs one multiplication.
class StateHash {
 public:
  void add(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t bits;
      std::memcpy(&bits, values + i, sizeof bits);
      mix(bits);
    }
  }
  void add(const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) add(values[i]);
  }
  void add(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(std::uint64_t bits) {
    mix(static_cast<std::uint32_t>(bits));
    mix(static_cast<std::uint32_t>(bits >> 32));
  }

  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint32_t word) { hash_ = (hash_ ^ word) * 1099511628211ull; }

  std::uint64_t hash_ = 14695981039346656037ull;
};

// Everything that a stroke does not change and that commands replace: the bodies with their mappings,
// lattices and solvers, materials, fixed nodes and fixing planes.
struct SimulationBuild;
// The parts of a build: everything, or only the mappings to surfaces, if only knots will change.
enum class BuildPart { whole, mappings };

class Refiner;

class Simulation {
 public:
  // Builds grids, lattices and working memory. Refuses a scene that cannot be simulated; the error names the
  // field. `watch` receives the progress of feature maps, one body after the other.
  static Result<Simulation> make(Scene scene, InstructionSet set, const FeatureMapWatch& watch = {});

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  // Carries out a command between ticks; may allocate. An error leaves the simulation unchanged.
  Status apply(const Command& command);

  // Computes one tick, in which the hand moves from the pose of the last tick to the pose of `input`:
  // contacts, then lattices, then control points. Allocates nothing, never throws.
  Reaction advance(const ToolInput& input);

  // Returns the scene as it was set. Its surfaces date from the last change of knots, fixing planes or rest
  // shapes; surface() returns the current surfaces.
  const Scene& scene() const;
  // Writes the scene with current surfaces, for saving. Allocates only if `scene` has different bodies or a
  // different number of control points.
  void write_scene(Scene& scene) const;
  std::uint64_t tick() const;

  // Returns a hash of every bit that the next tick depends on, including the tick number.
  std::uint64_t state_hash() const;

  // Writes everything except force, button and device, which the owner of the haptic device adds.
  void write_snapshot(Snapshot& snapshot) const;

  ShapeState shape() const;
  // Writes the shape. Allocates only if `shape` has another size.
  void write_shape(ShapeState& shape) const;
  // Restores a shape. Fails if the shape belongs to another lattice.
  Status restore(const ShapeState& shape);

  // Returns the refinement of knots that a surface needs because it is behind its lattice by more than a
  // tolerance; empty if no surface does, or if no refinement helps. The tick finds it about every 64 ticks.
  const std::optional<RefineKnots>& wanted_refinement() const;

  // copy_build() returns a copy of the present build. exchange_build() takes a build of this simulation and
  // returns the one that it replaces; restore() must follow. A build of mappings may be exchanged only with
  // one that differs in knots alone. Both allocate. Neither `build` nor the results are null.
  std::shared_ptr<SimulationBuild> copy_build(BuildPart part = BuildPart::whole) const;
  std::shared_ptr<SimulationBuild> exchange_build(std::shared_ptr<SimulationBuild> build);

  // Carries out the refinement that `refiner` has prepared, as apply() would, between two ticks. Returns the
  // refiner's build of the mappings from before, which the caller may take. Allocates nothing.
  std::shared_ptr<SimulationBuild>& adopt(Refiner& refiner);

  // Warnings about the bodies' lattices, at most one line per body (describe_lattice_warning()).
  std::vector<std::string> warnings() const;

  // Lattice of a body of the scene, and the current surface of a body without a mesh, for studies and tests.
  const SpringLattice& lattice(int body = 0) const;
  const Surface& surface(int body = 0) const;
  // Box about the present control points of a body of the scene, or about the vertices of its mesh.
  Box bounds(int body) const;
  // inertia_scale() returns the inertia scale of a body. substeps() returns the number of substeps of a tick
  // at rest, real_time_substeps() the number that an inertia scale of 1 would need.
  double inertia_scale(int body = 0) const { return lattice(body).inertia_scale(); }
  int substeps() const;
  int real_time_substeps() const;
  // Returns the elasticity that the solver of the body achieves.
  const LatticeReport& report(int body = 0) const;

  // support_force_n(), ground_force_n() and contact_force_n() return the mean force of a support, of the
  // ground or of all other bodies on a body over the last tick.
  Vector3 support_force_n(int support, int body = 0) const;
  Vector3 ground_force_n(int body = 0) const;
  Vector3 contact_force_n(int body = 0) const;
  // Returns the work that a body with a prescribed motion did on other bodies in the last tick, J; 0 for any
  // other body, such as one that a hand or a support moves.
  double contact_work_j(int body) const;
  // Returns the mean force of the tool, and of its mirror image, on a body over the last tick. The force of a
  // soft tool is part of contact_force_n() instead.
  Vector3 tool_force_n(int body = 0) const;
  // Returns the area of a body's surface on which contacts pushed in the last tick, or in the last
  // part of a divided one (contact_area.h).
  // Allocates.
  double contact_area_m2(int body) const;
  // Returns find_smallest_contact_radius_m() of a body; 0 for a rigid one.
  double smallest_contact_radius_m(int body) const;
  // Returns whether a deformable body of a scene in real time has gone farther than gone_distance_m from the
  // ground and from where the bodies were at rest. It then stays where it is, without contacts: the rounding
  // of its displacements, which are in single precision, would shake it.
  bool is_gone(int body) const;
  // Returns the pose of a fixed or rigid body, which maps its rest shape to the present one; empty for a
  // deformable body.
  std::optional<Pose> rigid_pose(int body) const;
  // Returns the dynamics of a rigid body; null for any other body.
  const RigidDynamics* rigid_dynamics(int body) const;
  // Returns the highest speed of a node of a body.
  double fastest_m_per_s(int body = 0) const;
  // Returns true while a command is turning, moving or lowering a body.
  bool is_moving_bodies() const;
  // Returns the index of the body to which the last tick's flags nodes_slowed, speed_capped and body_limited
  // apply, or -1.
  int body_at_fault() const;
  // Returns the largest overlap of two bodies that was found in the last tick, m; 0 if none. Points that have
  // no contact, because they are beside a fold of a surface, do not count.
  double largest_overlap_m() const;

  struct State;

 private:
  friend struct CommandApplier;
  friend class Refiner;
  explicit Simulation(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Each reserves memory, so that write_snapshot() or Simulation::write_scene() does not allocate after a
// refinement within the limit.
void reserve_for_refinement(Snapshot& snapshot);
void reserve_for_refinement(Scene& scene);

}  // namespace spoonbill
