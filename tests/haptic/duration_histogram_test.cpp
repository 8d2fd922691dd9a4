#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "haptic/haptic_loop.h"

namespace spoonbill {
namespace {

TEST(DurationHistogram, IsZeroWhileEmpty) {
  const DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile_s(0.5), 0.0);
  EXPECT_EQ(histogram.mean_s(), 0.0);
  EXPECT_EQ(histogram.count(), 0u);
}

TEST(DurationHistogram, AgreesWithSortingToASixteenth) {
  std::mt19937_64 random(4);
  std::vector<double> durations_s;
  DurationHistogram histogram;
  for (int k = 0; k < 20'000; ++k) {
    const auto duration_ns = static_cast<std::int64_t>(random() >> (20 + random() % 44));
    histogram.add(duration_ns);
    durations_s.push_back(1e-9 * static_cast<double>(duration_ns));
  }
  std::sort(durations_s.begin(), durations_s.end());
  for (const double share : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(durations_s.size()) + 0.5);
    const double expected = durations_s[rank - 1];
    EXPECT_NEAR(histogram.quantile_s(share), expected, expected / 16.0) << share;
  }
}

TEST(DurationHistogram, TakesTheShortestAndTheLongest) {
  DurationHistogram histogram;
  histogram.add(-5);
  histogram.add(0);
  EXPECT_EQ(histogram.quantile_s(1.0), 0.0);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_NEAR(histogram.quantile_s(1.0) / 9.223372036854775807e9, 1.0, 1.0 / 16.0);
  EXPECT_EQ(histogram.count(), 3u);
}

TEST(DurationHistogram, MeanIsThatOfTheNumbersThemselves) {
  DurationHistogram histogram;
  for (const std::int64_t duration_ns : {1'000'003, 2'000'001, 6'000'005}) histogram.add(duration_ns);
  EXPECT_NEAR(histogram.mean_s(), 3.000003e-3, 1e-12);
}

}  // namespace
}  // namespace spoonbill
