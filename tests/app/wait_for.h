// Waits for a state of a live session that a frame shows, never for a fixed time.
#pragma once

#include <chrono>
#include <thread>

#include "app/live/live_session.h"

namespace spoonbill {

// A machine under load or a sanitizer may take its time; nothing is judged by it.
inline constexpr std::chrono::seconds patience{300};

// Whether the condition held of a frame before patience ran out.
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
