#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/merging/merge.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

TEST(Bridge, AGapIsBridgedSmoothly) {
  const auto merged = merge({ring_strip(0.0, 0.03, 16, 0.0), ring_strip(0.04, 0.08, 20, 0.2)}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  ASSERT_EQ(merged->joints.size(), 1u);
  EXPECT_TRUE(merged->joints[0].joint.bridged);
  // The chords across the gap of 10 mm have a slope of 0.1.
  EXPECT_NEAR(merged->joints[0].joint.gap_m, 0.01 * std::hypot(1.0, 0.1), 1e-5);
  EXPECT_LT(merged->deviation_m, 1e-9);
  // Both strips are parts of one cone, so the bridge that continues them straight is on the cone, too.
  const Surface& surface = merged->surface;
  for (double share = 0.0; share <= 1.0; share += 0.02) {
    const Vector3 p = position(surface, 0.7, share * surface.v.domain_end());
    EXPECT_NEAR(p.head<2>().norm(), 0.01 + 0.1 * p.z(), 2e-5);
  }
}

// Fits of scans end in irregular edges. If a long bridge continued these irregularities, they would grow into
// folds.
TEST(Bridge, RingsThatEndUnevenlyAreBridgedOverALongGap) {
  Surface first = ring_strip(0.0, 0.03, 16, 0.0), second = ring_strip(0.12, 0.15, 20, 0.2);
  for (Surface* ring : {&first, &second}) {
    const int column = ring == &first ? ring->net.columns - 2 : 1;
    for (int i = 0; i < ring->net.rows; ++i) {
      const Vector3 way(0.003 * (i % 2 == 0 ? 1 : -1), 0.003 * (i % 3 - 1),
                        0.001 * ((i / 2) % 2 == 0 ? 1 : -1));
      ring->net.set_point(i, column, ring->net.point(i, column) + way);
    }
  }
  const auto merged = merge({first, second}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(merged->joints[0].joint.bridged);
  EXPECT_TRUE(is_without_folds(merged->surface));
  EXPECT_LT(merged->deviation_m, 1e-9);
}

TEST(Bridge, AGapAsLongAsTheParametersSayIsBridged) {
  const auto merged = merge({level_sheet(0.0, 0.04), level_sheet(0.06, 0.1)}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(merged->joints[0].joint.bridged);
  EXPECT_NEAR(merged->joints[0].joint.gap_m, 0.02, 1e-12);
  EXPECT_NEAR(position(merged->surface, 0.5, 0.05).z(), 0.05, 1e-12);
}

bool is_monotone_in_z(const Surface& surface) {
  const double start = surface.v.domain_start(), end = surface.v.domain_end();
  for (double u = 0.0; u <= 1.0; u += 0.05) {
    double last = position(surface, u, start).z();
    for (int k = 1; k <= 400; ++k) {
      const double next = position(surface, u, start + (end - start) * k / 400).z();
      if (next < last) return false;
      last = next;
    }
  }
  return true;
}

TEST(Bridge, AWedgeShapedGapIsBridgedWithoutAFold) {
  const auto flat = [](double z) { return [z](double) { return z; }; };
  const Surface low = sheet_between(flat(0.0), flat(0.04));
  // The gap is from 0.1 mm to 4.1 mm wide.
  const auto merged =
      merge({low, sheet_between([](double x) { return 0.0401 + x / 15.0; }, flat(0.09))}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(is_monotone_in_z(merged->surface));
  // The edges coincide, but their parameters are shifted by 3 mm. The tolerance is too small for the fits to
  // agree.
  const auto askew = merge({low, sheet_between(flat(0.04), flat(0.09), 0.2)}, request_of(2, 1e-16));
  ASSERT_FALSE(askew.ok());
  EXPECT_EQ(askew.error().code, ErrorCode::self_intersecting) << askew.error().message;
}

// Returns a tube along a line between two points. u starts in the direction `seam` and runs around the line,
// right-handed by default, with a speed that varies by `warp`.
Surface pipe(const Vector3& from, const Vector3& to, const Vector3& seam, bool left_handed = false,
             double warp = 0.0) {
  const auto u = KnotVector::periodic_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{uniform_parameters_without_seam(u, 96), uniform_parameters(v, 20), {}};
  const Vector3 along = (to - from).normalized(), side = along.cross(seam) * (left_handed ? -1.0 : 1.0);
  for (const double a : points.u) {
    const double angle = 2.0 * std::numbers::pi * a + warp * std::sin(2.0 * std::numbers::pi * a);
    for (const double b : points.v) {
      points.points_m.push_back(from + b * (to - from) +
                                0.008 * (std::cos(angle) * seam + std::sin(angle) * side));
    }
  }
  return fit_grid(u, v, points).value();
}

// Returns the smallest area enclosed by a ring of the tube.
double least_section_m2(const Surface& tube) {
  const double start = tube.v.domain_start(), end = tube.v.domain_end();
  double least = 1.0;
  for (int k = 0; k <= 200; ++k) {
    Vector3 twice = Vector3::Zero();
    Vector3 last = position(tube, 0.0, start + (end - start) * k / 200);
    for (int i = 1; i <= 64; ++i) {
      const Vector3 next = position(tube, i / 64.0, start + (end - start) * k / 200);
      twice += last.cross(next);
      last = next;
    }
    least = std::min(least, 0.5 * twice.norm());
  }
  return least;
}

TEST(Bridge, PipesSideBySideAreJoinedByABend) {
  for (const bool left_handed : {false, true}) {
    MergeRequest request = request_of(2);
    request.chosen = {{{0, Side::v_end}, {1, Side::v_end}}};
    const Vector3 x(1, 0, 0);
    const auto merged = merge({pipe({0, 0, 0}, {0, 0.06, 0}, x),
                               pipe({0.06, 0, 0}, {0.06, 0.06, 0}, Vector3(0.6, 0, 0.8), left_handed)},
                              request);
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    const Surface& surface = merged->surface;
    EXPECT_TRUE(is_without_folds(surface));
    EXPECT_GT(least_section_m2(surface), 0.8 * std::numbers::pi * 6.4e-5);
    for (double u = 0.0; u < 1.0; u += 0.1) {
      const Vector3 start = position(surface, u, 0.0), end = position(surface, u, surface.v.domain_end());
      // The ends of the two pipes are mirror images in x. Points on the inside of the bend of one pipe are
      // joined to points on the inside of the other.
      EXPECT_NEAR(end.x(), 0.06 - start.x(), 1e-5);
      EXPECT_NEAR(end.z(), start.z(), 1e-5);
    }
  }
}

TEST(Bridge, PipesAtARightAngleAreJoinedByABend) {
  for (const bool left_handed : {false, true}) {
    for (const double seam : {0.0, 1.0, 2.5}) {
      const auto merged =
          merge({pipe({0, 0, 0}, {0, 0.06, 0}, {1, 0, 0}),
                 pipe({0.04, 0.1, 0}, {0.09, 0.1, 0}, {0, std::cos(seam), std::sin(seam)}, left_handed)},
                request_of(2));
      ASSERT_TRUE(merged.ok()) << merged.error().message;
      EXPECT_TRUE(is_without_folds(merged->surface));
      EXPECT_GT(least_section_m2(merged->surface), 0.8 * std::numbers::pi * 6.4e-5);
      const Vector3 inner = position(merged->surface, 0.0, merged->surface.v.domain_end());
      EXPECT_NEAR(inner.y(), 0.1 - 0.008, 1e-5);
    }
  }
}

TEST(Bridge, ACupsTwoWallsAreJoinedAtItsRim) {
  Surface inner = pipe({0, 0, 0}, {0, 0.06, 0}, {1, 0, 0});
  for (double& x : inner.net.x) x *= 0.5;
  for (double& z : inner.net.z) z *= 0.5;
  MergeRequest request = request_of(2);
  request.chosen = {{{0, Side::v_end}, {1, Side::v_end}}};
  const auto merged = merge({pipe({0, 0, 0}, {0, 0.06, 0}, {1, 0, 0}), inner}, request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(is_without_folds(merged->surface));
  const Vector3 end = position(merged->surface, 0.0, merged->surface.v.domain_end());
  EXPECT_NEAR((end - Vector3(0.004, 0, 0)).norm(), 0.0, 1e-5);
}

TEST(Bridge, RingsWhoseParametersDifferAreMatched) {
  const auto merged = merge({pipe({0, 0, 0}, {0, 0.03, 0}, {1, 0, 0}),
                             pipe({0, 0.03, 0}, {0, 0.06, 0}, Vector3(0.8, 0, 0.6), false, 0.4)},
                            request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_FALSE(merged->joints[0].joint.bridged);
  EXPECT_LE(merged->deviation_m, 5e-5);
  for (double u = 0.0; u < 1.0; u += 0.05) {
    const Vector3 low = position(merged->surface, u, 0.0);
    const Vector3 high = position(merged->surface, u, merged->surface.v.domain_end());
    EXPECT_NEAR((high - low - Vector3(0, 0.06, 0)).norm(), 0.0, 1e-4) << u;
  }
}

}  // namespace
}  // namespace spoonbill
