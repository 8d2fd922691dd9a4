// Tests the haptic loop by counts and values of its thread, never by durations, because the machine may be
// busy.
#include "haptic/haptic_loop.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <vector>

#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

void wait_for(const std::atomic<std::uint64_t>& number, std::uint64_t at_least) {
  while (number.load() < at_least) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void expect_consistent(const LoopFigures& figures) {
  EXPECT_GT(figures.rate_hz, 0.0);
  EXPECT_LE(figures.late, figures.ticks);
  EXPECT_GE(figures.lateness_p50_s, 0.0);
  EXPECT_LE(figures.lateness_p50_s, figures.lateness_p99_s);
  EXPECT_LE(figures.lateness_p99_s, figures.lateness_p999_s);
  EXPECT_GT(figures.work_mean_s, 0.0);
  EXPECT_EQ(figures.notice.empty(), figures.fifo && figures.memory_locked) << figures.notice;
}

TEST(HapticLoop, CountsItsTicks) {
  std::atomic<std::uint64_t> calls = 0, out_of_order = 0, dropped = 0;
  auto loop = HapticLoop::start({}, [&](const LoopTick& tick) {
    if (tick.index != calls) ++out_of_order;
    dropped += tick.dropped;
    ++calls;
  });
  ASSERT_TRUE(loop.ok()) << loop.error().message;
  wait_for(calls, 50);
  for (int asked = 0; asked < 100; ++asked) EXPECT_LE(loop->figures().ticks, calls.load());
  loop->stop();
  const std::uint64_t at_stop = calls;
  EXPECT_EQ(out_of_order, 0u);
  EXPECT_EQ(loop->figures().ticks, at_stop);
  EXPECT_EQ(loop->figures().missed, dropped);
  expect_consistent(loop->figures());
  loop->stop();
  EXPECT_EQ(calls, at_stop);
}

// The function takes three and a half periods, so that the loop drops at least two ticks each time. The loop
// reports their number to the function.
TEST(HapticLoop, DropsWhatItMissesAndSaysSo) {
  std::atomic<std::uint64_t> calls = 0, dropped = 0, told_too_few = 0;
  LoopSettings settings;
  settings.period_s = 4e-3;
  auto loop = HapticLoop::start(settings, [&](const LoopTick& tick) {
    dropped += tick.dropped;
    if (tick.index > 0 && tick.dropped < 2) ++told_too_few;
    ++calls;
    std::this_thread::sleep_for(std::chrono::microseconds(14'000));
  });
  ASSERT_TRUE(loop.ok()) << loop.error().message;
  wait_for(calls, 10);
  loop->stop();
  const LoopFigures figures = loop->figures();
  EXPECT_EQ(told_too_few, 0u);
  EXPECT_EQ(figures.missed, dropped);
  EXPECT_GE(figures.missed, 2 * (figures.ticks - 1));
  EXPECT_GE(figures.late, figures.ticks - 1);
  EXPECT_GE(figures.work_mean_s, 14e-3);
  EXPECT_GE(figures.lateness_p99_s, 8e-3 * (1.0 - 1.0 / 16.0));
}

TEST(HapticLoop, MovesAndStopsWithItsOwner) {
  std::atomic<std::uint64_t> calls = 0;
  std::uint64_t at_end = 0;
  {
    auto started = HapticLoop::start({}, [&](const LoopTick&) { ++calls; });
    ASSERT_TRUE(started.ok());
    HapticLoop loop = std::move(started).value();
    wait_for(calls, 3);
    std::atomic<std::uint64_t> others = 0;
    auto second = HapticLoop::start({}, [&](const LoopTick&) { ++others; });
    ASSERT_TRUE(second.ok());
    loop = std::move(second).value();  // the assignment ends the first loop
    at_end = calls;
    wait_for(others, 3);
    loop.stop();
  }
  EXPECT_EQ(calls, at_end);
}

TEST(HapticLoop, FlushesDenormals) {
  std::atomic<std::uint64_t> calls = 0, kept = 0;
  auto loop = HapticLoop::start({}, [&](const LoopTick&) {
    if ((_mm_getcsr() & 0x8040u) != 0x8040u) ++kept;
    ++calls;
  });
  ASSERT_TRUE(loop.ok());
  wait_for(calls, 1);
  loop->stop();
  EXPECT_EQ(kept, 0u);
}

TEST(HapticLoop, WithoutRealTimeAsksForNothing) {
  LoopSettings settings;
  settings.real_time = false;
  const auto loop = HapticLoop::start(settings, [](const LoopTick&) {});
  ASSERT_TRUE(loop.ok());
  const LoopFigures figures = loop->figures();
  EXPECT_FALSE(figures.fifo);
  EXPECT_FALSE(figures.memory_locked);
  EXPECT_EQ(figures.notice, "");
}

TEST(HapticLoop, RefusesWhatItCannotRun) {
  EXPECT_EQ(HapticLoop::start({}, nullptr).error().code, ErrorCode::missing);
  LoopSettings settings;
  settings.period_s = 1e-6;
  const auto loop = HapticLoop::start(settings, [](const LoopTick&) {});
  EXPECT_EQ(loop.error().code, ErrorCode::out_of_range);
  EXPECT_EQ(loop.error().field, "period_s");
  EXPECT_EQ(Refusal(loop), Refusal(ErrorCode::out_of_range, "period_s"));
}

// Gives up root's rights and runs the loop. Exits with 0 if the loop runs and reports both the missing right
// and the remedy.
void run_without_rights() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  setrlimit(RLIMIT_MEMLOCK, &none);
  constexpr uid_t nobody = 65534;
  if (geteuid() == 0 && setuid(nobody) != 0) std::_Exit(2);
  std::atomic<std::uint64_t> calls = 0;
  auto loop = HapticLoop::start({}, [&](const LoopTick&) { ++calls; });
  if (!loop.ok()) std::_Exit(3);
  wait_for(calls, 3);
  loop->stop();
  const LoopFigures figures = loop->figures();
  const bool said = figures.notice.find("real-time scheduling") != std::string::npos &&
                    figures.notice.find("limits.conf") != std::string::npos;
  std::_Exit(!figures.fifo && said ? 0 : 1);
}

TEST(HapticLoopDeathTest, RunsAndSaysSoWhereRealTimeIsRefused) {
  EXPECT_EXIT(run_without_rights(), testing::ExitedWithCode(0), "");
}

TEST(HapticLoopDeathTest, AnExceptionEndsTheProgramAloud) {
  const auto throwing = [] {
    const auto loop =
        HapticLoop::start({}, [](const LoopTick&) { throw std::runtime_error("from the tick"); });
    std::this_thread::sleep_for(std::chrono::hours(1));
  };
  EXPECT_DEATH(throwing(), "from the tick");
}

TEST(HapticLoop, LosesRealTimeSchedulingInALongTick) {
  std::atomic<bool> is_long{true};
  auto loop = HapticLoop::start({}, [&](const LoopTick&) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(250);
    while (is_long.load() && std::chrono::steady_clock::now() < end) {
    }
    is_long.store(false);
  });
  ASSERT_TRUE(loop.ok());
  if (!loop->figures().fifo) GTEST_SKIP() << "the system does not permit real-time scheduling";
  while (is_long.load()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_FALSE(loop->figures().fifo);
}

}  // namespace
}  // namespace spoonbill
