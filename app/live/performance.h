// A script performed live: its hand and commands in real time, on the threads of a live session, with or
// without pictures drawn beside them. What a person at the window does, repeatable enough for tests and
// figures.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/live/live_session.h"
#include "haptic/script.h"

namespace spoonbill {

struct PerformanceSettings {
  LiveSettings live;
  bool draw = false;  // sixty frames a second at 1280x720 into memory
  std::filesystem::path recording;
};

struct PerformanceReport {
  LoopFigures loop;
  std::uint64_t frames = 0;
  std::vector<Notice> notices;
};

// By the program's main thread; returns when the script is over or `interrupted` says so. Refused: a model
// that cannot be simulated, a recording that cannot be written.
Result<PerformanceReport> perform(const Script& script, const Document& document, const std::string& source,
                                  const PerformanceSettings& settings,
                                  const std::function<bool()>& interrupted);

}  // namespace spoonbill
