// A simulation: a scene and its state at a tick. One owner; after start only the haptic thread (or the lock-step
// loop) changes it, everybody else sends commands and reads snapshots.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/bspline/surface.h"
#include "engine/instruction_set.h"
#include "engine/material/spring_lattice.h"
#include "engine/result.h"
#include "engine/simulation/command.h"
#include "engine/simulation/scene.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

inline constexpr double tick_s = 1e-3;

// What the material answers to one tick's tool motion. The force is that of the real stiffness: sculpting computes
// with the felt one, and a quasi-static force is proportional to it.
struct Reaction {
  Vector3 force_n = Vector3::Zero();  // on the tool, averaged over the tick's material time
  bool touching = false;
  // Where the tool meets a part that is held and cannot give way: how deep, and the surface's normal there.
  double blocked_depth_m = 0.0;
  Vector3 blocked_normal = Vector3::UnitY();
  std::uint32_t flags = tick_flag_none;
};

// Everything that a stroke can change, for undo, bit for bit: the lattice's displacements, velocities and rest
// lengths. Control points follow from them.
struct ShapeState {
  std::vector<float> lattice;
  friend bool operator==(const ShapeState&, const ShapeState&) = default;
};

class Simulation {
 public:
  // Builds grids, lattice and working memory. Refused with the field named where the scene cannot be simulated.
  static Result<Simulation> make(Scene scene, InstructionSet set);

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  // Between ticks; may allocate. On an error the simulation is as it was.
  Status apply(const Command& command);

  // One tick: contact of the tool at `tool_pose` (it moves there from the last tick's pose), lattice, control
  // points. `gripping` holds a pull. Allocates nothing, never throws.
  Reaction advance(const Pose& tool_pose, bool gripping);

  // The scene with its surfaces as they are now.
  const Scene& scene() const;
  std::uint64_t tick() const;

  // FNV-1a over every bit that the next tick depends on, the tick number included.
  std::uint64_t state_hash() const;

  // Writes everything but the tool's device pose, the force and the device, which the haptic side owns.
  void write_snapshot(Snapshot& snapshot) const;

  ShapeState shape() const;
  // Refused when the state is of another lattice.
  Status restore(const ShapeState& shape);

  // For studies and tests: the lattice, and the surface as it is now.
  const SpringLattice& lattice() const;
  const Surface& surface() const;

 private:
  struct State;
  friend struct CommandApplier;
  explicit Simulation(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
