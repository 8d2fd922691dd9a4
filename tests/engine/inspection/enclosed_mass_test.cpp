#include "engine/inspection/enclosed_mass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

// r^2 = (h^2 - z^2)(1 + c z) about the y axis, which holds 4/3 pi h^3 with its middle c h^2 / 5 up.
Surface egg(double h, double c) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [=](double u, double v) {
    const double height = -h * std::cos(pi * v);
    const double radius = v <= 0.0 || v >= 1.0 ? 0.0 : h * std::sin(pi * v) * std::sqrt(1.0 + c * height);
    return Vector3(radius * std::cos(2.0 * pi * u), height, -radius * std::sin(2.0 * pi * u));
  };
  ShapeFit fit;
  fit.tolerance_m = 1e-7;
  return fitted(Result<ExactShape>(shape), fit).surface;
}

// Surfaces within 1e-7 m: 1e-5 of the radius.
TEST(EnclosedMass, HasVolumeAndMiddleOfAnEgg) {
  const double h = 0.03, c = 12.0;
  const EnclosedMass mass = enclosed_mass(egg(h, c));
  EXPECT_NEAR(mass.volume_m3 / (4.0 / 3.0 * pi * h * h * h), 1.0, 2e-5);
  EXPECT_NEAR(mass.middle_m.y(), c * h * h / 5.0, 1e-6 * h);
  EXPECT_NEAR(mass.middle_m.x(), 0.0, 1e-6 * h);
  EXPECT_NEAR(mass.middle_m.z(), 0.0, 1e-6 * h);
}

TEST(EnclosedMass, MovesWithTheBody) {
  const Surface at_home = egg(0.03, 12.0);
  Pose pose;
  pose.position_m = Vector3(50.0, -20.0, 80.0);
  const EnclosedMass here = enclosed_mass(at_home), there = enclosed_mass(placed(at_home, pose));
  // Coordinates of 80 m keep 1e-14 m.
  EXPECT_NEAR(there.volume_m3 / here.volume_m3, 1.0, 1e-9);
  EXPECT_LT((there.middle_m - here.middle_m - pose.position_m).norm(), 1e-10);
  EXPECT_LT((there.area_middle_m - here.area_middle_m - pose.position_m).norm(), 1e-10);
}

// A rectangle of 2 x 3: exact at any degree, its middle the rectangle's.
TEST(EnclosedMass, AreaOfASheet) {
  for (int degree = 1; degree <= 9; ++degree) {
    const KnotVector knots = KnotVector::clamped_uniform(degree, degree + 4).value();
    ControlNet net(degree + 4, degree + 4);
    const auto mean_knot = [&](int i) {
      double sum = 0.0;
      for (int k = 1; k <= degree; ++k) sum += knots.knots()[static_cast<std::size_t>(i + k)];
      return sum / degree;
    };
    for (int i = 0; i < net.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        net.set_point(i, j, Vector3(2.0 * mean_knot(i), 3.0 * mean_knot(j), 1.0));
      }
    }
    const EnclosedMass mass = enclosed_mass(make_surface(knots, knots, net).value());
    EXPECT_NEAR(mass.area_m2, 6.0, 1e-12);
    EXPECT_LT((mass.area_middle_m - Vector3(1.0, 1.5, 1.0)).norm(), 1e-12);
  }
}

// A hole of an eighth in a flat sheet, which the quadrature takes exactly.
TEST(EnclosedMass, AreaOfWhatTrimsKeep) {
  const Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  const auto hole = polygon_loop(sheet.u, sheet.v, backwards(rectangle(0.25, 0.25, 0.5, 0.75)));
  const EnclosedMass mass = enclosed_mass(sheet, TrimmedArea::make(sheet.u, sheet.v, {hole}).value());
  EXPECT_NEAR(mass.area_m2, 0.875 * 0.006, 1e-12);
  // The hole's middle is an eighth of 0.1 m to the left.
  EXPECT_LT((mass.area_middle_m - Vector3(0.0125 * 0.125 / 0.875, 0.0, 0.0)).norm(), 1e-10);
  const auto round = round_loop(sheet.u, sheet.v, {0.5, 0.5}, 0.2, 16, true);
  const EnclosedMass rounded = enclosed_mass(sheet, TrimmedArea::make(sheet.u, sheet.v, {round}).value());
  // Chords within 1e-5 of the domain, over a circumference of 1.3 of it.
  EXPECT_NEAR(rounded.area_m2 / 0.006, 1.0 - round_loop_area(0.2, 16), 2e-5);
}

TEST(EnclosedMass, AreaOfAPartOfATube) {
  constexpr double r = 0.01, length = 0.05;
  ExactShape shape;
  shape.u.periodic = true;
  shape.at = [](double u, double v) {
    return Vector3(r * std::cos(2.0 * pi * u), length * v, -r * std::sin(2.0 * pi * u));
  };
  ShapeFit fit;
  fit.tolerance_m = 1e-7;
  fit.keeps_parameters = true;
  const Surface tube = fitted(Result<ExactShape>(shape), fit).surface;
  // Across the seam.
  const auto part = polygon_loop(tube.u, tube.v, rectangle(-0.25, 0.2, 0.25, 0.6));
  const EnclosedMass mass = enclosed_mass(tube, TrimmedArea::make(tube.u, tube.v, {part}).value());
  EXPECT_NEAR(mass.area_m2 / (pi * r * 0.4 * length), 1.0, 2e-5);  // 1e-7 of 1e-2
}

TEST(EnclosedMass, IsBelowZeroInsideOut) {
  Surface inside_out = egg(0.03, 12.0);
  const double volume = enclosed_mass(inside_out).volume_m3;
  for (double& x : inside_out.net.x) x = -x;
  EXPECT_NEAR(enclosed_mass(inside_out).volume_m3, -volume, 1e-12 * volume);
}

}  // namespace
}  // namespace spoonbill
