// Recordings: what came in, tick by tick, with the document it started from. One JSON value a line, so that a
// recording can be read, cut and compared with ordinary tools, and a crash leaves all but the last line
// whole.
//
//   {"spoonbill_recording":1,"tick_s":0.001,"device":{...},"document":{...}}        line 1; device: see below
//   {"tick":0,"state_hash":"0123456789abcdef"}                                      every 1,000 ticks
//   {"tick":0,"command":"place_plane","point_mm":[20,0,0],"normal":[1,0,0]}         a command
//   {"tick":0,"ticks":100,"dx_nm":[...],"dy_nm":[...],"dz_nm":[...],"dq_e9":[[...],[...],[...],[...]],
//    "buttons":[...]}                                                               motion (on one line)
//   {"end":true,"ticks":4300,"state_hash":"fedcba9876543210"}                       last
//
// Version 1. Lines stand in the order of their ticks. Within a tick: the state hash, which is that of the
// simulation when ticks 0 to tick - 1 have run and no command of this tick has; then its commands; then
// motion. A motion line covers `ticks` readings from `tick` on. It ends at the next multiple of 100, or
// earlier where a command or the end stands, so that the same recording always has the same lines. dx_nm,
// dy_nm, dz_nm are the differences of DeviceReading::position_nm to the reading before (before tick 0: the
// default reading), dq_e9 those of orientation_e9 (x, y, z, w), and each is left out when all its numbers are
// zero. `buttons` holds the buttons themselves and is left out while they stay as they were. The hash at the
// end is taken when all is done.
//
// device: name, maximum_force_n, maximum_stiffness_n_per_m, maximum_damping_n_s_per_m, workspace_radius_m,
// position_resolution_m, senses_orientation, actuates_torque; then quiet_force_n, ramp_time_s,
// maximum_force_rate_n_per_s, maximum_speed_m_per_s, dead_man_buttons, each of which may be missing, as the
// first recordings have none of them, and is then the default of DeviceSpecification.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "haptic/device.h"
#include "haptic/recording/timed_command.h"

namespace spoonbill {

inline constexpr int recording_version = 1;
inline constexpr std::uint64_t recording_line_ticks = 100;  // most that a crash can lose
inline constexpr std::uint64_t recording_checkpoint_ticks = 1000;
inline constexpr std::uint64_t recording_tick_limit = 10'000'000;  // 2 h 46 min

struct RecordingHeader {
  DeviceSpecification device;
  Document document;  // the scene at tick 0
};

struct Checkpoint {
  std::uint64_t tick = 0;
  std::uint64_t state_hash = 0;

  friend bool operator==(const Checkpoint&, const Checkpoint&) = default;
};

struct Recording {
  RecordingHeader header;
  std::vector<DeviceReading> readings;  // one a tick
  std::vector<TimedCommand> commands;   // in order; those at readings.size() come after the last tick
  std::vector<Checkpoint> checkpoints;
  std::optional<Checkpoint> end;  // absent when the recording was cut
  std::string notice;             // one line for the person, empty when the recording is whole
};

// Reads a whole recording, or one that was cut anywhere after its first line, up to the cut. Anything else
// that is not as described above is an error that names line and field; so are more than 10 million ticks, 1
// GiB, a position beyond 10 m, an orientation that is not a unit quaternion.
Result<Recording> read_recording(const std::filesystem::path& file);
Result<Recording> read_recording(std::istream& in, const std::string& source);

}  // namespace spoonbill
