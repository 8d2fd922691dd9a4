#include "engine/base/progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace spoonbill {
namespace {

TEST(Progress, GoesOnWhereNobodyWatches) {
  const Progress nobody;
  EXPECT_FALSE(nobody.is_watched());
  EXPECT_TRUE(nobody.report(0.5));
  EXPECT_TRUE(nobody.part(0.0, 0.5).report(1.0));
}

TEST(Progress, PartsOfPartsAreReportedAsFractionsOfTheWhole) {
  std::vector<double> seen;
  const Progress whole([&](double fraction) {
    seen.push_back(fraction);
    return true;
  });
  const Progress second_half = whole.part(0.5, 1.0);
  second_half.report(0.0);
  second_half.part(0.0, 0.5).report(0.5);
  second_half.part(0.5, 0.5).report(1.0);
  second_half.report(1.0);
  EXPECT_EQ(seen, (std::vector<double>{0.5, 0.625, 0.75, 1.0}));
}

TEST(Progress, TheWatcherOfTheWholeStopsAPart) {
  const Progress whole([](double fraction) { return fraction < 0.75; });
  EXPECT_TRUE(whole.part(0.5, 1.0).report(0.25));
  EXPECT_FALSE(whole.part(0.5, 1.0).report(0.5));
}

TEST(Progress, RoundsNeverReachTheEnd) {
  RoundsDone rounds(0.5);
  EXPECT_EQ(rounds.fraction(), 0.0);
  rounds.step();
  EXPECT_EQ(rounds.fraction(), 0.5);
  rounds.step();
  EXPECT_EQ(rounds.fraction(), 0.75);
}

}  // namespace
}  // namespace spoonbill
