#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/reparameterise.h"
#include "engine/merging/compatible_patches.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

double shortest_piece(const KnotVector& knots) {
  const std::vector<double> ends = knots.breakpoints();
  double shortest = ends.back() - ends.front();
  for (std::size_t k = 1; k < ends.size(); ++k) shortest = std::min(shortest, ends[k] - ends[k - 1]);
  return shortest / (ends.back() - ends.front());
}

// Returns the surface with each coordinate of its control points moved by at most `noise_m`.
Surface with_noise(Surface surface, Random& random, double noise_m) {
  for (std::size_t k = 0; k < surface.net.size(); ++k) {
    surface.net.x[k] += random.uniform(-noise_m, noise_m);
    surface.net.y[k] += random.uniform(-noise_m, noise_m);
    surface.net.z[k] += random.uniform(-noise_m, noise_m);
  }
  return surface;
}

TEST(NearlySameKnots, ASplitPipeWithNoiseGetsNoSlivers) {
  Random random(91);
  for (const double noise_m : {1e-12, 1e-9, 1e-8}) {
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Surface whole = random_surface(random, KnotVector::periodic_uniform(3, 11).value(),
                                           KnotVector::clamped_uniform(3, 8).value());
      std::vector<Surface> parts{part_of(whole, Direction::v, 0.0, 0.4).value(),
                                 part_of(whole, Direction::v, 0.4, 1.0).value()};
      const int first = random.integer(0, 10);
      parts[1] = with_noise(with_seam_at(parts[1], Direction::u, first / 11.0).value(), random, noise_m);
      const auto merged = merge(parts, request_of(2));
      ASSERT_TRUE(merged.ok()) << merged.error().message;
      EXPECT_EQ(merged->surface.u.control_point_count(), 11) << noise_m;
      EXPECT_GT(shortest_piece(merged->surface.u), 0.05);
    }
  }
}

TEST(NearlySameKnots, RoundedKnotsBecomeThoseOfTheFirstPatch) {
  const Surface low = sheet_between([](double) { return 0.0; }, [](double) { return 0.04; });
  Surface high = sheet_between([](double) { return 0.04; }, [](double) { return 0.08; });
  std::vector<double> rounded = high.u.knots();
  for (double& knot : rounded) knot = std::round(1e7 * knot) / 1e7;
  high.u = KnotVector::open(3, rounded).value();
  const auto merged = merge({low, high}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_EQ(merged->surface.u, low.u);
  // The deviation that snapping causes is reported.
  EXPECT_GT(merged->deviation_m, 1e-11);
  EXPECT_LT(merged->deviation_m, 1e-8);
}

TEST(NearlySameKnots, KnotsThatAreOneAlreadyStay) {
  const auto of = [](double second) {
    const auto u = KnotVector::open(2, {0, 0, 0, 0.5, second, 1, 1, 1}).value();
    Random random(5);
    return random_surface(random, u, KnotVector::clamped_uniform(2, 4).value());
  };
  const Surface close = of(0.5 + 1e-6);
  const SnappedKnots same = snap_knots(close, of(0.7).u, 1.0);
  EXPECT_EQ(same.surface.u, close.u);
  EXPECT_EQ(same.deviation_m, 0.0);
  // The knot 0.7 is snapped to 0.7 + 1e-6 only if the resulting deviation is allowed.
  const Surface other = of(0.7);
  const auto wanted = KnotVector::open(2, {0, 0, 0, 0.5, 0.7 + 1e-6, 1, 1, 1}).value();
  EXPECT_EQ(snap_knots(other, wanted, 1.0).surface.u, wanted);
  EXPECT_EQ(snap_knots(other, wanted, 1e-12).surface.u, other.u);
}

}  // namespace
}  // namespace spoonbill
