#include "haptic/haptic_loop.h"

#include <atomic>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <system_error>
#include <thread>
#include <utility>

#include "engine/base/processor.h"
#include "haptic/duration_histogram.h"
#include "haptic/real_time.h"

namespace spoonbill {

namespace {

constexpr std::int64_t nanoseconds_a_second = 1'000'000'000;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * nanoseconds_a_second + now.tv_nsec;
}

void sleep_until(std::int64_t deadline_ns) {
  timespec deadline{};
  deadline.tv_sec = deadline_ns / nanoseconds_a_second;
  deadline.tv_nsec = deadline_ns % nanoseconds_a_second;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

}  // namespace

// Atomics: written by the loop's thread alone (`stopping` by the owner), read by any. The rest is set before
// start() returns and not changed until stop().
struct HapticLoop::State {
  std::function<void(const LoopTick&)> body;
  std::int64_t period_ns = 0;
  RealTimeGrant grant;
  std::thread thread;

  std::atomic<bool> started{false};
  std::atomic<bool> stopping{false};
  std::atomic<std::uint64_t> late{0};
  std::atomic<std::uint64_t> missed{0};
  std::atomic<double> rate_hz{0.0};
  DurationHistogram lateness;
  DurationHistogram work;

  void run() noexcept;
  void tick_at(std::int64_t begin_ns, std::int64_t lateness_ns, LoopTick& tick);
  void end();
};

namespace {

// The rate over windows of a second.
struct RateWindow {
  std::int64_t begin_ns;
  std::uint64_t ticks = 0;
  bool first = true;

  void add_tick(std::int64_t end_ns, std::atomic<double>& rate_hz) {
    ++ticks;
    const std::int64_t elapsed_ns = end_ns - begin_ns;
    const bool whole = elapsed_ns >= nanoseconds_a_second;
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
  body(tick);
  work.add(now_ns() - begin_ns);
  ++tick.index;
}

void HapticLoop::State::run() noexcept {
  const DenormalsFlushed flushed;
  touch_stack();
  started.wait(false);
  LoopTick tick;
  std::int64_t deadline_ns = now_ns() + period_ns;
  RateWindow window{deadline_ns - period_ns};
  for (;;) {
    sleep_until(deadline_ns);
    if (stopping.load(std::memory_order_acquire)) return;
    const std::int64_t begin_ns = now_ns();
    tick_at(begin_ns, begin_ns - deadline_ns, tick);
    window.add_tick(begin_ns, rate_hz);
    deadline_ns += static_cast<std::int64_t>(tick.dropped + 1) * period_ns;
  }
}

void HapticLoop::State::end() {
  if (!thread.joinable()) return;
  stopping.store(true, std::memory_order_release);
  thread.join();
  give_back(grant);
}

Result<HapticLoop> HapticLoop::start(const LoopSettings& settings,
                                     std::function<void(const LoopTick&)> body) {
  if (Status status = check_range("the loop's period_s", settings.period_s, loop_period_range_s);
      !status.ok()) {
    return status.error();
  }
  if (!body) return Error{"the loop has nothing to call"};
  auto state = std::make_unique<State>();
  state->body = std::move(body);
  state->period_ns = std::llround(settings.period_s * 1e9);
  try {
    state->thread = std::thread([&inner = *state] { inner.run(); });
  } catch (const std::system_error& problem) {
    return Error{std::string("the haptic thread cannot be started: ") + problem.what()};
  }
  if (settings.real_time) state->grant = grant_real_time(state->thread.native_handle());
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
  figures.fifo = state_->grant.fifo;
  figures.memory_locked = state_->grant.memory_locked;
  figures.notice = state_->grant.notice;
  return figures;
}

}  // namespace spoonbill
