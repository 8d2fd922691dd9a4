#include "engine/bspline/trimmed_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "loops.h"
#include "tests/engine/allocations.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

TrimmedArea area_of(const KnotVector& u, const KnotVector& v, const std::vector<TrimLoop>& loops) {
  auto area = TrimmedArea::make(u, v, loops);
  EXPECT_TRUE(area.ok()) << (area ? "" : area.error().message);
  return std::move(area).value();
}

// Returns the fraction of a fine grid's cells whose centres are kept.
double counted_share(const TrimmedArea& area, const KnotVector& u, const KnotVector& v, int count) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      kept += area.contains(u.domain_start() + (u.domain_end() - u.domain_start()) * (i + 0.5) / count,
                            v.domain_start() + (v.domain_end() - v.domain_start()) * (j + 0.5) / count);
    }
  }
  return static_cast<double>(kept) / count / count;
}

TEST(TrimmedArea, WithoutLoopsIsAllOfTheDomain) {
  const TrimmedArea area = area_of(open_u, open_v, {});
  EXPECT_TRUE(area.is_whole());
  EXPECT_TRUE(area.contains(0.3, 0.3));
  EXPECT_EQ(area.remaining_fraction(), 1.0);
}

TEST(TrimmedArea, AnOuterLoopKeepsWhatIsInsideAndAHoleWhatIsOutside) {
  const TrimLoop outer = polygon_loop(open_u, open_v, rectangle(0.2, -0.8, 1.8, 0.8));
  const TrimLoop hole = polygon_loop(open_u, open_v, backwards(rectangle(0.5, -0.5, 1.0, 0.0)));
  const TrimLoop island = polygon_loop(open_u, open_v, rectangle(0.6, -0.4, 0.7, -0.3));
  // The order of the loops has no effect.
  for (const auto& loops : {std::vector{outer, hole, island}, std::vector{island, hole, outer}}) {
    const TrimmedArea area = area_of(open_u, open_v, loops);
    EXPECT_FALSE(area.contains(0.1, 0.0));
    EXPECT_TRUE(area.contains(0.3, 0.0));
    EXPECT_FALSE(area.contains(0.55, -0.45));
    EXPECT_TRUE(area.contains(0.65, -0.35));
    EXPECT_FALSE(area.contains(1.9, 0.9));
    EXPECT_NEAR(area.remaining_fraction(), (1.6 * 1.6 - 0.25 + 0.01) / 4.0, 1e-14);
  }
  const TrimmedArea pierced = area_of(open_u, open_v, {hole});
  EXPECT_TRUE(pierced.contains(0.1, 0.0));
  EXPECT_FALSE(pierced.contains(0.65, -0.35));
  EXPECT_NEAR(pierced.remaining_fraction(), 1.0 - 0.25 / 4.0, 1e-14);
}

TEST(TrimmedArea, OfCurvesIsTheirClosedForm) {
  const TrimLoop outer = round_loop(open_u, open_v, {1.0, 0.0}, 0.95, 11, false);
  const TrimLoop hole = round_loop(open_u, open_v, {1.2, 0.1}, 0.3, 5, true);
  const TrimmedArea area = area_of(open_u, open_v, {outer, hole});
  const double share = (round_loop_area(0.95, 11) - round_loop_area(0.3, 5)) / 4.0;
  // Together, the curves are shorter than 8, and their chords deviate by at most 2e-5. The 1000 x 1000 grid
  // is wrong only in cells along the curves, where errors mostly cancel.
  EXPECT_NEAR(area.remaining_fraction(), share, 8.0 * 2e-5 / 4.0);
  EXPECT_NEAR(counted_share(area, open_u, open_v, 1000), share, 1e-4);
}

TEST(TrimmedArea, TheEndsOfTheDomainBelongToWhatLiesBesideThem) {
  const TrimmedArea whole = area_of(open_u, open_v, {polygon_loop(open_u, open_v, rectangle(0, -1, 2, 1))});
  EXPECT_EQ(whole.remaining_fraction(), 1.0);
  for (const double u : {-5.0, 0.0, 0.7, 2.0, 7.0}) {
    for (const double v : {-1.0, 0.2, 1.0}) EXPECT_TRUE(whole.contains(u, v)) << u << " " << v;
  }
  const TrimmedArea half = area_of(open_u, open_v, {polygon_loop(open_u, open_v, rectangle(0, -1, 1, 1))});
  EXPECT_TRUE(half.contains(0.0, 1.0));
  EXPECT_FALSE(half.contains(2.0, 1.0));
}

TEST(TrimmedArea, AHoleAcrossTheSeamIsOneHole) {
  for (const double middle : {0.0, 0.06, 0.94, 1.0, 1.06}) {
    const TrimLoop hole = round_loop(periodic_u, open_v, {middle, 0.0}, 0.1, 8, true);
    const TrimmedArea area = area_of(periodic_u, open_v, {hole});
    for (const double offset : {-0.05, 0.0, 0.05}) {
      for (const double turns : {-1.0, 0.0, 1.0}) {
        EXPECT_FALSE(area.contains(middle + offset + turns, 0.01)) << middle << " " << offset;
      }
    }
    EXPECT_TRUE(area.contains(middle + 0.12, 0.0));
    EXPECT_TRUE(area.contains(middle - 0.12, 0.0));
    EXPECT_NEAR(counted_share(area, periodic_u, open_v, 1000), 1.0 - round_loop_area(0.1, 8) / 2.0, 1e-4);
  }
}

TEST(TrimmedArea, ALoopOfOnePeriodKeepsABandWithoutAGap) {
  for (const double start : {-0.7, 0.0, 0.3}) {
    // Rounding at the seam must neither open the band nor turn it into a hole.
    for (const double rounding : {-1e-8, 0.0, 1e-8}) {
      const TrimLoop band =
          polygon_loop(periodic_u, open_v, rectangle(start, -0.5, start + 1.0 + rounding, 0.25));
      const TrimmedArea area = area_of(periodic_u, open_v, {band});
      EXPECT_NEAR(area.remaining_fraction(), 0.75 / 2.0, 1e-7);
      EXPECT_EQ(counted_share(area, periodic_u, open_v, 200), 0.375);
    }
  }
}

TEST(TrimmedArea, OnATorusLoopsCrossBothSeams) {
  const TrimLoop hole = polygon_loop(periodic_u, periodic_u, backwards(rectangle(0.9, -0.2, 1.1, 0.1)));
  const TrimmedArea area = area_of(periodic_u, periodic_u, {hole});
  EXPECT_FALSE(area.contains(0.05, 0.05));
  EXPECT_FALSE(area.contains(0.95, 0.05));
  EXPECT_FALSE(area.contains(0.95, 0.85));
  EXPECT_FALSE(area.contains(0.05, 0.85));
  EXPECT_TRUE(area.contains(0.5, 0.05));
  EXPECT_NEAR(counted_share(area, periodic_u, periodic_u, 200), 1.0 - 0.06, 1e-12);
}

TEST(TrimmedArea, RefusesLoopsThatContradictEachOther) {
  const TrimLoop outer = polygon_loop(open_u, open_v, rectangle(0.2, -0.8, 1.8, 0.8));
  const TrimLoop inner = polygon_loop(open_u, open_v, rectangle(0.5, -0.5, 1.0, 0.0));
  const auto twice = TrimmedArea::make(open_u, open_v, {outer, inner});
  ASSERT_FALSE(twice.ok());
  EXPECT_EQ(twice.error().code, ErrorCode::inconsistent) << twice.error().message;
  const TrimLoop across = polygon_loop(open_u, open_v, backwards(rectangle(1.5, -0.5, 1.9, 0.0)));
  const auto crossing = TrimmedArea::make(open_u, open_v, {outer, across});
  ASSERT_FALSE(crossing.ok());
  EXPECT_EQ(crossing.error().code, ErrorCode::self_intersecting) << crossing.error().message;
  const TrimLoop nothing = polygon_loop(open_u, open_v, backwards(rectangle(0, -1, 2, 1)));
  EXPECT_FALSE(TrimmedArea::make(open_u, open_v, {nothing}).ok());
  const TrimLoop hole = polygon_loop(open_u, open_v, backwards(rectangle(0.5, -0.5, 1.0, 0.0)));
  const TrimLoop whole = polygon_loop(open_u, open_v, rectangle(0, -1, 2, 1));
  for (const TrimLoop& loop : {outer, hole, whole}) {
    const auto doubled = TrimmedArea::make(open_u, open_v, {loop, loop});
    ASSERT_FALSE(doubled.ok());
    EXPECT_EQ(doubled.error().code, ErrorCode::duplicate) << doubled.error().message;
  }
  // Two outer loops that share an edge are accepted.
  const auto halves = TrimmedArea::make(open_u, open_v,
                                        {polygon_loop(open_u, open_v, rectangle(0, -1, 1, 1)),
                                         polygon_loop(open_u, open_v, rectangle(1, -1, 2, 1))});
  ASSERT_TRUE(halves.ok()) << halves.error().message;
  EXPECT_NEAR(halves->remaining_fraction(), 1.0, 1e-14);
}

TEST(TrimmedArea, AsksWithoutAllocating) {
  const TrimmedArea area = area_of(open_u, open_v, {round_loop(open_u, open_v, {1, 0}, 0.9, 9, false)});
  const auto before = allocation_count();
  bool kept = false;
  for (int i = 0; i < 100; ++i) kept ^= area.contains(0.02 * i, 0.1);
  EXPECT_EQ(allocation_count(), before) << kept;
}

}  // namespace
}  // namespace spoonbill
