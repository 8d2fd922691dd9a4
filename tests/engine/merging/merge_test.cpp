#include "engine/merging/merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

double largest_difference(const Surface& a, const Surface& b) {
  const PointGrid points = sample_grid_points(b, uniform_parameters(b.u, 41), uniform_parameters(b.v, 41));
  return largest_deviation_m(a, points);
}

Surface smooth_sheet(Random& random, int degree, int rows, int columns) {
  return random_surface(random, KnotVector::clamped_uniform(degree, rows).value(),
                        KnotVector::clamped_uniform(degree, columns).value());
}

Orientation any_orientation(Random& random) {
  return {random.integer(0, 1) == 1, random.integer(0, 1) == 1, random.integer(0, 1) == 1};
}

TEST(Merge, GivesASplitSurfaceBackAtEveryDegree) {
  Random random(71);
  for (int degree = 2; degree <= 5; ++degree) {
    for (int repeat = 0; repeat < 25; ++repeat) {
      const Surface whole = smooth_sheet(random, degree, 8, 9);
      // The cut is at an arbitrary parameter, or just beside a knot.
      const double inner = knots_along(whole, Direction::u).breakpoints()[1];
      const double cut =
          repeat % 2 == 0 ? random.uniform(0.05, 0.95) : inner + std::pow(10.0, -random.uniform(1.5, 6.0));
      const Direction along = random.integer(0, 1) == 0 ? Direction::u : Direction::v;
      const std::vector<Surface> parts{part_of(whole, along, 0.0, cut).value(),
                                       part_of(whole, along, cut, 1.0).value()};
      const auto merged = merge(parts, request_of(degree - 1));
      ASSERT_TRUE(merged.ok()) << merged.error().message;
      EXPECT_LT(merged->deviation_m, 1e-12);
      EXPECT_LT(largest_difference(whole, merged->surface), 1e-12) << degree << " " << cut;
      const KnotVector& knots = knots_along(merged->surface, along);
      EXPECT_EQ(knots.control_point_count(), knots_along(whole, along).control_point_count() + 1);
    }
  }
}

// Two cubics (degree p = 3) with r1 = r2 = 5 control points along v become one with r1 + r2 + m - p - 1,
// where m = p - continuity is the multiplicity of the knot at the joint.
TEST(Merge, CountsControlPointsByContinuity) {
  Random random(72);
  const auto knots = KnotVector::open(3, {0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1}).value();
  const Surface whole = random_surface(random, KnotVector::clamped_uniform(3, 6).value(), knots);
  const std::vector<Surface> parts{part_of(whole, Direction::v, 0.0, 0.5).value(),
                                   part_of(whole, Direction::v, 0.5, 1.0).value()};
  for (const auto& [continuity, count] : {std::pair(0, 9), std::pair(1, 8), std::pair(2, 7)}) {
    const auto merged = merge(parts, request_of(continuity));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_EQ(merged->surface.v.control_point_count(), count);
    EXPECT_LT(largest_difference(whole, merged->surface), 1e-14);
  }
}

TEST(Merge, GridsInAnyOrderAndHeldInAnyWay) {
  Random random(73);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Surface whole = smooth_sheet(random, 3, 10, 11);
    const double cuts[] = {0.0, random.uniform(0.2, 0.4), random.uniform(0.5, 0.8), 1.0};
    std::vector<Surface> parts;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        const Surface strip = part_of(whole, Direction::u, cuts[a], cuts[a + 1]).value();
        const Surface cell = part_of(strip, Direction::v, cuts[b], cuts[b + 1]).value();
        parts.push_back(parts.empty() ? cell : orient(cell, any_orientation(random)));
      }
    }
    for (std::size_t k = parts.size() - 1; k > 1; --k) {
      std::swap(parts[k], parts[static_cast<std::size_t>(random.integer(1, static_cast<int>(k)))]);
    }
    const auto merged = merge(parts, request_of(2));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_LT(largest_difference(whole, merged->surface), 1e-11);
    EXPECT_EQ(merged->joints.size(), 12u);  // six in each direction
  }
}

// The edges at z = 0 differ in their degrees and numbers of control points.
TEST(Merge, PatchesOfOtherDegreesAndCounts) {
  const auto sheet = [](int degree, int count, double start, double end) {
    const auto u = KnotVector::clamped_uniform(degree, count).value();
    const auto v = KnotVector::clamped_uniform(degree, count).value();
    PointGrid points{uniform_parameters(u, 80), uniform_parameters(v, 80), {}};
    for (const double a : points.u) {
      for (const double b : points.v) {
        const double y = start + (end - start) * b;
        points.points_m.emplace_back(0.1 * a, y, 0.01 * std::sin(2.0 * a) * y / 0.05);
      }
    }
    return fit_grid(u, v, points).value();
  };
  const std::vector<Surface> parts{sheet(2, 7, -0.05, 0.0), sheet(4, 19, 0.0, 0.08)};
  const auto merged = merge(parts, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LE(merged->deviation_m, 5e-5);
  // The sheet is one analytic surface; the quadratic patch has the largest error.
  for (double u = 0.0; u <= 1.0; u += 0.05) {
    const KnotVector& v = merged->surface.v;
    for (double share = 0.0; share <= 1.0; share += 0.02) {
      const Vector3 p =
          position(merged->surface, u, v.domain_start() + share * (v.domain_end() - v.domain_start()));
      EXPECT_NEAR(p.z(), 0.01 * std::sin(20.0 * p.x()) * p.y() / 0.05, 1e-4);
    }
  }
}

// Fits |u - 1/2| with four equal pieces to 41 samples. With C0 at the kink, no error is left. With C1 and C2,
// an error of 3.52e-2 is left before knots are added.
TEST(Merge, TheKinkOfTheLiterature) {
  const auto u = KnotVector::clamped_uniform(1, 2).value();
  for (const auto& [multiplicity, residual] :
       {std::pair(3, 0.0), std::pair(2, 3.52e-2), std::pair(1, 3.52e-2)}) {
    std::vector<double> knots{0, 0, 0, 0, 0.25};
    knots.insert(knots.end(), static_cast<std::size_t>(multiplicity), 0.5);
    for (const double knot : {0.75, 1.0, 1.0, 1.0, 1.0}) knots.push_back(knot);
    const auto v = KnotVector::open(3, knots).value();
    PointGrid points{{0.0, 0.5, 1.0}, uniform_parameters(v, 41), {}};
    for (const double a : points.u) {
      for (const double b : points.v) points.points_m.emplace_back(a, b, std::abs(b - 0.5));
    }
    // The published table gives three digits; a zero residual is rounding.
    EXPECT_NEAR(largest_deviation_m(fit_grid(u, v, points).value(), points), residual,
                residual > 0 ? 5e-5 : 1e-14);
  }
}

// Returns two planes that meet at a right angle.
std::vector<Surface> roof() {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  const auto plane = [&](const Vector3& from, const Vector3& across, const Vector3& along) {
    PointGrid points{uniform_parameters(knots, 20), uniform_parameters(knots, 20), {}};
    for (const double a : points.u) {
      for (const double b : points.v) points.points_m.push_back(from + a * across + b * along);
    }
    return fit_grid(knots, knots, points).value();
  };
  const Vector3 width(0.04, 0, 0);
  return {plane({0, 0, 0}, width, {0, 0.03, 0.03}), plane({0, 0.03, 0.03}, width, {0, 0.03, -0.03})};
}

TEST(Merge, AKinkBecomesC2WithinTheTolerance) {
  const auto merged = merge(roof(), request_of(2, 5e-5));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LE(merged->deviation_m, 5e-5);
  EXPECT_GT(merged->deviation_m, 1e-9);  // a smooth surface cannot follow the kink exactly
  for (const auto& [knot, multiplicity] : knot_multiplicities(merged->surface.v)) {
    if (knot > merged->surface.v.domain_start()) {
      EXPECT_EQ(multiplicity, 1) << knot;
    }
  }
}

// The test samples the surface far more densely than merge() does to measure the deviation.
TEST(Merge, NoPointIsFartherThanTold) {
  const auto roofs = roof();
  for (const double tolerance_m : {1e-3, 2e-4, 5e-5}) {
    const auto merged = merge(roofs, request_of(2, tolerance_m));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    const Surface& surface = merged->surface;
    const double start = surface.v.domain_start(), end = surface.v.domain_end();
    double farthest = 0.0;
    for (int k = 0; k <= 20000; ++k) {
      const Vector3 p = position(surface, 0.5, start + (end - start) * k / 20000);
      farthest = std::max(farthest, std::abs(p.z() - 0.03 + std::abs(p.y() - 0.03)) / std::numbers::sqrt2);
    }
    EXPECT_LE(farthest, merged->deviation_m) << tolerance_m;
  }
}

TEST(Merge, AKinkIsBlendedOverTheLengthAsked) {
  MergeRequest request = request_of(2);
  request.join.blend_m = 0.01;
  const auto merged = merge(roof(), request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  ASSERT_EQ(merged->joints.size(), 1u);
  const Joint& joint = merged->joints[0].joint;
  EXPECT_TRUE(joint.bridged);
  EXPECT_LT(merged->deviation_m, 1e-12);
  // The blend runs from 5 mm before the ridge to 5 mm behind it. Its length is between the chord and the path
  // over the ridge.
  EXPECT_LT(joint.blend_length_m, 0.01);
  EXPECT_GT(joint.blend_length_m, 0.005 * std::numbers::sqrt2);
  const Vector3 start = position(merged->surface, 0.5, joint.blend_start);
  EXPECT_NEAR((start - Vector3(0.02, 0.03, 0.03)).norm(), 0.005, 1e-9);
}

TEST(Merge, RingsAreTurnedUntilTheirSeamsMeet) {
  for (const bool backwards : {false, true}) {
    Surface after = ring_strip(0.03, 0.08, 20, 0.37);
    if (backwards) after = reversed(after, Direction::u);
    const auto merged = merge({ring_strip(0.0, 0.03, 16, 0.0), after}, request_of(2));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_LE(merged->deviation_m, 5e-5);
    const Surface& surface = merged->surface;
    for (double v = 0.0; v <= 1.0; v += 0.05) {
      const double at = v * surface.v.domain_end();
      // The seam stays in the plane of the first ring's seam.
      EXPECT_NEAR(position(surface, 0.0, at).y(), 0.0, 5e-5);
      const Vector3 p = position(surface, 0.3, at);
      EXPECT_NEAR(p.head<2>().norm(), 0.01 + 0.1 * p.z(), 5e-5);
    }
  }
}

TEST(Merge, EdgesWhoseParametersDifferAreMatched) {
  const auto knots = KnotVector::clamped_uniform(3, 12).value();
  const auto sheet = [&](double start, double end, double bend) {
    PointGrid points{uniform_parameters(knots, 60), uniform_parameters(knots, 60), {}};
    for (const double a : points.u) {
      for (const double b : points.v) {
        const double t = a + bend * a * (1.0 - a);
        points.points_m.emplace_back(0.1 * t, start + (end - start) * b, 0.01 * std::sin(3.0 * t));
      }
    }
    return fit_grid(knots, knots, points).value();
  };
  const auto merged = merge({sheet(0.0, 0.04, 0.0), sheet(0.04, 0.09, 0.4)}, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LE(merged->deviation_m, 5e-5);
  for (double u = 0.0; u <= 1.0; u += 0.1) {
    const Vector3 p = position(merged->surface, u, 0.9 * merged->surface.v.domain_end());
    EXPECT_NEAR(p.x(), 0.1 * u, 1e-4);  // the result has the first patch's parameters everywhere
  }
}

TEST(Merge, GivesASplitPipeBackHoweverItIsHeld) {
  Random random(77);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const int degree = 1 + repeat % 5;
    const Surface whole = random_surface(random, KnotVector::periodic_uniform(degree, 9).value(),
                                         KnotVector::clamped_uniform(3, 8).value());
    const double cut = random.uniform(0.1, 0.9);
    std::vector<Surface> parts{part_of(whole, Direction::v, 0.0, cut).value(),
                               part_of(whole, Direction::v, cut, 1.0).value()};
    const double seam = random.uniform(0.0, 1.0);
    parts[1] = with_seam_at(parts[1], Direction::u, seam).value();
    const Orientation of_first{repeat % 2 == 1, false, false};
    parts[0] = orient(parts[0], of_first);
    parts[1] = orient(parts[1], any_orientation(random));
    const auto merged = merge(parts, request_of(2));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_LT(merged->deviation_m, 1e-11) << degree;
    EXPECT_LT(largest_difference(orient(whole, of_first), merged->surface), 1e-11) << degree;
    EXPECT_EQ((of_first.exchanged ? merged->surface.v : merged->surface.u).degree(), degree);
  }
}

TEST(Merge, PatchesOfAGridOverOtherDomains) {
  Random random(76);
  const Surface whole = smooth_sheet(random, 3, 10, 11);
  std::vector<Surface> parts;
  for (const auto& [u_from, u_to] : {std::pair(0.0, 0.4), std::pair(0.4, 1.0)}) {
    const Surface strip = part_of(whole, Direction::u, u_from, u_to).value();
    for (const auto& [v_from, v_to] : {std::pair(0.0, 0.6), std::pair(0.6, 1.0)}) {
      parts.push_back(part_of(strip, Direction::v, v_from, v_to).value());
    }
  }
  parts[1] = with_domain(parts[1], Direction::u, -2.0, 7.0).value();
  parts[3] = with_domain(parts[3], Direction::v, 3.0, 4.0).value();
  const auto merged = merge(parts, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LT(merged->deviation_m, 1e-11);
  EXPECT_LT(largest_difference(whole, merged->surface), 1e-11);
}

// Returns the four patches of a roof whose ridge fades out towards half of the width; the other half is
// level.
std::vector<Surface> fading_roof(double lift) {
  std::vector<Surface> parts;
  for (const double x : {0.0, 0.03}) {
    for (const double z : {0.0, 0.05}) {
      const auto knots = KnotVector::clamped_uniform(3, 9).value();
      PointGrid points{uniform_parameters(knots, 40), uniform_parameters(knots, 40), {}};
      for (const double a : points.u) {
        for (const double b : points.v) {
          const double at_x = x + 0.03 * a, at_z = z + 0.05 * b, left = std::max(0.0, 0.03 - at_x);
          const double up = lift * (z > 0.0 ? left / 0.03 : 0.0);
          points.points_m.emplace_back(at_x, up - std::max(0.0, at_z - 0.05) * 300.0 * left * left, at_z);
        }
      }
      parts.push_back(fit_grid(knots, knots, points).value());
    }
  }
  return parts;
}

TEST(Merge, AGridIsBlendedInAllRowsAlike) {
  MergeRequest request = request_of(2);
  request.join.blend_m = 0.01;
  const auto merged = merge(fading_roof(0.0), request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(is_without_folds(merged->surface));
  int along_v = 0;
  for (const MergedJoint& joint : merged->joints) {
    if (joint.along != Direction::v) continue;
    ++along_v;
    EXPECT_TRUE(joint.joint.bridged);
    EXPECT_NEAR(joint.joint.gap_m, 0.01, 1e-4);
  }
  EXPECT_EQ(along_v, 2);
  // The gap is 1 mm wide at one end of the joint and closed at the other.
  const auto mixed = merge(fading_roof(0.001), request_of(2));
  ASSERT_FALSE(mixed.ok());
  EXPECT_EQ(mixed.error().code, ErrorCode::mismatch) << mixed.error().message;
}

// Two slopes meet at a ridge, and their edges differ by less than the tolerance. The movement of the edges
// and the rounding of the ridge must together be within the tolerance.
TEST(Merge, TheToleranceHoldsForAllOfADeviation) {
  for (const Vector3& moved : {Vector3(2.63e-5, -2.72e-5, -3.25e-5), Vector3(0, 4.5e-5, 0),
                               Vector3(0, 0, -4.5e-5), Vector3(4.5e-5, 0, 0)}) {
    const auto slope = [&](double side, const Vector3& shift) {
      Surface sheet = sheet_between([](double) { return 0.0; }, [](double) { return 0.05; });
      for (std::size_t k = 0; k < sheet.net.size(); ++k) {
        sheet.net.y[k] = 0.725 * (side > 0.0 ? 0.05 - sheet.net.z[k] : sheet.net.z[k]);
        if (side > 0.0) sheet.net.z[k] += 0.05;
      }
      return placed(sheet, {shift, Quaternion::Identity()});
    };
    const auto merged = merge({slope(-1.0, Vector3::Zero()), slope(1.0, moved)}, request_of(2, 5e-5));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_LE(merged->deviation_m, 5e-5);
    EXPECT_FALSE(merged->joints[0].joint.bridged);
  }
}

TEST(Merge, MoreThanCanBeHandledIsRefusedAtOnce) {
  std::vector<Surface> parts{level_sheet(0.0, 0.04, 150), level_sheet(0.04, 0.1, 150)};
  const auto merged = merge(parts, request_of(2));
  ASSERT_FALSE(merged.ok());
  EXPECT_EQ(merged.error().code, ErrorCode::too_many);
  EXPECT_NE(merged.error().message.find("297 control points"), std::string::npos) << merged.error().message;
  const auto many = merge(std::vector<Surface>(65, parts[0]), request_of(2));
  ASSERT_FALSE(many.ok());
  EXPECT_EQ(many.error().code, ErrorCode::too_many);
  EXPECT_NE(many.error().message.find("65 patches"), std::string::npos);
}

TEST(Merge, RefusesWhatMakesNoGrid) {
  Random random(75);
  const Surface whole = smooth_sheet(random, 3, 8, 9);
  const Surface left = part_of(whole, Direction::u, 0.0, 0.5).value();
  const Surface right = part_of(whole, Direction::u, 0.5, 1.0).value();
  const Surface corner = part_of(left, Direction::v, 0.0, 0.5).value();
  EXPECT_FALSE(merge({}, request_of(2)).ok());
  EXPECT_FALSE(merge({corner, right, part_of(right, Direction::v, 0.0, 0.5).value()}, request_of(2)).ok());
  const auto mixed = merge({ring_strip(0, 0.02, 12, 0), left}, request_of(2));
  ASSERT_FALSE(mixed.ok());
}

}  // namespace
}  // namespace spoonbill
