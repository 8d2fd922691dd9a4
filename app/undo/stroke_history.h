// Undo by strokes. A stroke lasts from first touch to release; what moves on after the release, until the
// next stroke, belongs to it. Shapes are kept bit for bit. One owner, one thread: whoever ticks.
#pragma once

#include <optional>
#include <vector>

#include "app/undo/shape_difference.h"

namespace spoonbill {

class StrokeHistory {
 public:
  // A release shorter than this is a bounce within the stroke.
  static constexpr int release_ticks = 50;

  explicit StrokeHistory(const Simulation& simulation) : untouched_(simulation.shape()) {}

  // After every tick. `touching`: whether the tool acted on the body in that tick.
  void after_tick(const Simulation& simulation, bool touching);

  // The shape before the last stroke, or after the next one. Without one, nothing happens. Refused, with the
  // history as it was, when the simulation refuses the shape.
  Status undo(Simulation& simulation);
  Status redo(Simulation& simulation);

  // To be called when a command has changed what a shape means (fixing planes, rest shape): no way back over
  // it.
  void clear(const Simulation& simulation);

  bool can_undo() const { return open_stroke_ || !done_.empty(); }
  bool can_redo() const { return !undone_.empty(); }

 private:
  void begin_stroke();
  Status move_to(Simulation& simulation, ShapeState shape);

  // The history is a row of shapes; neighbours are kept as differences, and one of them in full. When a
  // stroke is open, base_ is the shape before it; otherwise it is the one that undo or redo went to.
  std::optional<ShapeState> base_;
  std::vector<ShapeDifference> done_;    // up to base_, oldest first
  std::vector<ShapeDifference> undone_;  // from base_ on, the next one last
  bool open_stroke_ = false;

  bool touching_ = false;
  int ticks_since_touch_ = 0;
  ShapeState untouched_;  // after the last tick without a stroke
};

}  // namespace spoonbill
