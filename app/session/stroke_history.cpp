#include "app/session/stroke_history.h"

#include <algorithm>

namespace spoonbill {

StrokeHistory::StrokeHistory(const Simulation& simulation) : untouched_(simulation.shape()) {
  std::size_t bytes = 1;
  for (const std::vector<float>& lattice : untouched_.lattices) bytes += lattice.size() * sizeof(float);
  shapes_.assign(std::clamp<std::size_t>(memory_limit_bytes / bytes, 3, shape_limit), untouched_);
}

void StrokeHistory::after_tick(const Simulation& simulation, bool touching) {
  if (touching) {
    if (!touching_) begin_stroke();
    touching_ = true;
    ticks_since_touch_ = 0;
    return;
  }
  if (touching_ && ++ticks_since_touch_ < release_ticks) return;
  touching_ = false;
  simulation.write_shape(untouched_);
}

void StrokeHistory::begin_stroke() {
  if (open_stroke_) {
    if (current_ + 1 == shapes_.size()) {
      std::rotate(shapes_.begin(), shapes_.begin() + 1, shapes_.end());
    } else {
      ++current_;
    }
  }
  shapes_[current_] = untouched_;
  count_ = current_ + 1;
  open_stroke_ = true;
}

Status StrokeHistory::undo(Simulation& simulation) {
  if (!can_undo()) return {};
  if (!open_stroke_) return restore_shape(current_ - 1, simulation);
  if (current_ + 1 == shapes_.size()) {
    std::rotate(shapes_.begin(), shapes_.begin() + 1, shapes_.end());
    --current_;
  }
  simulation.write_shape(shapes_[current_ + 1]);
  count_ = current_ + 2;
  return restore_shape(current_, simulation);
}

Status StrokeHistory::redo(Simulation& simulation) {
  return can_redo() ? restore_shape(current_ + 1, simulation) : Status();
}

Status StrokeHistory::cancel(Simulation& simulation) {
  if (!in_stroke()) return {};
  count_ = current_ + 1;
  return restore_shape(current_, simulation);
}

void StrokeHistory::clear(const Simulation& simulation) {
  current_ = 0;
  count_ = 1;
  open_stroke_ = false;
  touching_ = false;
  simulation.write_shape(untouched_);
}

Status StrokeHistory::restore_shape(std::size_t index, Simulation& simulation) {
  if (Status restored = simulation.restore(shapes_[index]); !restored) return restored;
  untouched_ = shapes_[index];
  current_ = index;
  open_stroke_ = false;
  touching_ = false;
  return {};
}

}  // namespace spoonbill
