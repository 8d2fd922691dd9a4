// The thread that ticks: calls a function once a period at absolute deadlines, as a real-time thread where
// the system permits that, and keeps the figures of how well it did.
//
//   deadline   |<- period ->|            |            |            |
//   ticks      [0]          [1........................]  [4]       [5]
//                                        ^ dropped    ^ late, but less than a period
//
// A tick that is late by a whole period or more is dropped, never caught up: the next one is told how many
// were. What must not happen in the function: locks, allocation, files, anything that may wait.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

inline constexpr Range<double> loop_period_range_s{1e-4, 1.0};

struct LoopSettings {
  double period_s = 1e-3;
  bool real_time = true;  // ask for first-in-first-out scheduling and locked memory
};

struct LoopTick {
  std::uint64_t index = 0;    // of the calls, from 0
  std::uint64_t dropped = 0;  // whole periods that passed before this tick because the thread was late
};

struct LoopFigures {
  std::uint64_t ticks = 0;   // calls that have ended
  std::uint64_t late = 0;    // of them, begun more than half a period after their deadline
  std::uint64_t missed = 0;  // periods dropped
  double rate_hz = 0.0;      // of the last whole second, or since the start when there is none yet
  // How long after its deadline a tick begins, dropped periods included; within 1/16.
  double lateness_p50_s = 0.0;
  double lateness_p99_s = 0.0;
  double lateness_p999_s = 0.0;
  // How long the function takes.
  double work_mean_s = 0.0;
  double work_p99_s = 0.0;
  bool fifo = false;           // runs first-in-first-out, before every ordinary thread
  bool memory_locked = false;  // what the program had in memory at the start stays there
  std::string notice;          // one line for the person, to be shown once; empty where all was permitted
};

// Owns its thread. At most one at a time in a process should be real-time: locking memory concerns all of it.
class HapticLoop {
 public:
  // The function is called on the new thread, with denormal numbers flushed to zero, until stop(). It must
  // not throw: an exception ends the program with its message (std::terminate). Refused: a period outside
  // its range, an empty function, no thread to be had. Being refused real-time scheduling is no error but a
  // notice.
  static Result<HapticLoop> start(const LoopSettings& settings, std::function<void(const LoopTick&)> body);

  HapticLoop(HapticLoop&&) noexcept;
  HapticLoop& operator=(HapticLoop&&) noexcept;
  ~HapticLoop();  // stops

  // Returns when the last call has ended, at the latest a period later. Again: nothing. From the owner's
  // thread, never from within the function.
  void stop();

  // From any thread while the object lives, also after stop().
  LoopFigures figures() const;

 private:
  struct State;
  explicit HapticLoop(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
