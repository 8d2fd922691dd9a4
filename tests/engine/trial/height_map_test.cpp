// Tests the heights of a surface seen from above, and the water that it holds.
#include "engine/trial/height_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

TEST(HeightMap, HasTheHeightsOfABall) {
  const double radius_m = 0.01;
  const HeightMap map(stock_surface(SphereSize{radius_m}, {0.05, 0.02, -0.03}), Vector3::UnitY(), 1e-4);
  int cells = 0;
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      const HeightMap::Cell& cell = map.cell(row, column);
      if (cell.height_m == -infinity) continue;
      const Vector3 point = map.point(row, column);
      EXPECT_DOUBLE_EQ(point.y(), cell.height_m);
      const double away_m = std::hypot(point.x() - 0.05, point.z() + 0.03);
      // Beyond, the ball is steep, and a cell has heights that differ by more than a tenth of a millimetre.
      if (away_m > 0.7 * radius_m) continue;
      EXPECT_NEAR(cell.height_m, 0.02 + std::sqrt(radius_m * radius_m - away_m * away_m), 1.5e-4);
      ++cells;
    }
  }
  EXPECT_NEAR(cells, 3.1416 * 70 * 70, 300.0);
  EXPECT_EQ(map.cell_at(map.plan({0.2, 0.0, 0.0})).height_m, -infinity);
  EXPECT_EQ(map.cell(-1, 0).height_m, -infinity);
}

TEST(HeightMap, HoldsTheWaterOfABowlAndNotOfARing) {
  const auto deepest_m = [](const Surface& surface) {
    const std::vector<double> depths = find_water_depths_m(HeightMap(surface, Vector3::UnitY(), 2e-4));
    return *std::max_element(depths.begin(), depths.end());
  };
  EXPECT_NEAR(deepest_m(stock_surface(BowlSize{0.06, 0.04, 0.01, 0.001})), 0.01, 2e-4);
  EXPECT_LT(deepest_m(stock_surface(TorusSize{0.03, 0.01})), 1e-4);
  EXPECT_LT(deepest_m(stock_surface(SphereSize{0.01})), 1e-4);
}

}  // namespace
}  // namespace spoonbill
