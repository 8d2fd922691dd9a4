#include "engine/merging/tube_ends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/merge.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

struct TubeProfile {
  double radius, along;
};

// Returns the surface of revolution of a profile about the z axis. An end of the profile with zero radius
// becomes a pole.
Surface turned_profile(const std::function<TubeProfile(double)>& profile, int along, double shift_z = 0.0) {
  const auto u = KnotVector::periodic_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, along).value();
  PointGrid points{uniform_parameters_without_seam(u, 72), uniform_parameters(v, 4 * along), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      const TubeProfile at = profile(b);
      points.points_m.emplace_back(at.radius * std::cos(2 * pi * a), at.radius * std::sin(2 * pi * a),
                                   at.along + shift_z);
    }
  }
  return fit_grid(u, v, points, {false, false, true, true}).value();
}

Surface ball_at(double radius, double z) {
  return turned_profile(
      [&](double t) {
        return TubeProfile{radius * std::sin(pi * t), -radius * std::cos(pi * t)};
      },
      24, z);
}

// Returns a tube with hemispherical ends.
Surface capsule(double radius, double half_length, double z) {
  const double quarter = 0.5 * pi * radius, whole = 2 * (quarter + half_length);
  return turned_profile(
      [&](double t) {
        const double way = t * whole;
        if (way < quarter) {
          return TubeProfile{radius * std::sin(way / radius), -half_length - radius * std::cos(way / radius)};
        }
        if (way > whole - quarter) {
          const double left = (whole - way) / radius;
          return TubeProfile{radius * std::sin(left), half_length + radius * std::cos(left)};
        }
        return TubeProfile{radius, way - quarter - half_length};
      },
      40, z);
}

Surface straight_pipe(double radius, double length) {
  return turned_profile([&](double t) { return TubeProfile{radius, t * length}; }, 8);
}

JoinRequest c2() {
  return {};
}

TEST(TubeEnds, KnowsRingsFromPoles) {
  const Surface closed = ball_at(0.02, 0.0), open = straight_pipe(0.01, 0.05);
  EXPECT_TRUE(is_tube(closed));
  EXPECT_TRUE(is_pole(closed, Side::v_start));
  EXPECT_TRUE(is_pole(closed, Side::v_end));
  EXPECT_FALSE(is_pole(open, Side::v_end));
  const TubeEnd end = tube_end(open, Side::v_end);
  EXPECT_NEAR(end.radius_m, 0.01, 1e-5);
  EXPECT_NEAR((end.centre_m - Vector3(0, 0, 0.05)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((end.outward - Vector3(0, 0, 1)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((tube_end(closed, Side::v_start).outward - Vector3(0, 0, -1)).norm(), 0.0, 1e-6);
}

TEST(TubeEnds, ARoundCapIsHalfAnEllipsoid) {
  for (const Side side : {Side::v_start, Side::v_end}) {
    const auto capped = add_cap(straight_pipe(0.01, 0.05), side, 0.006, c2());
    ASSERT_TRUE(capped.ok()) << capped.error().message;
    EXPECT_LE(capped->deviation_m, 5e-5);
    EXPECT_TRUE(is_pole(capped->surface, side));
    const TubeEnd pole = tube_end(capped->surface, side);
    EXPECT_NEAR(pole.centre_m.z(), side == Side::v_end ? 0.056 : -0.006, 1e-9);
    // The cubic quarter ellipse deviates by at most 3e-4 of its size.
    const double whole = pi * 1e-4 * 0.05 + 2.0 / 3.0 * pi * 1e-4 * 0.006;
    const Side other = opposite(side);
    const auto closed = add_cap(capped->surface, other, 0.0, c2());
    ASSERT_TRUE(closed.ok()) << closed.error().message;
    EXPECT_NEAR(std::abs(compute_enclosed_mass(closed->surface).volume_m3), whole,
                4e-3 * whole);  // the ring is a cubic spline, not an exact circle
  }
}

TEST(TubeEnds, AFlatCapMeetsTheSidesAtAnEdge) {
  const auto capped = add_cap(straight_pipe(0.01, 0.05), Side::v_end, 0.0, c2());
  ASSERT_TRUE(capped.ok()) << capped.error().message;
  EXPECT_LT(capped->deviation_m, 1e-12);
  const Surface& surface = capped->surface;
  EXPECT_NEAR(position(surface, 0.3, surface.v.domain_end()).head<2>().norm(), 0.0, 1e-12);
  const Vector3 near_rim = position(surface, 0.3, capped->joints[0].blend_end * 1.0001);
  EXPECT_NEAR(near_rim.z(), 0.05, 1e-9);
}

TEST(TubeEnds, OpensAPoleWhereTheSidesRunStraight) {
  const auto opened = open_pole(capsule(0.01, 0.03, 0.0), Side::v_end, 1.0);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const TubeEnd ring = tube_end(opened.value(), Side::v_end);
  // The pole is opened where the radius of the hemisphere grows by 0.1 of the axial distance, that is, where
  // the angle from the axis has the tangent 1 / 0.1.
  EXPECT_NEAR(ring.radius_m, 0.01 * std::sin(std::atan(1.0 / 0.1)), 2e-4);
  EXPECT_TRUE(is_pole(opened.value(), Side::v_start));
  const auto narrow = open_pole(capsule(0.01, 0.03, 0.0), Side::v_end, 0.005);
  EXPECT_NEAR(tube_end(narrow.value(), Side::v_end).radius_m, 0.005, 3e-4);
  EXPECT_FALSE(open_pole(straight_pipe(0.01, 0.05), Side::v_end, 1.0).ok());
}

TEST(TubeEnds, ClosedBodiesAreBridgedAtTheirNearestPoles) {
  const Surface rod = capsule(0.008, 0.03, 0.0), head = ball_at(0.02, 0.07);
  const auto merged = merge({rod, head}, {});
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  ASSERT_EQ(merged->joints.size(), 1u);
  EXPECT_EQ(merged->joints[0].a, (PatchEdge{0, Side::v_end}));
  EXPECT_EQ(merged->joints[0].b, (PatchEdge{1, Side::v_start}));
  EXPECT_TRUE(merged->joints[0].joint.bridged);
  EXPECT_LT(merged->deviation_m, 1e-9);
  EXPECT_TRUE(is_pole(merged->surface, Side::v_start));
  EXPECT_TRUE(is_pole(merged->surface, Side::v_end));
  // The bridge has no waist: it is nowhere narrower than the rod at its start.
  const Joint& joint = merged->joints[0].joint;
  const double at_rod = position(merged->surface, 0.0, joint.blend_start).head<2>().norm();
  for (int k = 0; k <= 50; ++k) {
    const double v = joint.blend_start + (joint.blend_end - joint.blend_start) * k / 50;
    EXPECT_GT(position(merged->surface, 0.0, v).head<2>().norm(), 0.97 * at_rod) << k;
  }
}

TEST(TubeEnds, AWasherIsCappedFlatAlone) {
  const Surface washer = turned_profile([](double t) { return TubeProfile{0.01 + 0.02 * t, 0.0}; }, 8);
  const auto refused = add_cap(washer, Side::v_start, 0.003, c2());
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::degenerate) << refused.error().message;
  EXPECT_TRUE(add_cap(washer, Side::v_start, 0.0, c2()).ok());
}

// Returns a tube about the z axis with the given outline.
Surface outline_tube(const KnotVector& u, const std::function<Eigen::Vector2d(double)>& outline) {
  const auto v = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{
      uniform_parameters_without_seam(u, 4 * u.control_point_count()), uniform_parameters(v, 12), {}};
  for (const double a : points.u) {
    for (const double b : points.v) points.points_m.emplace_back(outline(a).x(), outline(a).y(), 0.05 * b);
  }
  return fit_grid(u, v, points).value();
}

// Returns a point of the outline of a bean, which is 4 mm wide and follows an arc of the given angle.
Eigen::Vector2d along_bean(double u, double angle) {
  const double turn = 2 * pi * u, out = 0.02 + 0.002 * std::sin(turn), at = 0.5 * angle * std::cos(turn);
  return {out * std::cos(at), out * std::sin(at)};
}

TEST(TubeEnds, AFlatCapThatWouldFoldIsRefusedWhereItDoes) {
  const auto around = KnotVector::periodic_uniform(3, 48).value();
  const Surface bent = outline_tube(around, [](double u) { return along_bean(u, 0.8 * pi); });
  const Surface slightly = outline_tube(around, [](double u) { return along_bean(u, 0.05 * pi); });
  for (const Side side : {Side::v_start, Side::v_end}) {
    const auto refused = add_cap(bent, side, 0.0, c2());
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::self_intersecting) << refused.error().message;
    EXPECT_NE(refused.error().message.find(" at (6.2, -18.9, "), std::string::npos)
        << refused.error().message;
    EXPECT_TRUE(add_cap(slightly, side, 0.0, c2()).ok());
  }
  // The section is an angle profile whose plates meet at edges.
  const auto plates = KnotVector::periodic_uniform(1, 6).value();
  const std::vector<Eigen::Vector2d> corners{{0, 0},         {0.03, 0},     {0.03, 0.002},
                                             {0.002, 0.002}, {0.002, 0.03}, {0, 0.03}};
  const Surface angle = outline_tube(plates, [&](double u) {
    const int k = static_cast<int>(6.0 * u);
    return Eigen::Vector2d(corners[k] + (6.0 * u - k) * (corners[(k + 1) % 6] - corners[k]));
  });
  EXPECT_FALSE(add_cap(angle, Side::v_end, 0.0, c2()).ok());
}

}  // namespace
}  // namespace spoonbill
