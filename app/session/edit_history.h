// Undo and redo. A step is a stroke, or a command that changes knots, fixing planes, a material or the rest
// shape. A stroke lasts from first touch to release and includes all motion until the next step, and the
// knots that the program inserts meanwhile. States are stored bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/simulation/refiner.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// Returns whether a command changes what undo() restores besides the shape: a SimulationBuild.
bool replaces_build(const Command& command);

// The states between steps. One owner: the thread that ticks. When the history is full, the oldest state is
// dropped. after_tick() and adopt() allocate nothing, and neither do undo(), redo() and cancel() unless they
// need a build.
class EditHistory {
 public:
  // Shortest release that ends a stroke, in ticks. A shorter release is a bounce and belongs to the stroke.
  static constexpr int release_ticks = 50;

  // Largest number of stored shapes. The memory limit allows fewer shapes of large bodies, but at least 3.
  static constexpr std::size_t shape_limit = 128;
  static constexpr std::size_t memory_limit_bytes = std::size_t{64} << 20;
  // Largest number of stored builds. The memory limit allows fewer builds of large bodies, but at least 2.
  // The oldest steps go first.
  static constexpr std::size_t build_limit = 64;
  static constexpr std::size_t build_memory_limit_bytes = std::size_t{512} << 20;

  explicit EditHistory(const Simulation& simulation);

  // Must be called after every tick. `touching` is true if the tool touched the body in that tick.
  void after_tick(const Simulation& simulation, bool touching);

  // Applies a command of which replaces_build() is true, as a step. A refinement of the knots in given ranges
  // belongs to an open step, and so does another material of a body whose material this step changed. An
  // error changes nothing.
  Status apply(Simulation& simulation, const Command& command);
  // Carries out the refinement that `refiner` has prepared. has_open_step() must be true; the refinement
  // belongs to this step. Allocates and frees nothing.
  void adopt(Simulation& simulation, Refiner& refiner);

  // undo() restores the state before the last step, redo() the state after the next step. Each does nothing
  // if there is no such step. An error of the simulation leaves the history unchanged.
  Status undo(Simulation& simulation);
  Status redo(Simulation& simulation);
  // Restores the state before the current stroke and discards the stroke. Does nothing outside a stroke.
  Status cancel(Simulation& simulation);

  bool can_undo() const { return is_open_ || current_ > 0; }
  bool can_redo() const { return !is_open_ && current_ + 1 < count_; }
  bool in_stroke() const { return touching_; }
  // Returns true after a step until undo(), redo() or cancel(). The program refines knots only then, so that
  // an undo takes them back and no redo is lost.
  bool has_open_step() const { return is_open_; }
  // Each returns whether the function exchanges builds, which takes milliseconds and allocates.
  bool undo_needs_build() const;
  bool redo_needs_build() const { return can_redo() && states_[current_ + 1].build != live_build_; }
  bool cancel_needs_build() const { return in_stroke() && states_[current_].build != live_build_; }

 private:
  struct State {
    ShapeState shape;
    std::uint64_t build = 0;  // number of the build that the shape belongs to
  };

  struct StoredBuild {
    std::uint64_t number = 0;
    std::shared_ptr<SimulationBuild> build;
  };

  void begin_step(const State& before);
  bool is_needed(std::uint64_t build) const;
  void store_in_place(StoredBuild stored, std::shared_ptr<SimulationBuild>& dropped);
  Status restore(std::size_t index, Simulation& simulation);
  void drop_unused_builds();
  void drop_oldest();

  // States through which undo and redo step: states_[0 .. count_ - 1]. While is_open_ is true,
  // states_[current_] is the state before the last step; the state after it is not stored yet. Otherwise
  // states_[current_] is the state that undo(), redo() or cancel() restored last; it is unused before the
  // first step.
  std::vector<State> states_;
  std::size_t count_ = 1;
  std::size_t current_ = 0;
  bool is_open_ = false;
  int material_body_ = -1;  // body whose material the last step has changed, or -1

  std::vector<StoredBuild> builds_;  // all that a state needs, except the one that the simulation has
  std::uint64_t live_build_ = 0, last_build_ = 0;
  std::size_t most_builds_ = build_limit;

  bool touching_ = false;
  int ticks_since_touch_ = 0;
  State untouched_;  // state after the last tick outside a stroke
};

}  // namespace spoonbill
