#include "engine/shapes/swept_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/collision/surfaces/closed_surface.h"
#include "engine/shapes/lathe.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
SmoothCurve curve_through(const std::vector<Vector3>& points) {
  return SmoothCurve::through(points, false).value();
}

void expect_closed(const FittedShape& shape) {
  EXPECT_LE(shape.deviation_m, shape_tolerance_m);
  EXPECT_FALSE(is_self_intersecting(shape.surface, true));
  EXPECT_LT(seam_jump(shape.surface), 1e-3);
  const Status closed = check_closed_tube(shape.surface);
  EXPECT_TRUE(closed.ok()) << closed.error().message;
  EXPECT_GT(volume_m3(shape.surface), 0.0);
}

TEST(Tube, StraightIsACapsule) {
  const FittedShape tube =
      fitted(tube_shape({curve_through({{-0.03, 0.01, 0}, {0.03, 0.01, 0}}), 0.005, 0.005}));
  expect_closed(tube);
  const auto distance = [](const Vector3& p) {
    return (p - Vector3(std::clamp(p.x(), -0.03, 0.03), 0.01, 0.0)).norm() - 0.005;
  };
  EXPECT_LE(largest_distance_m(tube.surface, distance), shape_tolerance_m);
  EXPECT_GT(least_outward(tube.surface, distance), 0.999);
  const double area = 2.0 * pi * 0.005 * 0.06 + 4.0 * pi * 0.005 * 0.005;
  EXPECT_NEAR(volume_m3(tube.surface), pi * 0.005 * 0.005 * (0.06 + 4.0 / 3.0 * 0.005),
              shape_tolerance_m * area);
  EXPECT_LT(evenness(tube.surface).along, 1.05);
}

// The distance of each point from the centre line, found by searching along the line, must be the tube's
// radius.
TEST(Tube, BentIsRoundAboutItsLine) {
  const SmoothCurve line =
      curve_through({{0, 0, 0}, {0.03, 0.01, 0}, {0.05, 0.03, 0.02}, {0.05, 0.06, 0.05}});
  const FittedShape tube = fitted(tube_shape({line, 0.004, 0.004}));
  expect_closed(tube);
  const auto distance = [&](const Vector3& p) {
    double least = 1.0, at = 0.0;
    for (int k = 0; k <= 400; ++k) {
      const double apart = (line.at(line.end() * k / 400) - p).norm();
      if (apart < least) {
        least = apart;
        at = line.end() * k / 400;
      }
    }
    for (double step = line.end() / 400; step > 1e-9; step *= 0.5) {
      for (const double other : {at - step, at + step}) {
        const double t = std::clamp(other, 0.0, line.end()), apart = (line.at(t) - p).norm();
        if (apart >= least) continue;
        least = apart;
        at = t;
      }
    }
    return least - 0.004;
  };
  double largest = 0.0;
  for (double u = 0.0; u < 1.0; u += 0.031) {
    for (double v = 0.001; v < 1.0; v += 0.0097) {
      largest = std::max(largest, std::abs(distance(position(tube.surface, u, v))));
    }
  }
  EXPECT_LE(largest, shape_tolerance_m);
  // Pappus's theorem for a bent line: the volume is the section times the length, plus the ball that the two
  // ends form together.
  double length = 0.0;
  for (int k = 0; k < 20000; ++k) {
    length += (line.at(line.end() * (k + 1) / 20000) - line.at(line.end() * k / 20000)).norm();
  }
  const double volume = pi * 0.004 * 0.004 * (length + 4.0 / 3.0 * 0.004);
  EXPECT_NEAR(volume_m3(tube.surface), volume, shape_tolerance_m * 2.0 * pi * 0.004 * length);
}

TEST(Tube, MayBeFlat) {
  const FittedShape tube = fitted(tube_shape({curve_through({{0, 0, 0}, {0.1, 0, 0}}), 0.01, 0.003}));
  expect_closed(tube);
  EXPECT_NEAR(volume_m3(tube.surface), pi * 0.01 * 0.003 * (0.1 + 4.0 / 3.0 * 0.003), 5e-8);
  double highest = 0.0, widest = 0.0;
  for (int k = 0; k < 100; ++k) {
    const Vector3 point = position(tube.surface, k / 100.0, 0.5);
    highest = std::max(highest, point.y());
    widest = std::max(widest, point.z());
  }
  EXPECT_NEAR(highest, 0.003, shape_tolerance_m);
  EXPECT_NEAR(widest, 0.01, shape_tolerance_m);
}

TEST(Tube, RefusesABendThatIsTooSharp) {
  const auto refused =
      tube_shape({curve_through({{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.004, 0}, {0, 0.004, 0}}), 0.005, 0.005});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::self_intersecting) << refused.error().message;
}

std::vector<MeridianPoint> half_circle(double radius, int count) {
  std::vector<MeridianPoint> points;
  for (int k = 0; k <= count; ++k) {
    const double angle = pi * (static_cast<double>(k) / count - 0.5);
    points.emplace_back(k == 0 || k == count ? 0.0 : radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

// A spline through 41 points of a half circle of 30 mm deviates from it by less than a thousandth of the
// tolerance.
TEST(Lathe, OfAHalfCircleIsASphereWhicheverWayItRuns) {
  std::vector<MeridianPoint> profile = half_circle(0.03, 40);
  for (int turn = 0; turn < 2; ++turn) {
    const FittedShape ball = fitted(lathe_shape(profile));
    expect_closed(ball);
    const auto distance = [](const Vector3& p) { return p.norm() - 0.03; };
    EXPECT_LE(largest_distance_m(ball.surface, distance), 1.01 * shape_tolerance_m);
    EXPECT_GT(least_outward(ball.surface, distance), 0.999);
    std::reverse(profile.begin(), profile.end());
  }
}

TEST(Lathe, OfAClosedProfileIsARing) {
  std::vector<MeridianPoint> profile;
  for (int k = 0; k <= 40; ++k) {
    profile.emplace_back(0.04 - 0.01 * std::cos(2.0 * pi * k / 40), 0.01 * std::sin(2.0 * pi * k / 40));
  }
  const FittedShape ring = fitted(lathe_shape(profile));
  EXPECT_TRUE(ring.surface.v.is_periodic());
  EXPECT_NEAR(volume_m3(ring.surface), 2.0 * pi * pi * 0.04 * 1e-4, 1e-5 * 4.0 * pi * pi * 0.04 * 0.01);
}

TEST(Lathe, OpenAtOneEndIsABowl) {
  std::vector<MeridianPoint> profile = half_circle(0.03, 40);
  profile.resize(21);
  const FittedShape bowl = fitted(lathe_shape(profile));
  EXPECT_TRUE(bowl.surface.u.is_periodic());
  EXPECT_NEAR(area_m2(bowl.surface), 2.0 * pi * 0.03 * 0.03, 1e-5);
}

TEST(Lathe, RefusesProfilesThatTurnIntoNone) {
  EXPECT_FALSE(lathe_shape({}).ok());
  EXPECT_FALSE(lathe_shape({{0.01, 0.0}}).ok());
  EXPECT_FALSE(lathe_shape({{0.0, 0.0}, {-0.01, 0.01}, {0.0, 0.02}}).ok());
  EXPECT_FALSE(lathe_shape({{0.01, 0.0}, {0.01, 0.0}}).ok());
  EXPECT_FALSE(lathe_shape({{0.01, 0.0}, {std::nan(""), 0.01}}).ok());
  // The profile crosses itself.
  EXPECT_FALSE(lathe_shape({{0.01, 0.0}, {0.05, 0.02}, {0.05, 0.0}, {0.01, 0.02}}).ok());
}

std::vector<Vector3> ring(double width, double height, double x, int count, int start = 0,
                          bool back = false) {
  std::vector<Vector3> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * pi * (back ? start - k : start + k) / count;
    points.emplace_back(x, height * std::sin(angle), width * std::cos(angle));
  }
  return points;
}

// Equal rings give a straight tube, whichever point each ring begins at and whichever direction it runs in.
TEST(Loft, ThroughEqualRingsIsATubeWithCaps) {
  LoftSections sections;
  sections.sections_m = {ring(0.01, 0.01, 0.0, 40), ring(0.01, 0.01, 0.02, 32, 5),
                         ring(0.01, 0.01, 0.05, 48, 11, true)};
  sections.cap_m = 0.01;
  const FittedShape tube = fitted(loft_shape(sections));
  expect_closed(tube);
  // Caps as high as the ring's radius are half balls, except for the cubic's deviation of 2.7e-4 of the
  // radius.
  const auto distance = [](const Vector3& p) {
    return (p - Vector3(std::clamp(p.x(), 0.0, 0.05), 0.0, 0.0)).norm() - 0.01;
  };
  EXPECT_LE(largest_distance_m(tube.surface, distance), shape_tolerance_m + 3e-6);
  EXPECT_GT(least_outward(tube.surface, distance), 0.99);
}

TEST(Loft, MayEndInPointsOrStayOpen) {
  LoftSections spindle;
  spindle.sections_m = {{{-0.03, 0, 0}}, ring(0.01, 0.008, 0.0, 40), {{0.03, 0, 0}}};
  const FittedShape body = fitted(loft_shape(spindle));
  EXPECT_LE(body.deviation_m, shape_tolerance_m);
  EXPECT_GT(volume_m3(body.surface), 0.0);
  EXPECT_TRUE(check_closed_tube(body.surface).ok());

  LoftSections pipe;
  pipe.sections_m = {ring(0.01, 0.01, 0.0, 40), ring(0.02, 0.01, 0.05, 40)};
  pipe.caps = false;
  const FittedShape open = fitted(loft_shape(pipe));
  EXPECT_FALSE(check_closed_tube(open.surface).ok());
  EXPECT_NEAR(position(open.surface, 0.0, 1.0).x(), 0.05, shape_tolerance_m);
}

TEST(Loft, OfOpenSectionsIsASheet) {
  LoftSections sections;
  sections.closed = false;
  for (int s = 0; s < 4; ++s) {
    std::vector<Vector3> line;
    for (int k = 0; k < 10; ++k) line.emplace_back(0.01 * k, 0.002 * s * s, 0.02 * s);
    if (s % 2 == 1) std::reverse(line.begin(), line.end());
    sections.sections_m.push_back(line);
  }
  const FittedShape sheet = fitted(loft_shape(sections));
  EXPECT_LE(sheet.deviation_m, shape_tolerance_m);
  EXPECT_FALSE(sheet.surface.u.is_periodic() || sheet.surface.v.is_periodic());
  // Every section is straight: the area is the width times the length of the line across the sections.
  const double width = 0.09, length = area_m2(sheet.surface) / width;
  EXPECT_GT(length, std::hypot(0.06, 0.018));
  EXPECT_LT(length, 1.02 * (std::hypot(0.02, 0.002) + std::hypot(0.02, 0.006) + std::hypot(0.02, 0.01)));
}

TEST(Loft, RefusesSectionsThatMakeNone) {
  EXPECT_FALSE(loft_shape({}).ok());
  LoftSections sections;
  sections.sections_m = {ring(0.01, 0.01, 0.0, 40)};
  EXPECT_FALSE(loft_shape(sections).ok());
  sections.sections_m = {ring(0.01, 0.01, 0.0, 40), ring(0.01, 0.01, 0.0, 40)};
  EXPECT_FALSE(loft_shape(sections).ok());
  sections.sections_m = {ring(0.01, 0.01, 0.0, 40), ring(0.01, 0.01, 0.05, 2)};
  EXPECT_FALSE(loft_shape(sections).ok());
  sections.sections_m = {{{0, 0, 0}}, {{1, 0, 0}}};
  EXPECT_FALSE(loft_shape(sections).ok());
}

}  // namespace
}  // namespace spoonbill
