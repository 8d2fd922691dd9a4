#include "app/undo/stroke_history.h"

#include <utility>

namespace spoonbill {

void StrokeHistory::after_tick(const Simulation& simulation, bool touching) {
  if (touching) {
    if (!touching_) begin_stroke();
    touching_ = true;
    ticks_since_touch_ = 0;
    return;
  }
  if (touching_ && ++ticks_since_touch_ < release_ticks) return;
  touching_ = false;
  untouched_ = simulation.shape();
}

void StrokeHistory::begin_stroke() {
  undone_.clear();
  if (base_ && open_stroke_) {
    done_.push_back(difference(*base_, untouched_));
  } else if (base_ && !done_.empty()) {
    ShapeState before = *base_;
    take_back(before, done_.back());
    done_.back() = difference(before, untouched_);
  }
  base_ = untouched_;
  open_stroke_ = true;
}

Status StrokeHistory::undo(Simulation& simulation) {
  if (!can_undo()) return {};
  if (open_stroke_) {
    ShapeDifference change = difference(*base_, simulation.shape());
    if (Status moved = move_to(simulation, *base_); !moved) return moved;
    undone_.push_back(std::move(change));
    open_stroke_ = false;
    return {};
  }
  ShapeState shape = *base_;
  take_back(shape, done_.back());
  if (Status moved = move_to(simulation, std::move(shape)); !moved) return moved;
  undone_.push_back(std::move(done_.back()));
  done_.pop_back();
  return {};
}

Status StrokeHistory::redo(Simulation& simulation) {
  if (!can_redo()) return {};
  ShapeState shape = *base_;
  do_again(shape, undone_.back());
  if (Status moved = move_to(simulation, std::move(shape)); !moved) return moved;
  done_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  return {};
}

void StrokeHistory::clear(const Simulation& simulation) {
  base_.reset();
  done_.clear();
  undone_.clear();
  open_stroke_ = false;
  touching_ = false;
  untouched_ = simulation.shape();
}

Status StrokeHistory::move_to(Simulation& simulation, ShapeState shape) {
  if (Status restored = simulation.restore(shape); !restored) return restored;
  untouched_ = shape;
  base_ = std::move(shape);
  touching_ = false;
  return {};
}

}  // namespace spoonbill
