#include "engine/inspection/shell_mass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

// What is between two balls, and between two tori, whose tube is thinner by the shell.
TEST(ShellMass, IsWhatIsBetweenTwoSurfaces) {
  ShapeFit fit;
  fit.tolerance_m = 1e-7;
  const ShellMass ball = shell_mass(fitted(sphere_shape(0.04), fit).surface, 0.005);
  const double between = 4.0 / 3.0 * pi * (std::pow(0.04, 3) - std::pow(0.035, 3));
  EXPECT_NEAR(ball.volume_m3 / between, 1.0, 1e-4);
  EXPECT_LT(ball.middle_m.norm(), 1e-6);
  const ShellMass ring = shell_mass(fitted(torus_shape({0.04, 0.01}), fit).surface, 0.002);
  const double tubes = 2.0 * pi * pi * 0.04 * (0.01 * 0.01 - 0.008 * 0.008);
  EXPECT_NEAR(ring.volume_m3 / tubes, 1.0, 1e-4);
}

TEST(ShellMass, OfWhatTrimsKeep) {
  const Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  const auto hole = polygon_loop(sheet.u, sheet.v, backwards(rectangle(0.25, 0.25, 0.5, 0.75)));
  const TrimmedArea area = TrimmedArea::make(sheet.u, sheet.v, {hole}).value();
  EXPECT_NEAR(shell_mass(sheet, 0.004, area).volume_m3, 0.875 * 0.006 * 0.004, 1e-12);
}

TEST(ShellMass, OfASheetLiesBelowIt) {
  const ShellMass sheet = shell_mass(fitted(sheet_shape(0.1, 0.06)).surface, 0.004);
  EXPECT_NEAR(sheet.volume_m3, 0.1 * 0.06 * 0.004, 1e-12);
  EXPECT_LT((sheet.middle_m - Vector3(0.0, -0.002, 0.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace spoonbill
