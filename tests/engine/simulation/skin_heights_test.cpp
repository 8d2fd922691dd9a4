// Tests the heights of a surface above a plane against dense sampling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/bspline/evaluate.h"
#include "engine/simulation/ground_contact.h"
#include "tests/engine/allocations.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

double densely_lowest(const Surface& surface, const Vector3& normal) {
  constexpr int count = 400;
  const auto at = [](const KnotVector& knots, int k) {
    return knots.domain_start() + (knots.domain_end() - knots.domain_start()) * k / count;
  };
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= count; ++i) {
    for (int j = 0; j <= count; ++j) {
      lowest = std::min(lowest, normal.dot(position(surface, at(surface.u, i), at(surface.v, j))));
    }
  }
  return lowest;
}

// Depending on the direction, the lowest point is on a side, at an edge, or at an inclined end, where
// elements are long and hardly curved. The tolerance is that of ground contact, a hundredth of a cell.
TEST(SkinHeights, FindTheLowestPlaceBetweenTheSamples) {
  const Surface handle = small_handle().bodies[0].surface;
  const double allowed_m = 0.01 * 2.1e-3;
  SkinHeights heights = SkinHeights::make(handle.u, handle.v).value();
  for (const Vector3& way : {Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(0.3, 1, 0.2), Vector3(-1, 0.4, 0.1),
                             Vector3(0.02, -1, 0.5)}) {
    const Vector3 normal = way.normalized();
    const std::size_t before = allocation_count();
    ASSERT_TRUE(heights.compute(handle, Vector3::Zero(), normal, 1.0));
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < heights.rows(); ++i) {
      for (int j = 0; j < heights.columns(); ++j) lowest = std::min(lowest, heights.lowest_m(i, j));
    }
    EXPECT_EQ(allocation_count(), before);
    EXPECT_NEAR(lowest, densely_lowest(handle, normal), allowed_m) << normal.transpose();
  }
}

TEST(SkinHeights, LeaveOutWhatIsOutOfReach) {
  const Surface handle = small_handle().bodies[0].surface;
  SkinHeights heights = SkinHeights::make(handle.u, handle.v).value();
  EXPECT_FALSE(heights.compute(handle, Vector3(0, -0.01, 0), Vector3::UnitY(), 0.005));
  EXPECT_TRUE(heights.compute(handle, Vector3(0, -0.01, 0), Vector3::UnitY(), 0.008));
  const double lowest = densely_lowest(handle, Vector3::UnitY()) + 0.01;
  double found = std::numeric_limits<double>::infinity();
  int left_out = 0;
  for (int i = 0; i < heights.rows(); ++i) {
    found = std::min(found, heights.lowest_m(i, heights.columns() / 2));
    left_out += std::isinf(heights.lowest_m(i, heights.columns() / 2)) ? 1 : 0;
  }
  EXPECT_NEAR(found, lowest, 2e-6);
  EXPECT_GT(left_out, heights.rows() / 3);
}

}  // namespace
}  // namespace spoonbill
