#include "app/session/edit_history.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "engine/base/assert.h"

namespace spoonbill {

bool replaces_build(const Command& command) {
  return std::holds_alternative<PlacePlane>(command) || std::holds_alternative<RemovePlanes>(command) ||
         std::holds_alternative<KeepShape>(command) || std::holds_alternative<RefineKnots>(command) ||
         std::holds_alternative<SetMaterial>(command);
}

EditHistory::EditHistory(const Simulation& simulation) : untouched_{simulation.shape(), 0} {
  std::size_t bytes = 1;
  for (const std::vector<float>& lattice : untouched_.shape.lattices) bytes += lattice.size() * sizeof(float);
  // A build is mostly lattice: about 13 arrays of 13 directions, for a node of about 30 values of a shape.
  constexpr std::size_t build_of_shape = 10;
  most_builds_ = std::clamp<std::size_t>(build_memory_limit_bytes / (build_of_shape * bytes), 2, build_limit);
  builds_.reserve(shape_limit + 1);
  states_.assign(std::clamp<std::size_t>(memory_limit_bytes / bytes, 3, shape_limit), untouched_);
}

void EditHistory::after_tick(const Simulation& simulation, bool touching) {
  if (touching) {
    if (!touching_) begin_step(untouched_);
    touching_ = true;
    ticks_since_touch_ = 0;
    return;
  }
  if (touching_ && ++ticks_since_touch_ < release_ticks) return;
  touching_ = false;
  simulation.write_shape(untouched_.shape);
  untouched_.build = live_build_;
}

void EditHistory::drop_oldest() {
  std::rotate(states_.begin(), states_.begin() + 1, states_.end());
}

void EditHistory::begin_step(const State& before) {
  if (is_open_) {
    if (current_ + 1 == states_.size()) {
      drop_oldest();
    } else {
      ++current_;
    }
  }
  states_[current_] = before;
  count_ = current_ + 1;
  is_open_ = true;
  material_body_ = -1;
}

Status EditHistory::apply(Simulation& simulation, const Command& command) {
  const auto* const refine = std::get_if<RefineKnots>(&command);
  const auto* const material = std::get_if<SetMaterial>(&command);
  const bool belongs_to_last = is_open_ && ((refine != nullptr && (refine->u || refine->v)) ||
                                            (material != nullptr && material->body == material_body_));
  const State before{simulation.shape(), live_build_};
  std::shared_ptr<SimulationBuild> build =
      simulation.copy_build(refine != nullptr ? BuildPart::mappings : BuildPart::whole);
  if (Status applied = simulation.apply(command); !applied) return applied;
  if (!belongs_to_last) {
    begin_step(before);
    touching_ = false;
    if (material != nullptr) material_body_ = material->body;
  }
  builds_.push_back({live_build_, std::move(build)});
  live_build_ = ++last_build_;
  if (!touching_) untouched_ = {simulation.shape(), live_build_};
  drop_unused_builds();
  return {};
}

void EditHistory::adopt(Simulation& simulation, Refiner& refiner) {
  SPOONBILL_ASSERT(is_open_);
  std::shared_ptr<SimulationBuild>& replaced = simulation.adopt(refiner);
  // Only the state before the open step can need the replaced build.
  if (states_[current_].build == live_build_) store_in_place({live_build_, std::move(replaced)}, replaced);
  live_build_ = ++last_build_;
  if (!touching_) {
    simulation.write_shape(untouched_.shape);
    untouched_.build = live_build_;
  }
}

// Stores a build without allocating. Moves a build that no state needs any more to `dropped`; drops the
// oldest states while there are as many builds as the limit.
void EditHistory::store_in_place(StoredBuild stored, std::shared_ptr<SimulationBuild>& dropped) {
  const auto find_unneeded = [&] {
    return std::find_if(builds_.begin(), builds_.end(),
                        [&](const StoredBuild& other) { return !is_needed(other.number); });
  };
  auto unneeded = find_unneeded();
  while (unneeded == builds_.end() && builds_.size() >= most_builds_ && current_ > 0) {
    drop_oldest();
    --current_;
    --count_;
    unneeded = find_unneeded();
  }
  if (unneeded == builds_.end()) return builds_.push_back(std::move(stored));
  dropped = std::move(unneeded->build);
  *unneeded = std::move(stored);
}

bool EditHistory::is_needed(std::uint64_t build) const {
  return std::any_of(states_.begin(), states_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const State& state) { return state.build == build; });
}

bool EditHistory::undo_needs_build() const {
  if (!can_undo()) return false;
  return states_[is_open_ ? current_ : current_ - 1].build != live_build_;
}

Status EditHistory::undo(Simulation& simulation) {
  if (!can_undo()) return {};
  if (!is_open_) return restore(current_ - 1, simulation);
  if (current_ + 1 == states_.size()) {
    drop_oldest();
    --current_;
  }
  simulation.write_shape(states_[current_ + 1].shape);
  states_[current_ + 1].build = live_build_;
  count_ = current_ + 2;
  return restore(current_, simulation);
}

Status EditHistory::redo(Simulation& simulation) {
  return can_redo() ? restore(current_ + 1, simulation) : Status();
}

Status EditHistory::cancel(Simulation& simulation) {
  if (!in_stroke()) return {};
  count_ = current_ + 1;
  return restore(current_, simulation);
}

Status EditHistory::restore(std::size_t index, Simulation& simulation) {
  const State& state = states_[index];
  if (state.build != live_build_) {
    const auto stored = std::find_if(builds_.begin(), builds_.end(),
                                     [&](const StoredBuild& other) { return other.number == state.build; });
    SPOONBILL_ASSERT(stored != builds_.end());
    *stored = {live_build_, simulation.exchange_build(std::move(stored->build))};
    live_build_ = state.build;
  }
  if (Status restored = simulation.restore(state.shape); !restored) return restored;
  untouched_ = state;
  current_ = index;
  is_open_ = false;
  touching_ = false;
  material_body_ = -1;
  return {};
}

// Drops the builds that no state needs, and the oldest states while there are more builds than the limit.
void EditHistory::drop_unused_builds() {
  const auto drop = [&] {
    std::erase_if(builds_, [&](const StoredBuild& stored) { return !is_needed(stored.number); });
  };
  drop();
  while (builds_.size() > most_builds_ && current_ > 0) {
    drop_oldest();
    --current_;
    --count_;
    drop();
  }
}

}  // namespace spoonbill
