#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/surface_check.h"
#include "engine/merging/merge.h"
#include "engine/merging/trimmed_patch.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// Returns a square in the plane y = `y_m`, from -0.05 to 0.05 m in x and z. Its normals point up or down.
Surface level_plane(double y_m, bool up) {
  Surface surface;
  surface.u = surface.v = KnotVector::clamped_uniform(1, 2).value();
  surface.net = ControlNet(2, 2);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double first = 0.1 * i - 0.05, second = 0.1 * j - 0.05;
      surface.net.set_point(i, j, up ? Vector3(second, y_m, first) : Vector3(first, y_m, second));
    }
  }
  return surface;
}

// Returns a circle about `centre_m` on the plane, as chords of a third of a degree.
TrimLoop circle(const Surface& surface, double radius_m, bool hole,
                const Eigen::Vector2d& centre_m = {0, 0}) {
  std::vector<Eigen::Vector2d> corners;
  constexpr int count = 1080;
  for (int k = 0; k < count; ++k) {
    const double turn = (hole ? -2.0 : 2.0) * pi * k / count;
    corners.emplace_back((centre_m.x() + radius_m * std::cos(turn) + 0.05) / 0.1,
                         (centre_m.y() + radius_m * std::sin(turn) + 0.05) / 0.1);
  }
  return make_polygon_loop(surface.u, surface.v, corners).value();
}

// Returns a cylinder about y from `low_m` to `high_m`, facing outwards. Its seam is at a different angle than
// the seam of a disc.
Surface side(double radius_m, double low_m, double high_m) {
  const auto u = KnotVector::periodic_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{uniform_parameters_without_seam(u, 96), uniform_parameters(v, 20), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      const double turn = 1.0 - 2.0 * pi * a;
      points.points_m.emplace_back(radius_m * std::cos(turn), low_m + (high_m - low_m) * b,
                                   radius_m * std::sin(turn));
    }
  }
  return fit_grid(u, v, points).value();
}

TEST(RoundPart, ADiscEndsInAPoleAndKeepsItsArea) {
  for (const bool up : {true, false}) {
    const Surface sheet = level_plane(0.02, up);
    const auto disc = untrimmed(sheet, {circle(sheet, 0.03, false, {0.01, -0.005})}, 1e-6);
    ASSERT_TRUE(disc) << disc.error().message;
    EXPECT_LE(disc->deviation_m, 1e-6);
    const Surface& surface = disc->surface;
    EXPECT_TRUE(surface.u.is_periodic());
    // Chords of a third of a degree reduce the circle's area by the fraction 5e-6. An edge that is off by a
    // micrometre changes it by 7e-5.
    EXPECT_NEAR(compute_enclosed_mass(surface).area_m2 / (pi * 0.03 * 0.03), 1.0, 8e-5);
    EXPECT_GT((up ? 1.0 : -1.0) * unit_normal(surface, 0.3, 0.5).y(), 0.99);
    const Vector3 pole = position(surface, 0.1, surface.v.domain_end());
    EXPECT_LT((pole - position(surface, 0.6, surface.v.domain_end())).norm(), 1e-15);
  }
}

// The edge of an eccentric hole is followed as exactly as the outer edge.
TEST(RoundPart, ARingRunsFromItsEdgeToItsHole) {
  const Surface sheet = level_plane(0.0, true);
  const auto ring = untrimmed(
      sheet, {circle(sheet, 0.01, true, {0.008, 0.0}), circle(sheet, 0.04, false, {0.0, 0.0})}, 1e-6);
  ASSERT_TRUE(ring) << ring.error().message;
  const double area = pi * (0.04 * 0.04 - 0.01 * 0.01);
  EXPECT_NEAR(compute_enclosed_mass(ring->surface).area_m2 / area, 1.0, 1e-4);
  EXPECT_GT(unit_normal(ring->surface, 0.3, 0.5).y(), 0.99);
  for (double u = 0.0; u < 1.0; u += 0.05) {
    const Vector3 outer = position(ring->surface, u, ring->surface.v.domain_start());
    const Vector3 inner = position(ring->surface, u, ring->surface.v.domain_end());
    EXPECT_NEAR(outer.norm(), 0.04, 2e-6);
    EXPECT_NEAR((inner - Vector3(0.0, 0.0, 0.008)).norm(), 0.01, 2e-6);
  }
}

// A drum as in CAD systems: its side, and a plane at each end trimmed by a circle.
TEST(RoundPart, ADrumOfThreeFacesBecomesOneClosedBody) {
  const Surface top = level_plane(0.03, true), bottom = level_plane(-0.01, false);
  const auto lid = untrimmed(top, {circle(top, 0.02, false)}, 2e-6);
  const auto base = untrimmed(bottom, {circle(bottom, 0.02, false)}, 2e-6);
  ASSERT_TRUE(lid && base);
  MergeRequest request;
  request.join.continuity = 0;
  request.join.tolerance_m = 5e-5;
  const auto drum = merge({lid->surface, side(0.02, -0.01, 0.03), base->surface}, request);
  ASSERT_TRUE(drum) << drum.error().message;
  EXPECT_LE(drum->deviation_m, 5e-5);
  EXPECT_NEAR(compute_enclosed_mass(drum->surface).volume_m3 / (pi * 0.02 * 0.02 * 0.04), 1.0, 1e-3);
}

TEST(RoundPart, CornersAndLinesThatMeetAnEdgeTwiceAreRefused) {
  const Surface sheet = level_plane(0.0, true);
  const auto square =
      make_polygon_loop(sheet.u, sheet.v, {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}}).value();
  EXPECT_FALSE(untrimmed(sheet, {square, circle(sheet, 0.01, true)}, 1e-6));
  // The loop is a kidney, which is not star-shaped about its centroid.
  std::vector<Eigen::Vector2d> kidney;
  for (int k = 0; k < 720; ++k) {
    const double turn = 2.0 * pi * k / 720, reach = 0.1 + 0.28 * std::sin(turn / 2.0);
    kidney.emplace_back(0.45 + reach * std::cos(turn), 0.5 + reach * std::sin(turn));
  }
  EXPECT_FALSE(
      resample_round_part(sheet, {kidney, {{0.7, 0.5}, {0.7, 0.51}, {0.71, 0.5}}}, 1e-6).has_value());
}

}  // namespace
}  // namespace spoonbill
