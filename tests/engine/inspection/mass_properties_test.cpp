#include "engine/inspection/mass_properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// Returns the solid of revolution about the y axis with r^2 = (h^2 - y^2)(1 + c y), where r is the radius at
// the height y. Its volume is 4/3 pi h^3, and its centre is at y = c h^2 / 5.
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

// The surfaces are fitted within 1e-7 m, which is less than 1e-5 of the radius.
TEST(EnclosedMass, HasVolumeAndMiddleOfAnEgg) {
  const double h = 0.03, c = 12.0;
  const EnclosedMass mass = compute_enclosed_mass(egg(h, c));
  EXPECT_NEAR(mass.volume_m3 / (4.0 / 3.0 * pi * h * h * h), 1.0, 2e-5);
  EXPECT_NEAR(mass.centre_m.y(), c * h * h / 5.0, 1e-6 * h);
  EXPECT_NEAR(mass.centre_m.x(), 0.0, 1e-6 * h);
  EXPECT_NEAR(mass.centre_m.z(), 0.0, 1e-6 * h);
}

TEST(EnclosedMass, MovesWithTheBody) {
  const Surface at_home = egg(0.03, 12.0);
  Pose pose;
  pose.position_m = Vector3(50.0, -20.0, 80.0);
  const EnclosedMass here = compute_enclosed_mass(at_home),
                     there = compute_enclosed_mass(placed(at_home, pose));
  // Coordinates of 80 m are accurate to 1e-14 m.
  EXPECT_NEAR(there.volume_m3 / here.volume_m3, 1.0, 1e-9);
  EXPECT_LT((there.centre_m - here.centre_m - pose.position_m).norm(), 1e-10);
  EXPECT_LT((there.area_centre_m - here.area_centre_m - pose.position_m).norm(), 1e-10);
}

// The area of a rectangle of 2 x 3 is exact at any degree.
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
    const EnclosedMass mass = compute_enclosed_mass(make_surface(knots, knots, net).value());
    EXPECT_NEAR(mass.area_m2, 6.0, 1e-12);
    EXPECT_LT((mass.area_centre_m - Vector3(1.0, 1.5, 1.0)).norm(), 1e-12);
  }
}

// The hole takes an eighth of a flat sheet, which the quadrature integrates exactly.
TEST(EnclosedMass, AreaOfWhatTrimsKeep) {
  const Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  const auto hole = polygon_loop(sheet.u, sheet.v, backwards(rectangle(0.25, 0.25, 0.5, 0.75)));
  const EnclosedMass mass = compute_enclosed_mass(sheet, TrimmedArea::make(sheet.u, sheet.v, {hole}).value());
  EXPECT_NEAR(mass.area_m2, 0.875 * 0.006, 1e-12);
  // The hole's centre is 0.0125 m to the left, so the centre of the remaining area is to the right.
  EXPECT_LT((mass.area_centre_m - Vector3(0.0125 * 0.125 / 0.875, 0.0, 0.0)).norm(), 1e-10);
  const auto round = round_loop(sheet.u, sheet.v, {0.5, 0.5}, 0.2, 16, true);
  const EnclosedMass rounded =
      compute_enclosed_mass(sheet, TrimmedArea::make(sheet.u, sheet.v, {round}).value());
  // The chords are within 1e-5 of the circle, in units of the domain. The circumference is 1.3 times as long
  // as the domain.
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
  // The kept part crosses the seam.
  const auto part = polygon_loop(tube.u, tube.v, rectangle(-0.25, 0.2, 0.25, 0.6));
  const EnclosedMass mass = compute_enclosed_mass(tube, TrimmedArea::make(tube.u, tube.v, {part}).value());
  // The fit is within 1e-7 m of a radius of 1e-2 m.
  EXPECT_NEAR(mass.area_m2 / (pi * r * 0.4 * length), 1.0, 2e-5);
}

TEST(EnclosedMass, IsBelowZeroInsideOut) {
  Surface inside_out = egg(0.03, 12.0);
  const double volume = compute_enclosed_mass(inside_out).volume_m3;
  for (double& x : inside_out.net.x) x = -x;
  EXPECT_NEAR(compute_enclosed_mass(inside_out).volume_m3, -volume, 1e-12 * volume);
}

// Compares the volume of a shell with the volume between two balls, and between two tori whose tube radii
// differ by the thickness.
TEST(ShellMass, IsWhatIsBetweenTwoSurfaces) {
  ShapeFit fit;
  fit.tolerance_m = 1e-7;
  const ShellMass ball = compute_shell_mass(fitted(sphere_shape(0.04), fit).surface, 0.005);
  const double between = 4.0 / 3.0 * pi * (std::pow(0.04, 3) - std::pow(0.035, 3));
  EXPECT_NEAR(ball.volume_m3 / between, 1.0, 1e-4);
  EXPECT_LT(ball.centre_m.norm(), 1e-6);
  const ShellMass ring = compute_shell_mass(fitted(torus_shape({0.04, 0.01}), fit).surface, 0.002);
  const double tubes = 2.0 * pi * pi * 0.04 * (0.01 * 0.01 - 0.008 * 0.008);
  EXPECT_NEAR(ring.volume_m3 / tubes, 1.0, 1e-4);
}

TEST(ShellMass, OfWhatTrimsKeep) {
  const Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  const auto hole = polygon_loop(sheet.u, sheet.v, backwards(rectangle(0.25, 0.25, 0.5, 0.75)));
  const TrimmedArea area = TrimmedArea::make(sheet.u, sheet.v, {hole}).value();
  EXPECT_NEAR(compute_shell_mass(sheet, 0.004, area).volume_m3, 0.875 * 0.006 * 0.004, 1e-12);
}

TEST(ShellMass, OfASheetLiesBelowIt) {
  const ShellMass sheet = compute_shell_mass(fitted(sheet_shape(0.1, 0.06)).surface, 0.004);
  EXPECT_NEAR(sheet.volume_m3, 0.1 * 0.06 * 0.004, 1e-12);
  EXPECT_LT((sheet.centre_m - Vector3(0.0, -0.002, 0.0)).norm(), 1e-9);
}

// Returns an upright cylinder, 60 mm high, with its centre at the origin. Its lower half is lighter.
Body weighted() {
  Body body;
  body.surface = fitted(cylinder_shape({0.01, 0.06, 0.001})).surface;
  body.material.name = "heavy";
  body.material.youngs_modulus_pa = 1e6;
  body.material.poissons_ratio = 0.3;
  body.material.density_kg_per_m3 = 3000.0;
  MaterialRegion lower;
  lower.region.along = {0.0, 0.5};
  lower.material = body.material;
  lower.material->name = "light";
  lower.material->density_kg_per_m3 = 1000.0;
  body.regions = {lower};
  return body;
}

TEST(MaterialMix, IsTheMeanOverTheBody) {
  const auto mix = compute_material_mix(weighted());
  ASSERT_TRUE(mix) << mix.error().message;
  // Each cell has a single material, so half of one layer out of about 20 may have the wrong one.
  EXPECT_NEAR(mix->density_kg_per_m3, 2000.0, 100.0);
  EXPECT_EQ(mix->materials, (std::vector<std::string>{"heavy", "light"}));
  // Three quarters of the mass are 15 mm above the centre, a quarter 15 mm below.
  EXPECT_NEAR(mix->mass_offset_m.y(), 0.0075, 0.0008);
  EXPECT_NEAR(mix->mass_offset_m.x(), 0.0, 1e-5);
  EXPECT_NEAR(mix->mass_offset_m.z(), 0.0, 1e-5);
}

TEST(MaterialMix, RefusesWhatHasNoLattice) {
  Body body = weighted();
  for (double& y : body.surface.net.y) y = -y;  // turns the surface inside out
  EXPECT_FALSE(compute_material_mix(body));
}

}  // namespace
}  // namespace spoonbill
