// What the drawing thread gets of a live session: one tick, as plain data.
#pragma once

#include <array>
#include <cstdint>

#include "app/session/session_facts.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

struct LiveFrame {
  Snapshot snapshot;
  SessionFacts facts;
  std::uint32_t safety_flags = 0;  // SafetyFlag bits of the last tick
  bool recording = false;
  std::uint64_t session = 0;       // grows whenever another session was opened or begun anew
  std::uint64_t deed = 0;          // grows with every touch and command: what a person would want saved
  std::uint64_t document = 0;      // grows whenever another document was opened
  std::uint64_t works = 0;         // answers to work asked for: open, start recording
  std::uint64_t failed_works = 0;  // bit n % 64: whether the n-th of them failed, from 0
};

// A document as the haptic thread hands it over to be saved, with its scene as it was at one tick.
struct LiveScene {
  std::string title;
  Scene scene;
  std::uint64_t document = 0;  // as in LiveFrame
  std::uint64_t change = 0;    // grows with every change of the scene, its settling included
  std::uint64_t deed = 0;      // as in LiveFrame
  std::uint64_t request = 0;   // of the last save that was asked for before it was written
};

// The force on the hand, one value a tick in newtons, for a plot.
struct ForceSample {
  float force_n = 0.0F;
};

}  // namespace spoonbill
