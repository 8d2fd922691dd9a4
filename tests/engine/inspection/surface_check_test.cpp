#include "engine/inspection/surface_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/effort.h"
#include "tests/engine/shapes/body_measures.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

using Vector2 = Eigen::Vector2d;

using std::numbers::pi;

bool is_clean(const SurfaceCheck& check) {
  return check.surface_defects.empty() && check.self_intersections.empty() &&
         check.self_intersections_complete;
}

TEST(SurfaceCheck, StartingShapesAreSound) {
  for (const auto& shape : {sphere_shape(0.03), box_shape({{0.06, 0.04, 0.02}, 0.003}),
                            cylinder_shape({0.02, 0.06, 0.004}), cone_shape({0.03, 0.05, 0.0, 0.004}),
                            plate_shape({0.1, 0.06, 0.004, 0.01}), torus_shape({0.04, 0.01})}) {
    const SurfaceCheck check = *check_surface(fitted(shape).surface);
    EXPECT_EQ(check.closing.closedness, Closedness::solid);
    EXPECT_EQ(check.closing.gap_m, 0.0);
    EXPECT_GT(check.mass.volume_m3, 0.0);
    EXPECT_TRUE(is_clean(check));
    EXPECT_TRUE(check.thinnest.has_value());
  }
}

ExactShape open_tube(double radius, double length) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.at = [=](double u, double v) {
    return Vector3(radius * std::cos(2.0 * pi * u), length * v, -radius * std::sin(2.0 * pi * u));
  };
  return shape;
}

TEST(SurfaceCheck, TellsHowFarATubeIsOpen) {
  const SurfaceCheck check = *check_surface(fitted(Result<ExactShape>(open_tube(0.01, 0.05))).surface);
  EXPECT_EQ(check.closing.closedness, Closedness::tube);
  EXPECT_NEAR(check.closing.gap_m, 0.02, 2e-5);
  EXPECT_FALSE(check.thinnest.has_value());
  EXPECT_TRUE(is_clean(check));
  EXPECT_NEAR(check.mass.area_m2, 2.0 * pi * 0.01 * 0.05, 1e-6);
}

TEST(SurfaceCheck, ASheetIsOpenBothWays) {
  const SurfaceCheck check = *check_surface(fitted(sheet_shape(0.1, 0.06)).surface);
  EXPECT_EQ(check.closing.closedness, Closedness::sheet);
  EXPECT_TRUE(is_clean(check));
}

// The surface is not periodic here. It counts as a closed tube if its edges coincide, and as open if they are
// 1 mm apart.
TEST(SurfaceCheck, EdgesThatMeetCloseATube) {
  for (const double apart : {0.0, 1e-3}) {
    ExactShape shape = open_tube(0.01, 0.05);
    const auto closed = shape.at;
    shape.u.periodic = false;
    shape.at = [=](double u, double v) { return Vector3(closed(u, v) + Vector3(0.0, 0.0, apart * u)); };
    const SurfaceCheck check = *check_surface(fitted(Result<ExactShape>(shape)).surface);
    EXPECT_EQ(check.closing.closedness, apart > 0.0 ? Closedness::sheet : Closedness::tube);
    // The fit's tolerance is 1e-5 m, and its error at the ends is smaller.
    EXPECT_NEAR(check.closing.u.apart_m, apart, 1e-6);
  }
}

// The tube follows a loop and passes through itself.
TEST(SurfaceCheck, FindsWhereATubePassesThroughItself) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.at = [](double u, double v) {
    // The tube follows a circle of 30 mm radius for more than a turn and rises by half its width, so that its
    // ends overlap.
    const double turn = 2.2 * pi * v, around = 2.0 * pi * u;
    const Vector3 outward(std::cos(turn), 0.0, std::sin(turn));
    return Vector3((0.03 + 0.006 * std::cos(around)) * outward +
                   Vector3(0.0, 0.006 * std::sin(around) + 0.006 * v, 0.0));
  };
  const SurfaceCheck check = *check_surface(fitted(Result<ExactShape>(shape)).surface);
  ASSERT_FALSE(check.self_intersections.empty());
  const SelfIntersection& meeting = check.self_intersections[0];
  // One of the two intersecting parts is near the start of the loop, the other near its end.
  EXPECT_LT(std::min(meeting.v, meeting.other_v), 0.15);
  EXPECT_GT(std::max(meeting.v, meeting.other_v), 0.85);
}

TEST(SurfaceCheck, FindsAFold) {
  Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  // Moves one control point past its neighbours.
  Vector3 point = sheet.net.point(7, 7);
  point.x() += 0.05;
  sheet.net.set_point(7, 7, point);
  const SurfaceCheck check = *check_surface(sheet);
  ASSERT_FALSE(check.surface_defects.empty());
  EXPECT_TRUE(check.surface_defects[0].folds);
  EXPECT_NEAR(check.surface_defects[0].u, 0.55, 0.2);
}

TEST(SurfaceCheck, FindsWhereASurfaceShrinksToALine) {
  Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  for (int i = 0; i < sheet.net.rows; ++i) {
    for (int j = 6; j < 10; ++j) sheet.net.set_point(i, j, sheet.net.point(i, 6));
  }
  const SurfaceCheck check = *check_surface(sheet);
  ASSERT_FALSE(check.surface_defects.empty());
  EXPECT_FALSE(check.surface_defects[0].folds);
}

// Returns a surface of revolution about y from pole to pole, through rings of these radii and heights, in
// even spans.
Surface turned(const std::vector<Vector2>& rings) {
  const int columns = static_cast<int>(rings.size());
  ControlNet net(12, columns);
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * pi * i / 12.0;
    for (int j = 0; j < columns; ++j) {
      const Vector2& ring = rings[static_cast<std::size_t>(j)];
      net.set_point(i, j, {ring.x() * std::cos(angle), ring.y(), -ring.x() * std::sin(angle)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, 12).value(),
                      KnotVector::clamped_uniform(3, columns).value(), net)
      .value();
}

// The normal turns by more than a right angle within a quarter of a span without a fold.
TEST(SurfaceCheck, ATightRimIsNoFold) {
  for (const double thickness : {5e-4, 1e-4}) {
    const double half = 0.5 * thickness;
    const SurfaceCheck check = *check_surface(turned({{0.0, -half},
                                                      {0.005, -half},
                                                      {0.01, -half},
                                                      {0.02, -half},
                                                      {0.02, half},
                                                      {0.01, half},
                                                      {0.005, half},
                                                      {0.0, half}}));
    EXPECT_EQ(check.closing.closedness, Closedness::solid);
    EXPECT_GT(check.mass.volume_m3, 0.0);
    EXPECT_TRUE(check.surface_defects.empty()) << thickness;
  }
}

// The sheet is folded where x was `shift`. With one of the two values, the fold is halfway between two
// sampled points.
TEST(SurfaceCheck, ASheetFoldedFlatOverIsFound) {
  for (const double shift : {0.0, 0.003}) {
    Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
    const int rows = sheet.net.rows;
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < sheet.net.columns; ++j) {
        Vector3 point = sheet.net.point(i, j);
        point.x() = std::abs(point.x() - shift);
        sheet.net.set_point(i, j, point);
      }
    }
    const SurfaceCheck check = *check_surface(sheet);
    ASSERT_FALSE(check.surface_defects.empty());
    EXPECT_TRUE(check.surface_defects[0].folds);
  }
}

// The body consists of two flat cones, base to base. At their rim, a knot of full multiplicity, the normal
// turns by 152 degrees.
TEST(SurfaceCheck, ASharpEdgeIsNoFold) {
  const KnotVector around = KnotVector::periodic(3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}).value();
  const KnotVector along = KnotVector::open(1, {0, 0, 1, 2, 2}).value();
  ControlNet net(12, 3);
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * pi * i / 12.0;
    net.set_point(i, 0, Vector3(0.0, -0.005, 0.0));
    net.set_point(i, 1, Vector3(0.02 * std::cos(angle), 0.0, -0.02 * std::sin(angle)));
    net.set_point(i, 2, Vector3(0.0, 0.005, 0.0));
  }
  const SurfaceCheck check = *check_surface(make_surface(around, along, net).value());
  EXPECT_EQ(check.closing.closedness, Closedness::solid);
  EXPECT_GT(check.mass.volume_m3, 0.0);
  EXPECT_TRUE(check.surface_defects.empty());
}

TEST(SurfaceCheck, WhatIsTrimmedAwayDoesNotCount) {
  Surface sheet = fitted(sheet_shape(0.1, 0.06)).surface;
  Vector3 point = sheet.net.point(7, 7);
  point.x() += 0.05;
  sheet.net.set_point(7, 7, point);
  const auto hole = polygon_loop(sheet.u, sheet.v, backwards(rectangle(0.2, 0.2, 0.95, 0.9)));
  const TrimmedArea area = TrimmedArea::make(sheet.u, sheet.v, {hole}).value();
  const SurfaceCheck check = *check_surface(sheet, area);
  EXPECT_TRUE(is_clean(check));
  EXPECT_TRUE(check.is_trimmed);
  const Surface ball = fitted(sphere_shape(0.03)).surface;
  const auto cut = polygon_loop(ball.u, ball.v, backwards(rectangle(0.2, 0.4, 0.4, 0.6)));
  EXPECT_FALSE(check_surface(ball, TrimmedArea::make(ball.u, ball.v, {cut}).value())->encloses());
}

TEST(SurfaceCheck, TellsHowFarItIsAndStops) {
  const Surface torus = fitted(torus_shape({0.04, 0.01})).surface;
  double last = 0.0;
  int asked = 0;
  ASSERT_TRUE(check_surface(torus, {}, Progress([&](double share) {
                              EXPECT_GE(share, last);
                              last = share;
                              ++asked;
                              return true;
                            })));
  EXPECT_GT(last, 0.6);
  EXPECT_LE(last, 1.0);
  for (int stop = 1; stop <= asked; stop += is_full_run() ? 1 : 4) {
    int left = stop;
    EXPECT_FALSE(check_surface(torus, {}, Progress([&](double) { return --left > 0; }))) << stop;
  }
}

TEST(SurfaceCheck, KnowsInsideOut) {
  Surface sphere = fitted(sphere_shape(0.03)).surface;
  for (double& x : sphere.net.x) x = -x;
  const SurfaceCheck check = *check_surface(sphere);
  EXPECT_EQ(check.closing.closedness, Closedness::solid);
  EXPECT_LT(check.mass.volume_m3, 0.0);
}

TEST(SurfaceCheck, IsTheSameEachTime) {
  const Surface torus = fitted(torus_shape({0.04, 0.01})).surface;
  const SurfaceCheck a = *check_surface(torus), b = *check_surface(torus);
  EXPECT_EQ(a.mass.volume_m3, b.mass.volume_m3);
  EXPECT_EQ(a.curvature.smallest.curvature_per_m, b.curvature.smallest.curvature_per_m);
  EXPECT_EQ(a.thinnest->thickness_m, b.thinnest->thickness_m);
}

}  // namespace
}  // namespace spoonbill
