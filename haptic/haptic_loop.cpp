#include "haptic/haptic_loop.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "engine/base/processor.h"

namespace spoonbill {

// The real-time privileges that the operating system granted to a thread.
struct RealTimeGrant {
  bool fifo = false;
  bool memory_locked = false;
  std::string notice;  // one line: what was refused and how to permit it; empty if nothing was refused
};

namespace {

constexpr double nanosecond_s = 1e-9;
// Adds to a counter. A load and a store suffice, because only one thread writes it.
void increase(std::atomic<std::uint64_t>& number, std::uint64_t by) noexcept {
  number.store(number.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;

// Priority above ordinary threads and below the kernel threads at 99.
constexpr int desired_priority = 80;

// Stack size touched in advance, more than the deepest call of a tick uses.
constexpr std::size_t touched_stack_bytes = std::size_t{256} << 10;
constexpr std::size_t page_bytes = 4096;

bool set_priority(pthread_t thread, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(thread, SCHED_FIFO, &parameters) == 0;
}

bool make_fifo(pthread_t thread) {
  if (set_priority(thread, desired_priority)) return true;
  rlimit permitted{};
  if (getrlimit(RLIMIT_RTPRIO, &permitted) != 0 || permitted.rlim_cur == 0) return false;
  return set_priority(thread, static_cast<int>(std::min<rlim_t>(permitted.rlim_cur, desired_priority)));
}

std::string make_notice(const RealTimeGrant& grant) {
  std::string refused, lines, checked_with;
  if (!grant.fifo) {
    refused = "real-time scheduling";
    lines = "\"USER - rtprio 80\"";
    checked_with = "ulimit -r";
  }
  if (!grant.memory_locked) {
    refused += (refused.empty() ? "" : " and ") + std::string("locked memory");
    lines += (lines.empty() ? "" : " and ") + std::string("\"USER - memlock unlimited\"");
    checked_with += (checked_with.empty() ? "" : ", ") + std::string("ulimit -l");
  }
  if (refused.empty()) return {};
  return "the system does not permit " + refused + " (" + checked_with +
         "); the loop runs without it, at the rate shown; to permit it, add " + lines +
         " to /etc/security/limits.conf and log in again";
}

// Returns CLOCK_BOOTTIME, which also advances while the machine is suspended. Some containers cannot sleep by
// this clock; there, returns CLOCK_MONOTONIC.
clockid_t loop_clock() {
  static const clockid_t clock = [] {
    const timespec past{};
    return clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &past, nullptr) == 0 ? CLOCK_BOOTTIME
                                                                               : CLOCK_MONOTONIC;
  }();
  return clock;
}

// Requests first-in-first-out scheduling for the thread, at priority 80 or the highest permitted one, and
// locks the memory of the process.
RealTimeGrant grant_real_time(pthread_t thread) {
  RealTimeGrant grant;
  grant.fifo = make_fifo(thread);
  // MCL_FUTURE would make every later allocation fail once the limit is reached. With MCL_ONFAULT, memory
  // that is mapped but never used stays unlocked, such as the stacks of other threads.
  grant.memory_locked = mlockall(MCL_CURRENT | MCL_ONFAULT) == 0;
  grant.notice = make_notice(grant);
  return grant;
}

// Unlocks the memory that grant_real_time() locked.
void release_real_time(const RealTimeGrant& grant) {
  if (grant.memory_locked) munlockall();
}

// Writes to each page of the calling thread's stack, so that later calls do not wait for page faults.
[[gnu::noinline]] void touch_stack() {
  std::byte stack[touched_stack_bytes];
  volatile std::byte* const pages = stack;
  for (std::size_t byte = 0; byte < touched_stack_bytes; byte += page_bytes) pages[byte] = std::byte{0};
}

}  // namespace

std::int64_t boot_time_ns() {
  timespec now{};
  clock_gettime(loop_clock(), &now);
  return now.tv_sec * nanoseconds_per_second + now.tv_nsec;
}

void sleep_until_ns(std::int64_t deadline_ns) {
  timespec deadline{};
  deadline.tv_sec = deadline_ns / nanoseconds_per_second;
  deadline.tv_nsec = deadline_ns % nanoseconds_per_second;
  while (clock_nanosleep(loop_clock(), TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

void make_ahead_of_haptic_thread(std::thread& thread) {
  set_priority(thread.native_handle(), desired_priority + 1);
}

std::size_t DurationHistogram::bin_index(std::uint64_t duration_ns) noexcept {
  if (duration_ns < bins_per_octave) return duration_ns;
  const auto shift = static_cast<std::size_t>(std::bit_width(duration_ns / bins_per_octave) - 1);
  return shift * bins_per_octave + (duration_ns >> shift);
}

double DurationHistogram::bin_centre_ns(std::size_t bin) noexcept {
  if (bin < 2 * bins_per_octave) return static_cast<double>(bin);
  const std::size_t shift = bin / bins_per_octave - 1;
  const std::uint64_t low = (bin - shift * bins_per_octave) << shift;
  return static_cast<double>(low) + 0.5 * static_cast<double>((std::uint64_t{1} << shift) - 1);
}

void DurationHistogram::add(std::int64_t duration_ns) noexcept {
  const auto duration = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  increase(bins_[bin_index(duration)], 1);
  increase(count_, 1);
  increase(sum_ns_, duration);
}

double DurationHistogram::quantile_s(double fraction) const noexcept {
  std::uint64_t total = 0;
  for (const auto& bin : bins_) total += bin.load(std::memory_order_relaxed);
  if (total == 0) return 0.0;
  const double target_count = std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(total));
  std::uint64_t seen = 0;
  std::size_t highest = 0;
  for (std::size_t bin = 0; bin < bin_count; ++bin) {
    const std::uint64_t here = bins_[bin].load(std::memory_order_relaxed);
    if (here == 0) continue;
    highest = bin;
    seen += here;
    if (static_cast<double>(seen) >= target_count) break;
  }
  return bin_centre_ns(highest) * nanosecond_s;
}

double DurationHistogram::mean_s() const noexcept {
  const std::uint64_t total = count();
  if (total == 0) return 0.0;
  return static_cast<double>(sum_ns_.load(std::memory_order_relaxed)) / static_cast<double>(total) *
         nanosecond_s;
}

// The owner writes `started` and `stopping`, and the owner and the watcher write `fifo`. Only the thread of
// the loop writes the other atomic members and the histograms. Any thread may read all of these. All other
// members are set before start() returns and are constant until stop().
struct HapticLoop::State {
  std::function<void(const LoopTick&)> body;
  std::int64_t period_ns = 0;
  RealTimeGrant grant;
  std::thread thread;

  // Ends the real-time scheduling of the loop's thread if one tick takes too long. The watcher has a higher
  // priority than the loop's thread. It exists only if the loop's thread is scheduled first-in-first-out.
  std::thread watcher;
  std::atomic<std::int64_t> tick_begin_ns{0};  // 0 between ticks
  std::atomic<bool> fifo{false};

  std::atomic<bool> started{false};
  std::atomic<bool> stopping{false};
  std::atomic<std::uint64_t> late{0};
  std::atomic<std::uint64_t> missed{0};
  std::atomic<double> rate_hz{0.0};
  DurationHistogram lateness;
  DurationHistogram work;

  void run() noexcept;
  void watch() noexcept;
  void tick_at(std::int64_t begin_ns, std::int64_t lateness_ns, LoopTick& tick);
  void end();
};

namespace {

// Measures the tick rate over windows of one second.
struct RateWindow {
  std::int64_t begin_ns;
  std::uint64_t ticks = 0;
  bool first = true;

  void add_tick(std::int64_t end_ns, std::atomic<double>& rate_hz) {
    ++ticks;
    const std::int64_t elapsed_ns = end_ns - begin_ns;
    const bool whole = elapsed_ns >= nanoseconds_per_second;
    if (elapsed_ns <= 0 || (!first && !whole)) return;
    rate_hz.store(static_cast<double>(ticks) * 1e9 / static_cast<double>(elapsed_ns),
                  std::memory_order_relaxed);
    if (whole) *this = {end_ns, 0, false};
  }
};

}  // namespace

void HapticLoop::State::tick_at(std::int64_t begin_ns, std::int64_t lateness_ns, LoopTick& tick) {
  tick.dropped = static_cast<std::uint64_t>(lateness_ns / period_ns);
  missed.store(missed.load(std::memory_order_relaxed) + tick.dropped, std::memory_order_relaxed);
  if (2 * lateness_ns > period_ns) {
    late.store(late.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  lateness.add(lateness_ns);
  tick_begin_ns.store(begin_ns, std::memory_order_relaxed);
  body(tick);
  tick_begin_ns.store(0, std::memory_order_relaxed);
  work.add(boot_time_ns() - begin_ns);
  ++tick.index;
}

void HapticLoop::State::run() noexcept {
  const DenormalsFlushed flushed;
  touch_stack();
  started.wait(false);
  LoopTick tick;
  std::int64_t deadline_ns = boot_time_ns() + period_ns;
  RateWindow window{deadline_ns - period_ns};
  for (;;) {
    sleep_until_ns(deadline_ns);
    if (stopping.load(std::memory_order_acquire)) return;
    const std::int64_t begin_ns = boot_time_ns();
    tick_at(begin_ns, begin_ns - deadline_ns, tick);
    window.add_tick(begin_ns, rate_hz);
    deadline_ns += static_cast<std::int64_t>(tick.dropped + 1) * period_ns;
  }
}

void HapticLoop::State::watch() noexcept {
  const auto longest_ns = std::llround(longest_real_time_tick_s * 1e9);
  while (!stopping.load(std::memory_order_acquire)) {
    sleep_until_ns(boot_time_ns() + longest_ns / 5);
    const std::int64_t begin_ns = tick_begin_ns.load(std::memory_order_relaxed);
    if (begin_ns == 0 || boot_time_ns() - begin_ns <= longest_ns) continue;
    const sched_param ordinary{};
    pthread_setschedparam(thread.native_handle(), SCHED_OTHER, &ordinary);
    fifo.store(false, std::memory_order_relaxed);
    return;
  }
}

void HapticLoop::State::end() {
  if (!thread.joinable()) return;
  stopping.store(true, std::memory_order_release);
  if (watcher.joinable()) watcher.join();
  thread.join();
  release_real_time(grant);
}

Result<HapticLoop> HapticLoop::start(const LoopSettings& settings,
                                     std::function<void(const LoopTick&)> body) {
  if (Status status = check_range("period_s", settings.period_s, loop_period_range_s); !status.ok()) {
    return status.error().in("haptic loop");
  }
  if (!body) return Error{ErrorCode::missing, "the loop has no function to call", "body"};
  auto state = std::make_unique<State>();
  state->body = std::move(body);
  state->period_ns = std::llround(settings.period_s * 1e9);
  try {
    state->thread = std::thread([&inner = *state] { inner.run(); });
  } catch (const std::system_error& problem) {
    return Error{ErrorCode::unavailable,
                 std::string("the haptic thread cannot be started: ") + problem.what()};
  }
  if (settings.real_time) state->grant = grant_real_time(state->thread.native_handle());
  state->fifo.store(state->grant.fifo, std::memory_order_relaxed);
  if (state->grant.fifo) {
    try {
      state->watcher = std::thread([&inner = *state] { inner.watch(); });
      make_ahead_of_haptic_thread(state->watcher);
    } catch (const std::system_error&) {
      // Without a watcher the loop still runs, but it keeps real-time scheduling however long a tick takes.
    }
  }
  state->started.store(true, std::memory_order_release);
  state->started.notify_one();
  return HapticLoop(std::move(state));
}

HapticLoop::HapticLoop(std::unique_ptr<State> state) : state_(std::move(state)) {}

HapticLoop::HapticLoop(HapticLoop&&) noexcept = default;

HapticLoop& HapticLoop::operator=(HapticLoop&& other) noexcept {
  if (this == &other) return *this;
  stop();
  state_ = std::move(other.state_);
  return *this;
}

HapticLoop::~HapticLoop() {
  stop();
}

void HapticLoop::stop() {
  if (state_) state_->end();
}

LoopFigures HapticLoop::figures() const {
  LoopFigures figures;
  if (!state_) return figures;
  figures.ticks = state_->work.count();
  figures.late = state_->late.load(std::memory_order_relaxed);
  figures.missed = state_->missed.load(std::memory_order_relaxed);
  figures.rate_hz = state_->rate_hz.load(std::memory_order_relaxed);
  figures.lateness_p50_s = state_->lateness.quantile_s(0.5);
  figures.lateness_p99_s = state_->lateness.quantile_s(0.99);
  figures.lateness_p999_s = state_->lateness.quantile_s(0.999);
  figures.work_mean_s = state_->work.mean_s();
  figures.work_p99_s = state_->work.quantile_s(0.99);
  figures.fifo = state_->fifo.load(std::memory_order_relaxed);
  figures.memory_locked = state_->grant.memory_locked;
  figures.notice = state_->grant.notice;
  return figures;
}

}  // namespace spoonbill
