#include "engine/merging/intersection_merge.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/bridge.h"
#include "engine/merging/tube_ends.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
using PointOf = std::function<Vector3(double, double)>;

Surface fitted(bool periodic, int along_u, int along_v, const PointOf& at) {
  const auto u =
      (periodic ? KnotVector::periodic_uniform(3, along_u) : KnotVector::clamped_uniform(3, along_u)).value();
  const auto v = KnotVector::clamped_uniform(3, along_v).value();
  PointGrid points{
      periodic ? uniform_parameters_without_seam(u, 3 * along_u) : uniform_parameters(u, 3 * along_u),
      uniform_parameters(v, 4 * along_v),
      {}};
  for (const double a : points.u) {
    for (const double b : points.v) points.points_m.push_back(at(a, b));
  }
  return fit_grid(u, v, points, {false, false, true, true}).value();
}

constexpr double ball_radius = 0.02, rod_radius = 0.006;

Surface ball() {
  return fitted(true, 32, 32, [](double u, double v) {
    const double turn = 2 * pi * u, fall = pi * v;
    // The direction of u makes the normals point outwards.
    return Vector3(ball_radius * std::sin(fall) * std::cos(-turn),
                   ball_radius * std::sin(fall) * std::sin(-turn), ball_radius * std::cos(fall));
  });
}

// Returns a rod with round ends between the ball's centre and a point in the given direction. Its v runs
// towards the ball's centre.
Surface rod(const Vector3& direction) {
  const Vector3 across = direction.unitOrthogonal(), other = direction.cross(across);
  const double far = 0.06, quarter = 0.5 * pi * rod_radius, straight = far - 2 * rod_radius;
  const double whole = straight + 2 * quarter;
  return fitted(true, 24, 40, [=](double u, double v) {
    const double way = v * whole, turn = -2 * pi * u;
    double along = 0.0, radius = rod_radius;
    if (way < quarter) {
      along = far - rod_radius + rod_radius * std::cos(way / rod_radius);
      radius = rod_radius * std::sin(way / rod_radius);
    } else if (way > whole - quarter) {
      const double left = (whole - way) / rod_radius;
      along = rod_radius - rod_radius * std::cos(left);
      radius = rod_radius * std::sin(left);
    } else {
      along = far - rod_radius - (way - quarter);
    }
    return Vector3(along * direction + radius * (std::cos(turn) * across + std::sin(turn) * other));
  });
}

// Returns the distance of a point from the union of ball and rod. Around the rod's axis, a fillet rounds the
// corner between them.
double distance_to_union(const Vector3& point, const Vector3& direction, double fillet) {
  const double along = point.dot(direction), radius = (point - along * direction).norm();
  const double far_middle = 0.06 - rod_radius;
  const double to_rod =
      along > far_middle ? std::hypot(along - far_middle, radius) - rod_radius : radius - rod_radius;
  const double to_ball = std::hypot(along, radius) - ball_radius;
  // The fillet's circle touches both the rod and the ball from outside.
  const double centre_radius = rod_radius + fillet;
  const double centre_along = std::sqrt(std::pow(ball_radius + fillet, 2) - centre_radius * centre_radius);
  const double touch_along = centre_along * ball_radius / (ball_radius + fillet);
  if (fillet > 0.0 && along < centre_along && along > touch_along && radius < centre_radius &&
      to_ball > -1e-4 && to_rod > -1e-4) {
    return std::abs(fillet - std::hypot(along - centre_along, radius - centre_radius));
  }
  return std::min(std::abs(to_rod), std::abs(to_ball));
}

double largest_distance(const Surface& merged, const Vector3& direction, double fillet) {
  const PointGrid points =
      sample_grid_points(merged, uniform_parameters(merged.u, 60), uniform_parameters(merged.v, 200));
  double largest = 0.0;
  for (const Vector3& point : points.points_m) {
    largest = std::max(largest, distance_to_union(point, direction, fillet));
  }
  return largest;
}

class RodInBall : public testing::TestWithParam<double> {};

// The rod is along the axis through the ball's poles, or oblique. With an oblique rod, the ball gets other
// poles.
TEST_P(RodInBall, BecomesOneSurface) {
  const double angle = GetParam();
  const Vector3 direction(std::sin(angle), 0.0, std::cos(angle));
  for (const double fillet : {0.0, 0.003}) {
    IntersectionRequest request;
    request.fillet_m = fillet;
    const auto merged = merge_crossing(rod(direction), ball(), request);
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_TRUE(is_pole(merged->surface, Side::v_start));
    EXPECT_TRUE(is_pole(merged->surface, Side::v_end));
    const Joint& corner = merged->corner;
    EXPECT_EQ(corner.bridged, fillet > 0.0);
    if (fillet > 0.0) {
      // The fillet's arc, which touches both the rod and the ball from outside, spans this angle.
      const double turn = std::acos((rod_radius + fillet) / (ball_radius + fillet));
      EXPECT_NEAR(corner.blend_length_m, fillet * turn, 1e-4);
      const Vector3 start = position(merged->surface, 0.3, corner.blend_start);
      EXPECT_NEAR(start.dot(direction), std::sin(turn) * (ball_radius + fillet), 2e-4);
    }
    // Both parts have the rod's parameter u, and no two knots are nearly equal.
    EXPECT_EQ(merged->surface.u.domain_start(), 0.0);
    const std::vector<double> knots = merged->surface.u.breakpoints();
    for (std::size_t k = 1; k < knots.size(); ++k) EXPECT_GT(knots[k] - knots[k - 1], 1e-3);
    // The fitted ball and rod deviate from the exact ones by 6e-6 m; the rest is the tolerance.
    EXPECT_LT(largest_distance(merged->surface, direction, fillet), 6e-5) << fillet;
    // Normals point outwards. The rod adds the volume of a cylinder and of a half ball, without the part of
    // the rod inside the ball.
    const double volume = compute_enclosed_mass(merged->surface).volume_m3;
    EXPECT_GT(volume, 4.0 / 3.0 * pi * std::pow(ball_radius, 3) + pi * rod_radius * rod_radius * 0.033);
    EXPECT_LT(volume, 4.0 / 3.0 * pi * std::pow(ball_radius, 3) + pi * rod_radius * rod_radius * 0.045);
  }
}

INSTANTIATE_TEST_SUITE_P(Askew, RodInBall, testing::Values(0.0, 0.4, 1.3));

Surface plane(const Vector3& corner, const Vector3& across, const Vector3& along) {
  return fitted(false, 6, 6, [=](double u, double v) { return Vector3(corner + u * across + v * along); });
}

TEST(IntersectionMerge, AFloorAndAWall) {
  // The floor extends 10 mm beyond the wall, the wall 5 mm below the floor.
  const Surface floor = plane({0, 0, 0}, {0, 0.05, 0}, {0.05, 0, 0});
  const Surface wall = plane({0.04, -0.001, -0.005}, {0, 0.052, 0}, {0, 0, 0.045});
  for (const double fillet : {0.0, 0.008}) {
    IntersectionRequest request;
    request.fillet_m = fillet;
    const auto merged = merge_crossing(floor, wall, request);
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    const Surface& surface = merged->surface;
    const PointGrid points =
        sample_grid_points(surface, uniform_parameters(surface.u, 20), uniform_parameters(surface.v, 120));
    for (const Vector3& p : points.points_m) {
      double distance = std::min(std::abs(p.z()), std::abs(p.x() - 0.04));
      if (fillet > 0.0 && p.x() > 0.04 - fillet && p.z() < fillet) {
        distance = std::abs(fillet - std::hypot(p.x() - 0.032, p.z() - fillet));
      }
      EXPECT_LT(distance, 5e-5);
      EXPECT_GT(p.z(), -5e-5);
      EXPECT_LT(p.x(), 0.04 + 5e-5);
    }
    EXPECT_NEAR(position(surface, 0.5, surface.v.domain_end()).z(), 0.04, 1e-6);
  }
}

// Lines of one sheet run along the border of the other sheet. Rounding puts them inside or outside this
// border.
TEST(IntersectionMerge, SheetsOfOneWidth) {
  for (const double turn : {0.0, 0.3, 0.7, 1.1}) {
    const auto turned = [&](const Vector3& p) {
      return Vector3(Eigen::AngleAxisd(turn, Vector3(1, 2, 3).normalized()) * p);
    };
    const Surface floor = plane(turned({0, -0.03, 0}), turned({0, 0.06, 0}), turned({0.05, 0, 0}));
    const Surface wall = plane(turned({0.04, -0.03, -0.005}), turned({0, 0.06, 0}), turned({0, 0, 0.045}));
    for (const double fillet : {0.0, 0.005}) {
      IntersectionRequest request;
      request.fillet_m = fillet;
      const auto merged = merge_crossing(floor, wall, request);
      ASSERT_TRUE(merged.ok()) << turn << " " << fillet << " " << merged.error().message;
      EXPECT_LE(merged->deviation_m, 5e-5);
    }
  }
}

TEST(IntersectionMerge, RefusesWhatDoesNotCross) {
  const Surface floor = plane({0, 0, 0}, {0, 0.05, 0}, {0.05, 0, 0});
  const Surface apart = plane({0.04, 0, 0.01}, {0, 0.05, 0}, {0, 0, 0.045});
  EXPECT_FALSE(merge_crossing(floor, apart, {}).ok());
  IntersectionRequest request;
  request.fillet_m = 0.2;
  const Surface wall = plane({0.04, -0.001, -0.005}, {0, 0.052, 0}, {0, 0, 0.045});
  const auto too_large = merge_crossing(floor, wall, request);
  ASSERT_FALSE(too_large.ok());
  EXPECT_EQ(too_large.error().code, ErrorCode::out_of_range);
  EXPECT_EQ(too_large.error().field, "fillet");
}

TEST(IntersectionMerge, TheToleranceHoldsWithNewPoles) {
  IntersectionRequest request;
  request.fillet_m = 0.003;
  const auto merged = merge_crossing(rod(Vector3(std::sin(1.3), 0.0, std::cos(1.3))), ball(), request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LE(merged->deviation_m, request.join.tolerance_m);
  EXPECT_GT(merged->deviation_m, 0.0);
}

// A drum about the z axis with rounded rims.
struct Drum {
  double radius, half_height, rounding = 0.003;

  double distance(const Vector3& p) const {
    const double out = p.head<2>().norm() - (radius - rounding),
                 up = std::abs(p.z()) - (half_height - rounding);
    return std::hypot(std::max(out, 0.0), std::max(up, 0.0)) + std::min(std::max(out, up), 0.0) - rounding;
  }
  Surface surface() const {
    const double flat = radius - rounding, arc = 0.5 * pi * rounding, side = 2.0 * (half_height - rounding);
    const double whole = 2.0 * (flat + arc) + side;
    // Returns radius and height of a point on the profile of the upper half. `way` is its distance from the
    // pole along the profile.
    const auto profile = [=, this](double way) -> Eigen::Vector2d {
      if (way < flat) return {way, half_height};
      const double turn = (way - flat) / rounding;
      if (way < flat + arc) {
        return {flat + rounding * std::sin(turn), half_height - rounding + rounding * std::cos(turn)};
      }
      return {radius, half_height - rounding - (way - flat - arc)};
    };
    return fitted(true, 24, 80, [=](double u, double v) {
      const double way = v * whole, turn = -2 * pi * u;
      const bool upper = way < 0.5 * whole;
      const Eigen::Vector2d at = profile(upper ? way : whole - way);
      return Vector3(at.x() * std::cos(turn), at.x() * std::sin(turn), upper ? at.y() : -at.y());
    });
  }
};

// A rod enters a drum from the side, or is upright on the end face of a drum beside the drum's pole.
TEST(IntersectionMerge, LinesLeadAwayFromACrossingBesideThePole) {
  const Drum tall{0.01, 0.03}, wide{0.03, 0.01};
  const Vector3 x(1, 0, 0), z(0, 0, 1), beside(0.012, 0, 0);
  for (const auto& [drum, direction, shift, tolerance_m] :
       {std::tuple(tall, x, Vector3(0, 0, 0), 3e-4), std::tuple(wide, z, beside, 5e-5)}) {
    IntersectionRequest request;
    request.join.tolerance_m = tolerance_m;
    const Surface standing = placed(rod(direction), {shift, Quaternion::Identity()});
    const auto merged = merge_crossing(standing, drum.surface(), request);
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_LE(merged->deviation_m, tolerance_m);
    EXPECT_FALSE(find_fold(merged->surface).has_value());
    const PointGrid points = sample_grid_points(merged->surface, uniform_parameters(merged->surface.u, 60),
                                                uniform_parameters(merged->surface.v, 120));
    double farthest = 0.0, deepest = 0.0;
    for (const Vector3& p : points.points_m) {
      const Vector3 of_rod = p - shift;
      const double along = of_rod.dot(direction), level = (of_rod - along * direction).norm();
      const double beyond = std::max({0.0, along - 0.054, rod_radius - along});
      const double to_rod = std::hypot(beyond, level) - rod_radius, to_drum = drum.distance(p);
      farthest = std::max(farthest, std::min(std::abs(to_rod), std::abs(to_drum)));
      deepest = std::min({deepest, to_rod, to_drum});
    }
    // The fitted bodies deviate from the exact ones by up to 3e-5 m.
    EXPECT_LT(farthest, tolerance_m + 3e-5);
    EXPECT_GT(deepest, -tolerance_m - 3e-5);
  }
}

// On a drum, the lines from the intersection run along v on one side and against it on the other.
TEST(IntersectionMerge, AFilletBesideThePoleFillsTheCorner) {
  IntersectionRequest request;
  request.fillet_m = 0.002;
  request.join.continuity = 1;
  const Drum wide{0.03, 0.01};
  const Surface standing = placed(rod(Vector3(0, 0, 1)), {Vector3(0.012, 0, 0), Quaternion::Identity()});
  const auto merged = merge_crossing(standing, wide.surface(), request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_NEAR(merged->corner.blend_length_m, 0.5 * pi * 0.002, 5e-5);
  EXPECT_FALSE(find_fold(merged->surface).has_value());
  EXPECT_GT(find_curvature_range(merged->surface).smallest.curvature_per_m, -1.2 / 0.002);
  const double middle = 0.5 * (merged->corner.blend_start + merged->corner.blend_end);
  for (const double u : uniform_parameters(merged->surface.u, 24)) {
    const Vector3 p = position(merged->surface, u, middle) - Vector3(0.012, 0, 0);
    const double from_ball = std::hypot(p.head<2>().norm() - rod_radius - 0.002, p.z() - 0.012);
    EXPECT_NEAR(from_ball, 0.002, 1e-4);
  }
}

TEST(IntersectionMerge, ABodyThatIsAsWideAsTheOtherIsRefusedBeforeItIsFitted) {
  const Drum drum{rod_radius, 0.03};
  const auto merged = merge_crossing(rod(Vector3(1, 0, 0)), drum.surface(), {});
  ASSERT_FALSE(merged.ok());
  EXPECT_EQ(merged.error().code, ErrorCode::mismatch);
  EXPECT_NE(merged.error().message.find("wider"), std::string::npos) << merged.error().message;
}

// The ball has a radius of 20 mm, the drum one of 8 mm; the drum's axis is 6 mm from the ball's centre. The
// drum's lower rim is 14 mm beside and 16 mm below this centre, which is 1.3 mm outside the ball. About a
// third of the rim is outside, so the drum's lines of constant u that lead there leave the ball again.
TEST(IntersectionMerge, ARimThatLooksOutOfTheBallIsRefusedWhereItDoes) {
  const Drum drum{0.008, 0.023, 0.001};
  const Quaternion along_y(Eigen::AngleAxisd(-0.5 * pi, Vector3::UnitX()));
  for (const auto& [shift, turn] : {std::pair(Vector3(0.006, 0, 0.007), Quaternion::Identity()),
                                    std::pair(Vector3(0.006, 0.007, 0), along_y)}) {
    const auto merged = merge_crossing(placed(drum.surface(), {shift, turn}), ball(), {});
    ASSERT_FALSE(merged.ok());
    const std::string& message = merged.error().message;
    EXPECT_EQ(merged.error().code, ErrorCode::mismatch) << message;
    EXPECT_NE(message.find("comes out of it again at (1"), std::string::npos) << message;
  }
  // A drum whose end is fully inside the ball makes a knob.
  const auto merged =
      merge_crossing(placed(drum.surface(), {Vector3(0.003, 0, 0.011), Quaternion::Identity()}), ball(), {});
  EXPECT_TRUE(merged.ok()) << merged.error().message;
}

TEST(IntersectionMerge, BodiesWhoseNormalsPointInwardsAreTurnedAroundFirst) {
  const Surface standing = rod(Vector3(0, 0, 1)), outward = ball();
  const double union_m3 = compute_enclosed_mass(merge_crossing(standing, outward, {})->surface).volume_m3;
  ASSERT_GT(union_m3, compute_enclosed_mass(outward).volume_m3);
  for (const auto& [first, second] :
       {std::pair(false, true), std::pair(true, false), std::pair(true, true)}) {
    const auto merged = merge_crossing(first ? reversed(standing, Direction::u) : standing,
                                       second ? reversed(outward, Direction::u) : outward, {});
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_EQ(merged->first_was_inward, first);
    EXPECT_EQ(merged->second_was_inward, second);
    // The surface is the same except for the added knots.
    EXPECT_NEAR(compute_enclosed_mass(merged->surface).volume_m3, union_m3, 1e-3 * union_m3);
  }
}

TEST(IntersectionMerge, ARingIsRefused) {
  const auto merged = merge_crossing(rod(Vector3(1, 0, 0)), ring_body(), {});
  ASSERT_FALSE(merged.ok());
  EXPECT_EQ(merged.error().code, ErrorCode::unsupported) << merged.error().message;
}

TEST(IntersectionMerge, WhatGoesThroughIsRefused) {
  const Surface through = fitted(true, 24, 8, [](double u, double v) {
    const double turn = -2 * pi * u;
    return Vector3(rod_radius * std::cos(turn), rod_radius * std::sin(turn), 0.1 * v - 0.05);
  });
  const auto lost = merge_crossing(through, ball(), {});
  ASSERT_FALSE(lost.ok());
  EXPECT_EQ(lost.error().code, ErrorCode::unsupported) << lost.error().message;
  // A rod stands on a sheet: the sheet's lines cross each other at the rod's foot.
  const auto folded = merge_crossing(through, plane({-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}), {});
  ASSERT_FALSE(folded.ok());
  EXPECT_EQ(folded.error().code, ErrorCode::mismatch) << folded.error().message;
}

}  // namespace
}  // namespace spoonbill
