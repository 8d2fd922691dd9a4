#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "render/view_settings.h"

namespace spoonbill {
namespace {

constexpr double frame_s = 1.0 / 60.0;

// A machine that takes the given times to draw a frame, one for each of the qualities.
struct Machine {
  std::array<double, 6> took_s;

  double at(FrameQuality quality) const { return took_s[static_cast<std::size_t>(quality)]; }
};

// Draws frames and returns how often the quality changed.
int changes(FrameBudget& budget, const Machine& machine, int frames) {
  int count = 0;
  for (int i = 0; i < frames; ++i) {
    const FrameQuality before = budget.quality();
    budget.add_frame(machine.at(before));
    count += budget.quality() != before ? 1 : 0;
  }
  return count;
}

constexpr Machine fast{{0.008, 0.007, 0.006, 0.005, 0.003, 0.002}};
constexpr Machine without_samples_in_time{{0.034, 0.032, 0.030, 0.014, 0.009, 0.006}};
constexpr Machine hopeless{{0.200, 0.190, 0.180, 0.150, 0.120, 0.100}};

TEST(FrameBudget, AFastMachineKeepsEverything) {
  FrameBudget budget(frame_s);
  EXPECT_EQ(changes(budget, fast, 600), 0);
  EXPECT_EQ(budget.quality(), FrameQuality::full);
  EXPECT_EQ(budget.text(), "");
}

TEST(FrameBudget, LateFramesCostOcclusionThenReflectionsThenSamples) {
  FrameBudget budget(frame_s);
  for (const FrameQuality quality :
       {FrameQuality::no_occlusion, FrameQuality::no_reflections, FrameQuality::no_samples}) {
    changes(budget, without_samples_in_time, 6);
    EXPECT_EQ(budget.quality(), quality);
  }
  EXPECT_EQ(changes(budget, without_samples_in_time, 36000), 0) << "and there it stays, without flicker";
  EXPECT_EQ(budget.text(), "drawing without occlusion, reflections and antialiasing to hold 60 Hz");
}

TEST(FrameBudget, AHopelessMachineEndsAtTheCoarsest) {
  FrameBudget budget(frame_s);
  EXPECT_EQ(changes(budget, hopeless, 600), 5);
  EXPECT_EQ(budget.text(), "drawing without occlusion, reflections, antialiasing, shadow and detail")
      << "without a claim that the rate is held";
  EXPECT_EQ(budget.quality(), FrameQuality::coarse);
  ViewSettings settings;
  budget.apply(settings);
  EXPECT_FALSE(settings.occlusion);
  EXPECT_FALSE(settings.reflections);
  EXPECT_EQ(settings.samples, 0);
  EXPECT_FALSE(settings.shadow);
  EXPECT_LT(settings.detail, 1.0);
  EXPECT_LT(settings.resolution, 1.0);
}

TEST(FrameBudget, ASingleStallChangesNothing) {
  FrameBudget budget(frame_s);
  for (int i = 0; i < 100; ++i) {
    budget.add_frame(0.5);
    EXPECT_EQ(changes(budget, fast, 20), 0);
  }
  EXPECT_EQ(budget.quality(), FrameQuality::full);
}

TEST(FrameBudget, QualityComesBackWhenThereIsRoom) {
  FrameBudget budget(frame_s);
  changes(budget, hopeless, 60);
  EXPECT_EQ(changes(budget, fast, 1000), 5);
  EXPECT_EQ(budget.quality(), FrameQuality::full);
}

// A frame without multisampling seems to leave enough time for multisampling, but a frame with multisampling
// takes too long. Attempts to raise the quality must become rarer.
TEST(FrameBudget, AMisjudgedRoomIsTriedLessAndLess) {
  FrameBudget budget(frame_s);
  const Machine misjudged{{0.030, 0.005, 0.005, 0.005, 0.004, 0.003}};
  const int first_minute = changes(budget, misjudged, 3600);
  int later_minute = 0;
  for (int minute = 0; minute < 10; ++minute) later_minute = changes(budget, misjudged, 3600);
  EXPECT_LE(first_minute, 13);
  EXPECT_LE(later_minute, 2);
}

TEST(FrameBudget, NoisyTimesAroundTheLimitDoNotFlicker) {
  FrameBudget budget(frame_s);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(0.7, 1.3);
  int count = 0;
  for (int i = 0; i < 3600; ++i) {
    const FrameQuality before = budget.quality();
    const double typical = before == FrameQuality::full ? frame_s : 0.6 * frame_s;
    budget.add_frame(typical * noise(random));
    count += budget.quality() != before ? 1 : 0;
  }
  EXPECT_LE(count, 3);
}

TEST(FrameBudget, WhatSomebodyChoseIsNeverRaised) {
  ViewSettings settings;
  settings.samples = 0;
  settings.shadow = false;
  settings.detail = 0.25;
  FrameBudget budget(frame_s);
  budget.apply(settings);
  EXPECT_EQ(settings.samples, 0);
  EXPECT_FALSE(settings.shadow);
  changes(budget, hopeless, 60);
  budget.apply(settings);
  EXPECT_EQ(settings.detail, 0.25);
}

TEST(FrameBudget, AFixedQualityStays) {
  for (const FrameQuality quality : {FrameQuality::full, FrameQuality::coarse}) {
    FrameBudget budget(frame_s, quality);
    EXPECT_EQ(changes(budget, hopeless, 60), 0);
    EXPECT_EQ(changes(budget, fast, 1000), 0);
    EXPECT_EQ(budget.quality(), quality);
  }
}

TEST(FrameBudget, ATimeThatIsNoNumberCountsAsLate) {
  FrameBudget budget(frame_s);
  for (int i = 0; i < 6; ++i) budget.add_frame(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(budget.quality(), FrameQuality::no_occlusion);
}

}  // namespace
}  // namespace spoonbill
