// Undo of strokes. A stroke lasts from first touch to release and includes all motion until the next stroke.
// Shapes are stored bit for bit.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/simulation/simulation.h"

namespace spoonbill {

// Shapes before and after strokes. One owner: the thread that ticks. The constructor allocates all memory, so
// that later calls are safe on the haptic thread. When the history is full, the oldest shape is dropped.
class StrokeHistory {
 public:
  // Shortest release that ends a stroke, in ticks. A shorter release is a bounce and belongs to the stroke.
  static constexpr int release_ticks = 50;

  // Largest number of stored shapes. The memory limit allows fewer shapes of large bodies, but at least 3.
  static constexpr std::size_t shape_limit = 64;
  static constexpr std::size_t memory_limit_bytes = std::size_t{64} << 20;

  explicit StrokeHistory(const Simulation& simulation);

  // Must be called after every tick. `touching` is true if the tool touched the body in that tick.
  void after_tick(const Simulation& simulation, bool touching);

  // undo() restores the shape before the last stroke, redo() the shape after the next stroke. Each does
  // nothing if there is no such stroke. An error of the simulation leaves the history unchanged.
  Status undo(Simulation& simulation);
  Status redo(Simulation& simulation);

  // Restores the shape before the current stroke and discards the stroke. Does nothing outside a stroke.
  Status cancel(Simulation& simulation);

  // Discards all strokes. Must be called when a command changes fixing planes, the rest shape or anything
  // else on which the meaning of stored shapes depends.
  void clear(const Simulation& simulation);

  bool can_undo() const { return open_stroke_ || current_ > 0; }
  bool can_redo() const { return !open_stroke_ && current_ + 1 < count_; }
  bool in_stroke() const { return touching_; }

 private:
  void begin_stroke();
  Status restore_shape(std::size_t index, Simulation& simulation);

  // Shapes through which undo and redo step: shapes_[0 .. count_ - 1]. While open_stroke_ is true,
  // shapes_[current_] is the shape before the last stroke; the shape after it is not stored yet. Otherwise
  // shapes_[current_] is the shape that undo(), redo() or cancel() restored last; it is unused before the
  // first stroke.
  std::vector<ShapeState> shapes_;
  std::size_t count_ = 1;
  std::size_t current_ = 0;
  bool open_stroke_ = false;

  bool touching_ = false;
  int ticks_since_touch_ = 0;
  ShapeState untouched_;  // shape after the last tick outside a stroke
};

}  // namespace spoonbill
