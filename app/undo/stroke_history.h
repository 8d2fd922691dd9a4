// Undo by strokes. A stroke lasts from first touch to release; what moves on after the release, until the
// next stroke, belongs to it. Shapes are kept bit for bit. One owner, one thread: whoever ticks.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/simulation/simulation.h"

namespace spoonbill {

// All memory is taken when it is made, so that nothing is allocated while the haptic thread calls it. When it
// is full the oldest shape goes.
class StrokeHistory {
 public:
  // A release shorter than this is a bounce within the stroke.
  static constexpr int release_ticks = 50;

  // Shapes that are kept: at most these, and fewer of a body so large that they would fill more memory.
  static constexpr std::size_t shape_limit = 64;
  static constexpr std::size_t memory_limit_bytes = std::size_t{64} << 20;

  explicit StrokeHistory(const Simulation& simulation);

  // After every tick. `touching`: whether the tool acted on the body in that tick.
  void after_tick(const Simulation& simulation, bool touching);

  // The shape before the last stroke, or after the next one. Without one, nothing happens. Refused, with the
  // history as it was, when the simulation refuses the shape.
  Status undo(Simulation& simulation);
  Status redo(Simulation& simulation);

  // The shape before the stroke that is under way, which is forgotten. Without one, nothing happens.
  Status cancel(Simulation& simulation);

  // To be called when a command has changed what a shape means (fixing planes, rest shape): no way back over
  // it.
  void clear(const Simulation& simulation);

  bool can_undo() const { return open_stroke_ || at_ > 0; }
  bool can_redo() const { return !open_stroke_ && at_ + 1 < count_; }
  bool in_stroke() const { return touching_; }

 private:
  void begin_stroke();
  Status go_to(std::size_t index, Simulation& simulation);

  // The row of shapes that undo and redo walk along: shapes_[0 .. count_ - 1]. The body has the shape at_,
  // or, when a stroke is open, one beyond it that is not in the row yet.
  std::vector<ShapeState> shapes_;
  std::size_t count_ = 1;
  std::size_t at_ = 0;
  bool open_stroke_ = false;

  bool touching_ = false;
  int ticks_since_touch_ = 0;
  ShapeState untouched_;  // after the last tick without a stroke
};

}  // namespace spoonbill
