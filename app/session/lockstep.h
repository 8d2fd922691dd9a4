// The lock-step loop: ticks follow the recording's time instead of a clock, so that the same input gives the
// same states on any machine.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "haptic/recording.h"
#include "haptic/safe_device.h"

namespace spoonbill {

inline constexpr std::uint64_t frames_per_second = 60;

// Ticks from the measurement that a surface is behind its lattice to its refinement.
inline constexpr std::uint64_t refinement_ticks = 32;

// Returns the number of ticks before frame `frame`.
constexpr std::uint64_t frame_tick(std::uint64_t frame) {
  return frame * 1000 / frames_per_second;
}

// Returns the number of frames whose state can be drawn after `tick_count` ticks.
std::uint64_t frame_count(std::uint64_t tick_count);

// Input of a lock-step run.
struct LockstepInput {
  Device* device = nullptr;  // device that is read once a tick; must not be null
  std::uint64_t tick_count = 0;
  std::vector<TimedCommand> commands;  // commands in ascending order of ticks
  // Expected states, ascending by tick; may be empty. Each is compared before the commands of its tick are
  // applied.
  std::vector<Checkpoint> expected;
  std::optional<Checkpoint> expected_end;
  std::uint64_t missed = 0;  // ticks that the replayed live recording had missed; copied to the new recording
  std::string source;        // names the input in messages
  // True if the program refines surfaces by itself where they stay behind their lattices: refinement_ticks
  // after the tick that has found this. False for recordings, which contain the refinements as commands.
  bool refines = false;
  // Called after each tick, before the commands that follow it; may be empty. An error ends the run.
  std::function<Status()> after_tick = {};
};

// Runs a session in lock-step. The loop has one owner and is used by one thread.
class Lockstep {
 public:
  // The session, the input's device and the writer must outlive the loop. The writer may be null.
  Lockstep(Session& session, LockstepInput input, RecordingWriter* writer);

  // Runs until `tick` ticks are done and the commands due at that tick are applied. An error names the tick
  // and the source. Errors: a command that cannot be applied, a state that differs from the expected one, a
  // recording that cannot be written.
  Status run_to(std::uint64_t tick);

  // Runs all ticks of the input that have not run yet, compares the last state with the expected one, and
  // finishes the recording that is being written.
  Status finish();

  std::uint64_t tick() const { return tick_; }
  std::uint64_t tick_count() const { return input_.tick_count; }

 private:
  Status prepare_tick();
  Status compare_state(const Checkpoint& expected) const;
  bool has_checkpoint() const;
  Status apply_due_commands();
  Status run_tick();
  Status reset_proxy();
  Status refine_when_due();

  Session* session_;
  LockstepInput input_;
  RecordingWriter* writer_;
  SafeDevice device_;  // wraps the input's device
  std::uint64_t tick_ = 0;
  std::size_t next_command_ = 0;
  std::size_t next_expected_ = 0;
  // Refinement under way, and the tick at which it is due.
  std::optional<RefineKnots> refinement_;
  std::uint64_t refinement_tick_ = 0;
  bool is_prepared_ = false;  // true if the commands of tick_ are applied
};

}  // namespace spoonbill
