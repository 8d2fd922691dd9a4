// Recordings: the input of every tick, with the document that the session started from.
//
// A recording is a text file with one JSON value per line, so that ordinary tools can read, cut and compare
// it, and a crash damages only the last line.
//
//   {"spoonbill_recording":1,"tick_s":0.001,"device":{...},"document":{...}}        line 1; device: see below
//   {"tick":0,"state_hash":"0123456789abcdef"}                                      every 1,000 ticks
//   {"tick":0,"command":"place_plane","point_mm":[20,0,0],"normal":[1,0,0]}         a command
//   {"tick":0,"ticks":100,"dx_nm":[...],"dy_nm":[...],"dz_nm":[...],"dq_e9":[[...],[...],[...],[...]],
//    "buttons":[...],"missed":[...]}                                                motion (on one line)
//   {"end":true,"ticks":4300,"state_hash":"fedcba9876543210"}                       last line
//
// The last line also has "missed":N if the live session missed N periods of 1 ms. The session then took N ms
// longer than its number of ticks.
//
// Faults of the device and the program are recorded by their effects, so that a session with faults replays
// to the same states. A tick without a valid reading is recorded as hovering (button_hover): the tool touches
// nothing. Resetting the proxy and switching the force on or off are recorded as commands.
//
// The version of the format is 1. If the document of a recording has an old version, the reader converts the
// document and the commands (old_documents.h). The replay of such a recording passes through other states, so
// its hashes differ from the recorded hashes. Lines are in the order of their ticks. Within a tick the order
// is: state hash, commands, motion. The state hash is that of the simulation after ticks 0 to tick - 1,
// before any command of this tick. A motion line covers `ticks` readings from `tick` on. It ends at the next
// multiple of 100, or earlier before a command or the end, so that the same recording always has the same
// lines.
//
// dx_nm, dy_nm and dz_nm are the changes of DeviceReading::position_nm since the previous reading. The
// reading before tick 0 is the default reading. dq_e9 contains the changes of orientation_e9 (x, y, z, w).
// Each field is omitted if all its numbers are zero. `buttons` lists the buttons of each reading, not their
// changes, and is omitted while they do not change. `missed` lists DeviceReading::missed. It is omitted if
// all its numbers are zero, as in recordings that were not made live and in recordings older than this field.
// The hash of the last line is that of the final state.
//
// A recording of a training session has "training":{...} in its first line (RecordingHeader::training).
//
// device: name, maximum_force_n, maximum_stiffness_n_per_m, maximum_damping_n_s_per_m, workspace_radius_m,
// position_resolution_m, senses_orientation, actuates_torque. Optional, with the defaults of
// DeviceSpecification: quiet_force_n, ramp_time_s, maximum_force_rate_n_per_s, maximum_speed_m_per_s,
// dead_man_buttons.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "engine/exchange/json.h"
#include "haptic/device.h"

namespace spoonbill {

inline constexpr int recording_version = 1;
inline constexpr std::uint64_t recording_line_ticks = 100;  // largest number of ticks that a crash can lose
inline constexpr std::uint64_t recording_checkpoint_ticks = 1000;
inline constexpr std::uint64_t recording_tick_limit = 10'000'000;  // 2 h 46 min

struct RecordingHeader {
  DeviceSpecification device;
  Document document;  // the scene at tick 0
  // Training session of the recording: {"task": ..., "spoon": ..., "hand": ..., "severity": ..., "seed":
  // ...}, with the names of the task and the hand and the spoon's file without ending. Empty for other
  // sessions. The states of a training session depend on them.
  std::optional<Json> training = {};
};

// A command and its tick. The command stays JSON, because the engine interprets commands of the simulation
// and the program interprets commands of the view, and neither needs to know the other's commands.
struct TimedCommand {
  std::uint64_t tick = 0;  // the command applies before this tick runs; commands of one tick keep their order
  Json command;            // {"command": "...", arguments...}
  std::string origin;      // source for messages: "bend.jsonl: line 12" or "bend.json: steps[3]"
};

struct Checkpoint {
  std::uint64_t tick = 0;
  std::uint64_t state_hash = 0;

  friend bool operator==(const Checkpoint&, const Checkpoint&) = default;
};

struct Recording {
  RecordingHeader header;
  std::vector<DeviceReading> readings;  // one per tick
  std::vector<TimedCommand> commands;   // in order; commands at tick readings.size() come after all ticks
  std::vector<Checkpoint> checkpoints;
  std::optional<Checkpoint> end;  // tick and hash of the last line; empty if the recording is truncated
  std::uint64_t missed = 0;       // periods of 1 ms without a tick during the live session
  std::string notice;             // one line for the user; empty if the recording is complete
};

// Reads a recording. A recording that is truncated anywhere after its first line is read up to the cut. Any
// other deviation from the format, which is described at the top of this file, is an error that names line
// and field. A recording is also refused if it is longer than 10 million ticks or 1 GiB, or contains a
// position beyond 10 m or an orientation that is not a unit quaternion.
Result<Recording> read_recording(const std::filesystem::path& file);
Result<Recording> read_recording(std::istream& in, const std::string& source);

// Writes a recording while the session runs. Each complete line is passed to the operating system at once, so
// that a killed program loses at most 100 ticks.
//
// A writer has one owner, which must not be the haptic thread, because writing may block. After an error,
// every later call returns the same error.
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
  // Creates the file and writes the header. The recording is written as FILE.part, which can be replayed too,
  // and becomes FILE at commit(). Errors: a path that cannot be written, another program that records to the
  // same file (ErrorCode::in_use), a document that could not be read back.
  static Result<RecordingWriter> create(const std::filesystem::path& file, const RecordingHeader& header,
                                        const OutputOptions& options = {});

  // Returns one line for the user if an earlier recording had left a FILE.part, which create() has renamed.
  // Otherwise returns an empty string.
  const std::string& notice() const;

  // Returns the name of the file to which the recording is written until commit().
  const std::filesystem::path& written_file() const;

  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();  // without finish() the recording has no end line, as after a crash

  // Returns the next tick, which is the number of readings so far.
  std::uint64_t tick() const;

  // Returns true if checkpoint() must be called: at each multiple of 1,000 ticks, before the commands of the
  // tick.
  bool checkpoint_due() const;
  Status checkpoint(std::uint64_t state_hash);

  // Writes a command that applies before the next tick. The command is a JSON object with a text "command"
  // and with neither "tick" nor "end".
  Status command(const Json& command);

  Status reading(const DeviceReading& reading);

  // Writes the last line and waits until the file is on the disk. `missed` is stored as Recording::missed.
  Status finish(std::uint64_t state_hash, std::uint64_t missed = 0);

  // Closes the recording and replaces an older file of the same name. Must be called after finish().
  Status commit();

 private:
  struct State;
  explicit RecordingWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
