// Tests edges with small gaps. They are cut back and blended, so that the surface has no step or fold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

// Returns a tube about the y axis.
Surface tube(double from, double to, double radius, const Vector3& shift = Vector3::Zero()) {
  const auto u = KnotVector::periodic_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, 9).value();
  PointGrid points{uniform_parameters_without_seam(u, 96), uniform_parameters(v, 30), {}};
  for (const double a : points.u) {
    const double angle = 2.0 * std::numbers::pi * a;
    for (const double b : points.v) {
      points.points_m.push_back(
          Vector3(radius * std::cos(angle), from + b * (to - from), radius * std::sin(angle)) + shift);
    }
  }
  return fit_grid(u, v, points).value();
}

// Returns the smallest cosine of the angle between two normals on a line of constant u: a normal in the blend
// and the normal at the start of the blend.
double least_cosine(const Merged& merged) {
  const Joint& joint = merged.joints[0].joint;
  double least = 1.0;
  for (double u = 0.0; u < 1.0; u += 0.05) {
    const Vector3 first = unit_normal(merged.surface, u, joint.blend_start);
    for (int k = 0; k <= 60; ++k) {
      const double v = joint.blend_start + (joint.blend_end - joint.blend_start) * k / 60;
      least = std::min(least, unit_normal(merged.surface, u, v).dot(first));
    }
  }
  return least;
}

TEST(Blend, TubesThatMissEachOtherByLittleAreCutBack) {
  const Surface low = tube(0.0, 0.04, 0.01);
  for (const Surface& high : {tube(0.04, 0.08, 0.01, Vector3(6e-5, 0, 0)), tube(0.04 - 6e-5, 0.08, 0.01),
                              tube(0.04, 0.08, 0.0103), tube(0.04, 0.08, 0.01, Vector3(3e-4, 0, 0))}) {
    for (const int continuity : {0, 1, 2, 4}) {
      const auto merged = merge({low, high}, request_of(continuity));
      ASSERT_TRUE(merged.ok()) << merged.error().message;
      EXPECT_FALSE(find_fold(merged->surface).has_value());
      EXPECT_GT(least_cosine(merged.value()), std::cos(0.3)) << continuity;
      EXPECT_LE(merged->deviation_m, 5e-5);
      const Joint& joint = merged->joints[0].joint;
      EXPECT_GE(joint.blend_length_m, 9.9 * joint.apart_m);
      EXPECT_NEAR(2.0 * joint.cut_back_m, joint.blend_length_m, 0.1 * joint.blend_length_m + joint.apart_m);
    }
  }
}

// Both edges approximate one curve. With degrees 2 and 4, and 7 and 19 control points, they deviate from it
// on both sides by more than the tolerance.
TEST(Blend, SheetsWhoseEdgesMissEachOtherToEitherSide) {
  const auto sheet = [](int degree, int count, double start, double end) {
    const auto u = KnotVector::clamped_uniform(degree, count).value();
    PointGrid points{uniform_parameters(u, 80), uniform_parameters(u, 80), {}};
    for (const double a : points.u) {
      for (const double b : points.v) {
        points.points_m.emplace_back(0.06 * a, 0.004 * std::sin(9.0 * a), start + (end - start) * b);
      }
    }
    return fit_grid(u, u, points).value();
  };
  const auto merged = merge({sheet(2, 7, 0.0, 0.04), sheet(4, 19, 0.04, 0.09)}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  ASSERT_TRUE(merged->joints[0].joint.bridged);
  EXPECT_FALSE(find_fold(merged->surface).has_value());
  EXPECT_GT(least_cosine(merged.value()), std::cos(0.5));
}

TEST(Blend, TheLengthAskedHoldsForGapsToo) {
  MergeRequest request = request_of(2);
  request.join.blend_m = 0.008;
  for (const double gap : {-0.001, 3e-4, 0.002}) {
    const auto merged = merge({tube(0.0, 0.04, 0.01), tube(0.04 + gap, 0.08, 0.0103)}, request);
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_NEAR(merged->joints[0].joint.blend_length_m, 0.008, 1e-4) << gap;
  }
  request.join.blend_m = 1.0;
  const auto longer = merge({tube(0.0, 0.04, 0.01), tube(0.042, 0.08, 0.01)}, request);
  ASSERT_FALSE(longer.ok());
  EXPECT_EQ(longer.error().code, ErrorCode::out_of_range);
  EXPECT_EQ(longer.error().field, "blend");
}

// A cubic sheet is C2 at its knots and polynomial between them, so its third derivatives jump only at knots.
TEST(Blend, IsMadeWhereTheThirdDerivativesDiffer) {
  const auto sheet =
      sheet_between([](double) { return 0.0; }, [](double x) { return 0.04 + 0.004 * std::sin(200.0 * x); });
  const Surface bent = exchanged(sheet);
  const std::vector<double> knots = bent.v.breakpoints();
  for (const bool at_knot : {true, false}) {
    const double place = at_knot ? knots[4] : 0.5 * (knots[4] + knots[5]);
    const std::vector<Surface> parts{part_of(bent, Direction::v, 0.0, place).value(),
                                     part_of(bent, Direction::v, place, 1.0).value()};
    for (const int continuity : {2, 3, 4}) {
      MergeRequest request = request_of(continuity);
      request.join.blend_m = 0.004;
      const auto merged = merge(parts, request);
      ASSERT_TRUE(merged.ok()) << merged.error().message;
      EXPECT_EQ(merged->joints[0].joint.bridged, at_knot && continuity > 2) << at_knot << continuity;
    }
  }
}

TEST(Blend, PatchesThatOverlapByFarAreRefused) {
  const auto merged = merge({tube(0.0, 0.04, 0.01), tube(0.025, 0.08, 0.009)}, request_of(2));
  ASSERT_FALSE(merged.ok());
  EXPECT_EQ(merged.error().code, ErrorCode::mismatch);
  EXPECT_NE(merged.error().message.find("overlap by 15 mm"), std::string::npos) << merged.error().message;
}

TEST(Blend, APatchIsNotMergedWithItself) {
  const Surface sheet = level_sheet(0.0, 0.04);
  for (const Surface& other : {sheet, orient(sheet, {true, false, true})}) {
    const auto merged = merge({level_sheet(0.06, 0.1), sheet, other}, request_of(2));
    ASSERT_FALSE(merged.ok());
    EXPECT_EQ(merged.error().code, ErrorCode::duplicate);
    EXPECT_TRUE(merged.error().message.starts_with("patches 2 and 3 ")) << merged.error().message;
  }
}

// Returns two planes that meet at an angle; 180 degrees is flat.
std::vector<Surface> planes_at(double angle) {
  const auto flat = [](double from, double to) {
    return sheet_between([=](double) { return from; }, [=](double) { return to; });
  };
  Surface second = flat(0.04, 0.08);
  for (std::size_t k = 0; k < second.net.size(); ++k) {
    const double away = second.net.z[k] - 0.04;
    second.net.y[k] = std::sin(angle) * away;
    second.net.z[k] = 0.04 - std::cos(angle) * away;
  }
  return {flat(0.0, 0.04), second};
}

TEST(Blend, AnEdgeTooSharpToBeRoundedWithinTheToleranceIsRefused) {
  for (const double degrees : {5.0, 30.0}) {
    const auto patches = planes_at(degrees / 180.0 * std::numbers::pi);
    MergeRequest request = request_of(2);
    request.chosen = {{{0, Side::v_end}, {1, Side::v_start}}};
    const auto merged = merge(patches, request);
    ASSERT_FALSE(merged.ok()) << degrees;
    EXPECT_EQ(merged.error().code, ErrorCode::self_intersecting) << merged.error().message;
    request.join.continuity = 0;
    EXPECT_TRUE(merge(patches, request).ok()) << degrees;
  }
  const auto merged = merge(planes_at(0.5 * std::numbers::pi), request_of(2));
  EXPECT_TRUE(merged.ok()) << merged.error().message;
}

}  // namespace
}  // namespace spoonbill
