// Streams a recording to a file while it happens. Each line is handed to the system as soon as it is
// complete, so that a program that is killed loses at most 100 ticks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "engine/base/result.h"
#include "haptic/device.h"
#include "haptic/recording/recording.h"

namespace spoonbill {

// One owner, never the haptic thread itself: writing may block. After an error every later call returns it
// again.
//
//   while (...) {
//     if (writer.checkpoint_due()) writer.checkpoint(simulation.state_hash());
//     for (commands of this tick) writer.command(json);
//     writer.reading(reading);
//   }
//   writer.finish(simulation.state_hash());
//   writer.commit();
class RecordingWriter {
 public:
  // Writes the header. Where there is an older file of that name the recording grows beside it, as FILE.part,
  // which replays as well. Refused: a path that cannot be written, a document that could not be read back.
  static Result<RecordingWriter> create(const std::filesystem::path& file, const RecordingHeader& header);

  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();  // without finish() the recording stays without its end, as after a crash

  // How many readings there are: the tick that comes next.
  std::uint64_t tick() const;

  // Whether the state hash belongs here: at each multiple of 1,000 ticks, before the tick's commands.
  bool checkpoint_due() const;
  Status checkpoint(std::uint64_t state_hash);

  // A command that applies before the next reading's tick: an object with a text "command" and no "tick".
  Status command(const Json& command);

  Status reading(const DeviceReading& reading);

  // Writes the last line and waits until the disk has it all.
  Status finish(std::uint64_t state_hash);

  // After finish(): the recording takes the place of an older file of its name, and is closed.
  Status commit();

 private:
  struct State;
  explicit RecordingWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
