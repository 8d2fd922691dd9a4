// Waits until a frame of a live session shows a state, instead of for a fixed time.
#pragma once

#include <chrono>
#include <thread>

#include "app/live/live_session.h"

namespace spoonbill {

// Time limit, long enough for a loaded machine or a sanitizer. No test depends on its value.
inline constexpr std::chrono::seconds patience{300};

// Returns true if a frame satisfied the condition within the time limit.
template <class Condition>
bool wait_for(LiveSession& live, Condition condition) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < give_up) {
    if (condition(live.frame())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace spoonbill
