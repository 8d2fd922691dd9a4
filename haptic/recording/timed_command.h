// A command and when it happens. Kept as JSON: simulation commands are read by the engine's exchange,
// commands of the view by the program that draws, and neither needs to know the other's.
#pragma once

#include <cstdint>
#include <string>

#include "engine/exchange/json.h"

namespace spoonbill {

struct TimedCommand {
  std::uint64_t tick = 0;  // applies before this tick is executed; commands of one tick keep their order
  Json command;            // {"command": "...", arguments...}
  std::string origin;      // "bend.jsonl: line 12" or "bend.json: steps[3]", for messages
};

}  // namespace spoonbill
