// Scripts: the motions of a tool and the commands between them, as a person writes them by hand.
//
//   {"spoonbill_script": 1,
//    "note": "bends the handle",                      optional, here and in each step
//    "model": "../models/spoon-handle.json",          relative to the folder of the script
//    "hand": {"mass_kg": 0.1, "stiffness_n_per_m": 300, "damping_n_s_per_m": 10.954},     optional
//    "steps": [
//      {"start_mm": [60, 40, 0], "turn": {"axis": [0, 0, 1], "degrees": 90}},             turn is optional
//      {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]},
//      {"move_to_mm": [60, 6, 0], "over_s": 1.5},
//      {"move_to_mm": [60, 0, 0], "turn_to": {"axis": [0, 0, 1], "degrees": 45}, "over_s": 1},
//      {"turn_to": {"axis": [0, 0, 1], "degrees": 0}, "over_s": 0.5},
//      {"grip": true},
//      {"hold_s": 0.5},
//      {"at_s": 6, "grip": false}]}
//
// Steps run one after another; start_mm must be the first motion. Commands and grips take no time and happen
// at the end of the step before them. A step with "at_s" waits until that time. A move starts and ends at
// rest (minimum jerk). "turn" and "turn_to" are rotations from the world axes, not from the previous
// orientation. Times are whole milliseconds. Commands with fields of old documents are converted (see
// old_documents.h). The conversion uses the old field "iterations" of the tool, as set by the last command
// before; default: 6.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "haptic/recording.h"
#include "haptic/virtual_device.h"

namespace spoonbill {

inline constexpr int script_version = 1;
inline constexpr std::uint64_t script_tick_limit = 600'000;  // 10 minutes

// A motion from rest to rest during ticks begin to end - 1. `from` and `to` are equal while the hand waits.
struct ScriptMotion {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  HandTarget from, to;
};

// A parsed script. Plain data; any thread may read it.
struct Script {
  std::filesystem::path model_file;
  Hand hand;
  HandTarget start;
  std::vector<ScriptMotion> motions;  // motions without gaps between them
  std::vector<TimedCommand> commands;

  std::uint64_t tick_count() const { return motions.empty() ? 0 : motions.back().end; }

  // Returns the target of the hand at the end of a tick. For ticks after the last tick, returns the final
  // target.
  HandTarget target_at(std::uint64_t tick) const;
};

// Parses a script. Commands of the simulation are checked here; the caller checks commands of the view.
Result<Script> script_from_json(const Json& json, const std::string& source,
                                const std::filesystem::path& folder);

// Reads a script of at most 16 MiB. A model file that does not exist is an error; reading the model is left
// to the caller.
Result<Script> read_script(const std::filesystem::path& file);

// A virtual device whose hand follows a script from tick 0.
class ScriptedDevice : public Device {
 public:
  // The script must outlive the device. Errors are those of VirtualDevice::make().
  static Result<ScriptedDevice> make(const Script& script);

  const DeviceSpecification& specification() const override { return handle_.specification(); }
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override { handle_.set_force(force_n); }

 private:
  ScriptedDevice(const Script& script, VirtualDevice handle) : script_(&script), handle_(std::move(handle)) {}

  const Script* script_;
  VirtualDevice handle_;
  std::uint64_t tick_ = 0;
};

}  // namespace spoonbill
