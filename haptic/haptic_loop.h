// The haptic thread: calls a function once a period at absolute deadlines, with real-time scheduling if the
// system permits it, and measures how well it meets the deadlines.
//
//   deadline   |<- period ->|            |            |            |
//   ticks      [0]          [1........................]  [2]       [3]     (numbers: LoopTick::index)
//                                        ^ dropped    ^ late, but by less than a period
//
// The clock also runs while the machine is suspended, so a suspension is treated like any other delay.
//
// If the thread is late by one or more whole periods, the ticks of those periods are dropped and never caught
// up. The next tick receives their number. The function must not lock, allocate, access files or block in any
// other way.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the time since the machine was started. It includes the time for which the machine was suspended,
// unless the system cannot sleep by CLOCK_BOOTTIME.
std::int64_t boot_time_ns();
void sleep_until_ns(std::int64_t deadline_ns);

// Requests first-in-first-out scheduling for `thread`, with a higher priority than that of the haptic thread.
// Meant for threads that only watch the haptic thread.
void make_ahead_of_haptic_thread(std::thread& thread);

// A lock-free histogram of durations. Exactly one thread calls add(). Any thread may call the other
// functions, whose results may lack a duration that is being added at the same time.
class DurationHistogram {
 public:
  // Adds a duration. Negative durations count as zero.
  void add(std::int64_t duration_ns) noexcept;

  // Returns the quantile of the added durations for `fraction` (0 to 1), with a relative error below 1/16.
  // Returns 0 if the histogram is empty.
  double quantile_s(double fraction) const noexcept;

  double mean_s() const noexcept;
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }

 private:
  // The histogram has sixteen bins for each octave. Below sixteen nanoseconds, it has one bin for each
  // nanosecond.
  static constexpr std::size_t bins_per_octave = 16;
  static constexpr std::size_t bin_count = 61 * bins_per_octave;

  static std::size_t bin_index(std::uint64_t duration_ns) noexcept;
  static double bin_centre_ns(std::size_t bin) noexcept;

  std::array<std::atomic<std::uint64_t>, bin_count> bins_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
};

inline constexpr Range<double> loop_period_range_s{1e-4, 1.0};

// Longest time that a tick may take under first-in-first-out scheduling. A thread whose tick takes longer
// would keep the whole machine waiting, so it gets ordinary scheduling for the rest of its life.
inline constexpr double longest_real_time_tick_s = 0.1;

struct LoopSettings {
  double period_s = 1e-3;
  bool real_time = true;  // requests first-in-first-out scheduling and locked memory
};

struct LoopTick {
  std::uint64_t index = 0;    // number of earlier calls
  std::uint64_t dropped = 0;  // whole periods skipped before this tick because the thread was late
};

struct LoopFigures {
  std::uint64_t ticks = 0;   // completed calls
  std::uint64_t late = 0;    // calls that began more than half a period after their deadline
  std::uint64_t missed = 0;  // dropped periods
  // Ticks per second over the last whole second; during the first second, since the start.
  double rate_hz = 0.0;
  // Quantiles of the delay from the deadline to the start of a tick, including dropped periods. Their
  // relative error is below 1/16.
  double lateness_p50_s = 0.0;
  double lateness_p99_s = 0.0;
  double lateness_p999_s = 0.0;
  // Mean and 99th percentile of the run time of a call of the function.
  double work_mean_s = 0.0;
  double work_p99_s = 0.0;
  // True while the thread has first-in-first-out scheduling, ahead of every ordinary thread. Becomes false
  // after a tick that takes longer than longest_real_time_tick_s.
  bool fifo = false;
  bool memory_locked = false;  // true if the memory in use at the start is locked
  std::string notice;          // one line to show to the user once; empty if everything was permitted
};

// Owner of the haptic thread. At most one loop of a process should be real-time, because locked memory
// affects the whole process.
class HapticLoop {
 public:
  // Calls `body` on a new thread, with denormal numbers flushed to zero, until stop(). `body` must not throw:
  // an exception ends the program (std::terminate). Errors: a period outside its range, an empty function, a
  // thread that cannot be started. If the system refuses real-time scheduling, the loop runs without it, and
  // LoopFigures::notice reports this.
  static Result<HapticLoop> start(const LoopSettings& settings, std::function<void(const LoopTick&)> body);

  HapticLoop(HapticLoop&&) noexcept;
  HapticLoop& operator=(HapticLoop&&) noexcept;
  ~HapticLoop();  // calls stop()

  // Stops the calls of `body` and waits until the last call has ended. Does nothing if called a second time.
  // Must be called from the owner's thread, never from within `body`.
  void stop();

  // Returns the current figures. Callable from any thread while the object exists, also after stop().
  LoopFigures figures() const;

 private:
  struct State;
  explicit HapticLoop(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spoonbill
