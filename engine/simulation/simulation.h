// A simulation: a scene and its state at a tick. One owner; after start only the haptic thread (or the
// lock-step loop) changes it, everybody else sends commands and reads snapshots.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/command.h"
#include "engine/scene/scene.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

inline constexpr double tick_s = 1e-3;

// The hand's part in one tick.
struct ToolInput {
  Pose pose;
  bool gripping = false;  // holds a pull
  // The spring by which the hand holds the tool, in N/m of the real material; 0 = held rigidly.
  double coupling_n_per_m = 0.0;
  bool hovering = false;  // only points: the tool acts on nothing, until it is outside the body again
};

// What the bodies answer. The force is that of the real stiffness: sculpting computes with the felt one,
// and a quasi-static force is proportional to it.
struct Reaction {
  Vector3 force_n = Vector3::Zero();  // on the tool, averaged over the tick's material time
  Pose proxy;                         // where the material stops the tool
  bool touching = false;
  bool mirror_touching = false;  // the mirrored tool of a symmetric stroke; its force is not felt
  std::uint32_t flags = tick_flag_none;
};

// Everything that a stroke can change, for undo, bit for bit: the lattice's displacements, velocities, rest
// lengths and volumes. Control points follow from them.
struct ShapeState {
  std::vector<std::vector<float>> lattices;  // one a body
  friend bool operator==(const ShapeState&, const ShapeState&) = default;
};

class Simulation {
 public:
  // Builds grids, lattice and working memory. Refused with the field named where the scene cannot be
  // simulated. `watch` is told how feature maps come along, one body after the other.
  static Result<Simulation> make(Scene scene, InstructionSet set, const FeatureMapWatch& watch = {});

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  // Between ticks; may allocate. On an error the simulation is as it was.
  Status apply(const Command& command);

  // One tick: contact of the tool as the hand moves from the last tick's pose to this one's, lattice, control
  // points. Allocates nothing, never throws.
  Reaction advance(const ToolInput& input);

  // The scene as it was set. Its surfaces are those of the last change of structure: surface() is the one of
  // now.
  const Scene& scene() const;
  // What would be saved now. Allocates only where `scene` is of another structure.
  void write_scene(Scene& scene) const;
  std::uint64_t tick() const;

  // FNV-1a over every bit that the next tick depends on, the tick number included.
  std::uint64_t state_hash() const;

  // Writes everything but the force, the button and the device, which the haptic side owns.
  void write_snapshot(Snapshot& snapshot) const;

  ShapeState shape() const;
  // Allocates only where `shape` is of another size.
  void write_shape(ShapeState& shape) const;
  // Refused when the state is of another lattice.
  Status restore(const ShapeState& shape);

  // See remark_on(): a line for each body of the scene that has one.
  std::vector<std::string> remarks() const;

  // For studies and tests: a body's lattice, and its surface as it is now, where it has one: any of the
  // scene's.
  const SpringLattice& lattice(int body = 0) const;
  const Surface& surface(int body = 0) const;
  // What steps the body achieves of its materials' elasticity.
  const LatticeReport& report(int body = 0) const;

  // The mean force of a support, or of the ground, on a body through the last tick, at the real stiffness.
  Vector3 support_force_n(int support, int body = 0) const;
  Vector3 ground_force_n(int body = 0) const;

  struct State;

 private:
  friend struct CommandApplier;
  explicit Simulation(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
