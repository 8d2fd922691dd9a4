// Tests of the search for points of two moving surfaces that are near each other. A search that has followed
// the surfaces from the start must find what a fresh search finds.
#include "engine/collision/proximity/surface_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "engine/collision/proximity/net_motion.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

constexpr double near_m = 0.5e-3;

NestedGrid fine_grid(const Surface& surface) {
  return make_nested_grid(surface.u, surface.v, 2).value();
}

Surface at_pose(const Surface& surface, const Pose& pose) {
  Surface moved = surface;
  place(surface.net, pose.orientation.toRotationMatrix(), pose.position_m, moved.net);
  return moved;
}

Pose pose_after(double angle_rad, const Vector3& position_m = Vector3::Zero()) {
  return {position_m, Quaternion(Eigen::AngleAxisd(angle_rad, Vector3(1.0, 2.0, 0.5).normalized()))};
}

std::map<int, NearPoint> samples_of(const std::vector<NearPoint>& points) {
  std::map<int, NearPoint> samples;
  for (const NearPoint& near : points) {
    if (near.sample >= 0) samples[near.sample] = near;
  }
  return samples;
}

// A nearest point is found to 15 nm, see proximity_least_gain_m. A gap is right to far less, because it has
// its minimum there, and a normal to 15 nm over the smallest radius, which is 2 mm.
void expect_near(const NearPoint& found, const NearPoint& expected) {
  EXPECT_NEAR(found.gap_m, expected.gap_m, 1e-11);
  EXPECT_LT((found.normal - expected.normal).norm(), 1e-5);
}

// Samples within the margin must be the same. Both searches may find deeper ones: a fresh one where cells are
// within the margin, one that follows where samples have sunk in.
void expect_same(const std::vector<NearPoint>& found, const std::vector<NearPoint>& fresh) {
  const std::map<int, NearPoint> ours = samples_of(found), others = samples_of(fresh);
  const auto expect_in = [](const std::map<int, NearPoint>& points, const std::map<int, NearPoint>& all) {
    for (const auto& [sample, point] : points) {
      if (std::abs(point.gap_m) > near_m - 1e-9) continue;
      ASSERT_TRUE(all.contains(sample)) << "sample " << sample << " at " << point.gap_m << " m";
      expect_near(all.at(sample), point);
    }
  };
  expect_in(ours, others);
  expect_in(others, ours);
}

void expect_as_fresh(const SurfaceProximity& followed, const NestedGrid& grid, const Surface& first,
                     const Surface& second) {
  SurfaceProximity fresh(grid, grid);
  fresh.find(first, second, near_m);
  expect_same(followed.first_points(), fresh.first_points());
  expect_same(followed.second_points(), fresh.second_points());
}

// The second body passes the first one, first slowly, then fast, then slowly away again. It dips into it.
TEST(SurfaceProximity, FollowsPassingBodies) {
  const Surface body = ellipsoid_tube(12, 12);
  const NestedGrid grid = fine_grid(body);
  SurfaceProximity followed(grid, grid);
  double x = 0.03, least_gap_m = 1.0;
  for (int t = 0; t < 160; ++t) {
    x += t < 60 ? 2e-5 : t < 100 ? 5e-4 : 2e-5;
    const Surface other = at_pose(body, {Vector3(x, 0.0125, 0.01), Quaternion::Identity()});
    followed.find(body, other, near_m);
    expect_as_fresh(followed, grid, body, other);
    least_gap_m = std::min(least_gap_m, followed.least_gap_m());
    ASSERT_FALSE(HasFailure()) << "in tick " << t;
  }
  EXPECT_LT(least_gap_m, -near_m);
  EXPECT_EQ(followed.least_gap_m(), infinity);
  EXPECT_GT(followed.cell_searches(), 40) << "once a tick while the body is fast";
  EXPECT_LT(followed.cell_searches(), 60);
}

// While both bodies turn about a common axis and the second one slides slowly, cells are searched only at the
// start: first with a reach of the margin, and once more with twice the margin.
TEST(SurfaceProximity, FollowsBodiesThatTurnTogether) {
  const Surface body = ellipsoid_tube(12, 12);
  const NestedGrid grid = fine_grid(body);
  SurfaceProximity followed(grid, grid);
  for (int t = 0; t < 100; ++t) {
    const Pose pose = pose_after(0.01 * t, Vector3(0.001 * t, 0.0, 0.0));
    const Surface one = at_pose(body, pose);
    const Pose beside{Vector3(0.0, 0.0201, 1e-6 * t), Quaternion::Identity()};
    const Surface other = at_pose(at_pose(body, beside), pose);
    followed.find(one, other, near_m, 1.0, pose);
    expect_as_fresh(followed, grid, one, other);
    ASSERT_FALSE(HasFailure()) << "in tick " << t;
  }
  EXPECT_EQ(followed.cell_searches(), 2);
}

void expect_equal(const std::vector<NearPoint>& found, const std::vector<NearPoint>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t p = 0; p < expected.size(); ++p) {
    EXPECT_EQ(found[p].sample, expected[p].sample);
    EXPECT_EQ(found[p].gap_m, expected[p].gap_m);
  }
}

// Every third sample of the first surface is skipped. The others are found as without it, bit for bit.
TEST(SurfaceProximity, SkipsSamples) {
  const Surface body = ellipsoid_tube(12, 12);
  const NestedGrid grid = fine_grid(body);
  SkippedSamples skipped(static_cast<std::size_t>(grid.grid.rows() * grid.grid.columns()), 0);
  for (std::size_t s = 0; s < skipped.size(); s += 3) skipped[s] = 1;
  SurfaceProximity all(grid, grid), some(grid, grid, skipped);
  int found = 0, passed_over = 0;
  for (int t = 0; t < 20; ++t) {
    const Surface other = at_pose(body, {Vector3(0.002, 0.0125 + 1e-6 * t, 0.001), Quaternion::Identity()});
    all.find(body, other, near_m);
    some.find(body, other, near_m);
    const std::map<int, NearPoint> expected = samples_of(all.first_points()),
                                   kept = samples_of(some.first_points());
    for (const auto& [sample, near] : expected) {
      const bool is_skipped = skipped[static_cast<std::size_t>(sample)] != 0;
      ASSERT_EQ(kept.contains(sample), !is_skipped);
      if (!is_skipped) {
        EXPECT_EQ(kept.at(sample).gap_m, near.gap_m);
      }
      ++(is_skipped ? passed_over : found);
    }
    EXPECT_EQ(samples_of(some.second_points()).size(), samples_of(all.second_points()).size());
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(passed_over, 50);
}

// After a jump through the other body, and after forget(), nothing is left from before: the results are those
// of a fresh search, bit for bit, deep samples included.
TEST(SurfaceProximity, FollowsNothingThatJumpsOrIsForgotten) {
  const Surface body = ellipsoid_tube(12, 12);
  const NestedGrid grid = fine_grid(body);
  const auto other_at = [&](double y) {
    return at_pose(body, {Vector3(0.0, y, 0.0), Quaternion::Identity()});
  };
  for (const bool jumps : {false, true}) {
    SurfaceProximity followed(grid, grid), fresh(grid, grid);
    for (int t = 0; t < 20; ++t) followed.find(body, other_at(0.0125 + 1e-6 * t), near_m);
    EXPECT_FALSE(followed.first_points().empty());
    if (!jumps) followed.forget();
    const Surface last = other_at(jumps ? -0.0125 : 0.01252);
    followed.find(body, last, near_m);
    fresh.find(body, last, near_m);
    expect_equal(followed.first_points(), fresh.first_points());
    expect_equal(followed.second_points(), fresh.second_points());
  }
}

TEST(NetMotion, IsThatOfTheFarthestControlPointInTheFrame) {
  const Surface body = ellipsoid_tube(8, 8);
  NetMotion motion(body.net.rows * body.net.columns);
  EXPECT_EQ(motion.since_m(body.net, {}), std::numeric_limits<double>::infinity());
  motion.remember(body.net, {});
  EXPECT_EQ(motion.since_m(body.net, {}), 0.0);
  Surface moved = body;
  moved.net.set_point(2, 3, body.net.point(2, 3) + Vector3(3e-4, 0.0, 4e-4));
  EXPECT_NEAR(motion.since_m(moved.net, {}), 5e-4, 1e-15);
  const Pose pose = pose_after(1.0, Vector3(0.3, 0.2, 0.1));
  EXPECT_NEAR(motion.since_m(at_pose(moved, pose).net, pose), 5e-4, 1e-15);
  EXPECT_GT(motion.since_m(at_pose(moved, pose).net, {}), 0.1);
  moved.net.set_point(0, 0, Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(std::isnan(motion.since_m(moved.net, {})));
}

}  // namespace
}  // namespace spoonbill
