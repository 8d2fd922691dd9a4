// Scripts: the motions of a tool and what is asked meanwhile, as a person writes them down. JSON:
//
//   {"spoonbill_script": 1,
//    "note": "bends the handle",                                 anywhere a note may stand: top or step
//    "model": "../models/spoon-handle.json",                     from the script's own folder
//    "hand": {"mass_kg": 0.1, "stiffness_n_per_m": 300, "damping_n_s_per_m": 10.954},     may be left out
//    "steps": [
//      {"start_mm": [60, 40, 0], "turn": {"axis": [0, 0, 1], "degrees": 90}},             turn may be left
//      out
//      {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]},
//      {"move_to_mm": [60, 6, 0], "over_s": 1.5},
//      {"move_to_mm": [60, 0, 0], "turn_to": {"axis": [0, 0, 1], "degrees": 45}, "over_s": 1},
//      {"turn_to": {"axis": [0, 0, 1], "degrees": 0}, "over_s": 0.5},
//      {"grip": true},
//      {"hold_s": 0.5},
//      {"at_s": 6, "grip": false}]}
//
// Steps follow each other; start comes first among the motions. Commands and grips take no time and happen
// where they stand. A step with "at_s" waits for that time. A move starts and ends at rest (minimum jerk).
// "turn" and "turn_to" are orientations from the world's axes, not turns from the last one. Times are whole
// milliseconds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "haptic/hand.h"
#include "haptic/recording/timed_command.h"

namespace spoonbill {

inline constexpr int script_version = 1;
inline constexpr std::uint64_t script_tick_limit = 600'000;  // 10 minutes

// A motion between two rests, over ticks begin to end - 1; `from` and `to` are the same while the hand holds.
struct ScriptMotion {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  HandTarget from, to;
};

// A script made ready. Plain data; any thread may read it.
struct Script {
  std::filesystem::path model_file;
  Hand hand;
  HandTarget start;
  std::vector<ScriptMotion> motions;  // without gaps
  std::vector<TimedCommand> commands;

  std::uint64_t tick_count() const { return motions.empty() ? 0 : motions.back().end; }

  // Where the hand wants the handle at the end of a tick; after the last tick, where the script left it.
  HandTarget target_at(std::uint64_t tick) const;
};

// Commands of the simulation are checked here, those of the view by the program that knows them.
Result<Script> script_from_json(const Json& json, const std::string& source,
                                const std::filesystem::path& folder);

// At most 16 MiB is read. A model that does not exist is refused here; reading it is left to the caller.
Result<Script> read_script(const std::filesystem::path& file);

}  // namespace spoonbill
