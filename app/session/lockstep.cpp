#include "app/session/lockstep.h"

#include <utility>

#include "app/report/quantity_text.h"
#include "engine/base/assert.h"
#include "haptic/recording_lines.h"

namespace spoonbill {

std::uint64_t frame_count(std::uint64_t tick_count) {
  std::uint64_t count = tick_count * frames_per_second / 1000;
  while (frame_tick(count) <= tick_count) ++count;
  return count;
}

namespace {

Device& require(Device* device) {
  SPOONBILL_ASSERT(device != nullptr);
  return *device;
}

}  // namespace

Lockstep::Lockstep(Session& session, LockstepInput input, RecordingWriter* writer)
    : session_(&session), input_(std::move(input)), writer_(writer), device_(require(input_.device)) {}

Status Lockstep::run_to(std::uint64_t tick) {
  while (true) {
    if (Status prepared = prepare_tick(); !prepared) return prepared;
    if (tick_ >= tick || tick_ >= input_.tick_count) return {};
    if (Status ran = run_tick(); !ran) return ran;
  }
}

Status Lockstep::finish() {
  if (Status ran = run_to(input_.tick_count); !ran) return ran;
  if (input_.expected_end) {
    if (Status same = compare_state(*input_.expected_end); !same) return same;
  }
  return writer_ != nullptr ? writer_->finish(state_hash(*session_), input_.missed) : Status();
}

Status Lockstep::prepare_tick() {
  if (is_prepared_) return {};
  const bool is_checkpoint = has_checkpoint();
  if (is_checkpoint) {
    if (Status same = compare_state(input_.expected[next_expected_++]); !same) return same;
  }
  const bool more = tick_ < input_.tick_count;
  if (writer_ != nullptr && (more || is_checkpoint) && writer_->checkpoint_due()) {
    if (Status written = writer_->checkpoint(state_hash(*session_)); !written) return written;
  }
  if (Status applied = apply_due_commands(); !applied) return applied;
  if (Status refined = refine_when_due(); !refined) return refined;
  is_prepared_ = true;
  return {};
}

bool Lockstep::has_checkpoint() const {
  return next_expected_ < input_.expected.size() && input_.expected[next_expected_].tick == tick_;
}

Status Lockstep::compare_state(const Checkpoint& expected) const {
  const std::uint64_t hash = state_hash(*session_);
  if (hash == expected.state_hash) return {};
  return Error{ErrorCode::mismatch,
               input_.source + ": the state after " + std::to_string(tick_) + " ticks has the hash " +
                   hash_text(hash) + ", the recording has " + hash_text(expected.state_hash) +
                   "; it was made by another version: record it again with `spoonbill record`"};
}

Status Lockstep::apply_due_commands() {
  for (; next_command_ < input_.commands.size() && input_.commands[next_command_].tick <= tick_;
       ++next_command_) {
    const TimedCommand& command = input_.commands[next_command_];
    if (Status applied = apply_command(*session_, command); !applied) return applied;
    if (writer_ == nullptr) continue;
    if (Status written = writer_->command(command.command); !written) return written;
  }
  return {};
}

// Resets the proxy and records the reset, so that the recording replays without the device.
Status Lockstep::reset_proxy() {
  const Command command = ResetProxy{};
  if (Status applied = session_->simulation.apply(command); !applied) return applied;
  return writer_ != nullptr ? writer_->command(command_to_json(command)) : Status();
}

Status Lockstep::refine_when_due() {
  if (!input_.refines) return {};
  if (!refinement_) {
    refinement_ = session_->simulation.wanted_refinement();
    refinement_tick_ = tick_ + refinement_ticks;
    return {};
  }
  if (tick_ < refinement_tick_) return {};
  const RefineKnots refinement = *std::exchange(refinement_, std::nullopt);
  // An undo may have come in between, and then the refinement is no longer wanted.
  if (!session_->history.has_open_step() || !session_->simulation.wanted_refinement()) return {};
  // A refinement that cannot be made leaves the surface as it is.
  if (!apply_request(*session_, Command(refinement))) return {};
  return writer_ != nullptr ? writer_->command(command_to_json(refinement)) : Status();
}

Status Lockstep::run_tick() {
  const DeviceReading reading = device_.read();
  if (device_.consume_proxy_reset()) {
    if (Status reset = reset_proxy(); !reset) return reset;
  }
  const TickResult result = advance(*session_, reading);
  // A tick is recorded only after it has run. The recording therefore has only whole ticks, even if a signal
  // ends the process.
  if (writer_ != nullptr) {
    if (Status written = writer_->reading(reading); !written) return written;
  }
  device_.switch_force(session_->force_on);
  device_.give(result.force_n);
  ++tick_;
  is_prepared_ = false;
  return input_.after_tick ? input_.after_tick() : Status();
}

}  // namespace spoonbill
