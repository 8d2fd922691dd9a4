// The lock-step loop: ticks advance by the recording's own time, never by a clock, so that the same input
// gives the same states on any load. One owner, one thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "haptic/recording.h"
#include "haptic/safe_device.h"

namespace spoonbill {

inline constexpr std::uint64_t frames_per_second = 60;

// Frame k shows the state after this many ticks.
constexpr std::uint64_t tick_of_frame(std::uint64_t frame) {
  return frame * 1000 / frames_per_second;
}

// How many frames there are for that many ticks: those whose state is reached.
std::uint64_t frame_count(std::uint64_t tick_count);

struct LockstepInput {
  Device* device = nullptr;  // read once a tick; must not be null
  std::uint64_t tick_count = 0;
  std::vector<TimedCommand> commands;  // in order
  std::vector<Checkpoint>
      expected;  // states to compare with before a tick's commands, in order; may be empty
  std::optional<Checkpoint> expected_end;
  std::string source;  // names the input in messages
};

class Lockstep {
 public:
  // The session, the input's device and the writer (null for none) must outlive the loop.
  Lockstep(Session& session, LockstepInput input, RecordingWriter* writer);

  // Runs until `tick` ticks are done and the commands that stand there have been applied. Refused, with tick
  // and source named: a command that cannot be applied, a state that differs from an expected one, a
  // recording that cannot be written.
  Status run_to(std::uint64_t tick);

  // Runs what is left, compares the last state and ends the written recording.
  Status finish();

  std::uint64_t tick() const { return tick_; }
  std::uint64_t tick_count() const { return input_.tick_count; }

 private:
  Status stand_at_tick();
  Status compare_state(const Checkpoint& expected) const;
  bool has_checkpoint_here() const;
  Status apply_due_commands();
  Status run_tick();
  Status reset_proxy();

  Session* session_;
  LockstepInput input_;
  RecordingWriter* writer_;
  SafeDevice device_;  // the input's
  std::uint64_t tick_ = 0;
  std::size_t next_command_ = 0;
  std::size_t next_expected_ = 0;
  bool stands_ = false;  // the commands of tick_ have been applied
};

}  // namespace spoonbill
