#include "app/frames/frame_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace spoonbill {
namespace {

std::vector<std::uint64_t> numbers(const std::vector<SheetFrame>& frames) {
  std::vector<std::uint64_t> all;
  for (const SheetFrame& each : frames) all.push_back(each.frame);
  return all;
}

FrameEvents press() {
  FrameEvents events;
  for (std::uint64_t frame = 0; frame <= 100; ++frame) {
    const bool presses = frame >= 31 && frame < 47;
    std::vector<std::string> commands;
    if (frame == 7) commands = {"place_plane", "place_plane"};
    events.add(frame, static_cast<double>(frame) / 60.0,
               presses ? 1.0 - 0.01 * std::abs(static_cast<double>(frame) - 40.0) : 0.0, commands);
  }
  return events;
}

TEST(FrameEvents, AreChosenForTheSheet) {
  const std::vector<SheetFrame> frames = press().choose(6);
  EXPECT_EQ(numbers(frames), (std::vector<std::uint64_t>{0, 7, 31, 40, 47, 100}));
  EXPECT_EQ(frames[0].caption, "0.00 s");
  EXPECT_EQ(frames[1].caption, "0.12 s  place plane");
  EXPECT_EQ(frames[2].caption, "0.52 s  touch");
  EXPECT_EQ(frames[3].caption, "0.67 s  largest force, 1.00 N");
  EXPECT_EQ(frames[4].caption, "0.78 s  release");
}

TEST(FrameEvents, GapsAreHalvedWhereThereIsRoom) {
  EXPECT_EQ(numbers(press().choose(8)), (std::vector<std::uint64_t>{0, 7, 31, 40, 47, 73, 86, 100}));
  FrameEvents few;
  for (std::uint64_t frame = 0; frame < 3; ++frame) few.add(4 * frame, 0.0, 0.0, {});
  EXPECT_EQ(numbers(few.choose(12)), (std::vector<std::uint64_t>{0, 4, 8}));
  EXPECT_TRUE(FrameEvents().choose(12).empty());
}

TEST(FrameEvents, TooManyAreThinned) {
  FrameEvents events;
  for (std::uint64_t frame = 0; frame < 1000; ++frame)
    events.add(frame, 0.0, frame % 2 == 0 ? 0.0 : frame == 501 ? 2.0 : 1.0, {"undo"});
  const std::vector<SheetFrame> frames = events.choose(12);
  ASSERT_EQ(frames.size(), 12u);
  EXPECT_EQ(frames.front().frame, 0u);
  EXPECT_EQ(frames.back().frame, 999u);
  EXPECT_EQ(
      std::count_if(frames.begin(), frames.end(), [](const SheetFrame& each) { return each.frame == 501; }),
      1);
}

TEST(FrameEvents, CommandsGiveWayFirst) {
  FrameEvents events;
  for (std::uint64_t frame = 0; frame < 40; ++frame)
    events.add(frame, 0.0, frame >= 20 && frame < 25 ? 1.0 : 0.0, {"undo"});
  const std::vector<std::uint64_t> chosen = numbers(events.choose(6));
  for (const std::uint64_t must : {0u, 20u, 25u, 39u})
    EXPECT_EQ(std::count(chosen.begin(), chosen.end(), must), 1) << must;
  EXPECT_EQ(chosen.size(), 6u);
}

}  // namespace
}  // namespace spoonbill
