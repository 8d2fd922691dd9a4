// Performs a script live: its hand and commands run in real time on the threads of a live session, with or
// without drawing. This imitates a user of the window in a repeatable manner, for tests and measurements.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/live/live_session.h"
#include "haptic/script.h"

namespace spoonbill {

// Settings of perform().
struct PerformanceSettings {
  LiveSettings live;
  bool draw = false;  // if true, draws 60 frames per second at 1280x720 into memory
  std::filesystem::path recording;
  OutputOptions output;  // how the recording replaces an older file
};

// Results of perform(), which plays a script in a live session and records it.
struct PerformanceReport {
  LoopFigures loop;        // figures of the whole session, including the ticks outside the recording
  RecordedTicks recorded;  // ticks of the recording alone, as a replay reports them
  std::uint64_t frames = 0;
  std::vector<Notice> notices;
};

// Performs the script on the main thread. Returns at the end of the script or once `interrupted` returns
// true. Returns an error if the model cannot be simulated or the recording cannot be written. An interrupted
// recording stays as FILE.part.
Result<PerformanceReport> perform(const Script& script, const Document& document, const std::string& source,
                                  const PerformanceSettings& settings,
                                  const std::function<bool()>& interrupted);

}  // namespace spoonbill
