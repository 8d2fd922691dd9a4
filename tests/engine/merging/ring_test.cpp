// Tests rows and grids of patches whose last edges meet their first edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/tube_ends.h"
#include "tests/engine/merging/made_patches.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

std::vector<Surface> parts_of(const Surface& whole, Direction direction, const std::vector<double>& places) {
  std::vector<Surface> parts;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    parts.push_back(part_of(whole, direction, places[k], places[k + 1]).value());
  }
  return parts;
}

// Returns a body of revolution about the z axis, with a waist and poles.
Surface turned_body() {
  const auto u = KnotVector::periodic_uniform(3, 20).value();
  const auto v = KnotVector::clamped_uniform(3, 16).value();
  PointGrid points{uniform_parameters_without_seam(u, 60), uniform_parameters(v, 64), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      const double out = 0.02 * std::sin(pi * b) * (1.0 - 0.3 * std::sin(pi * b)), turn = -2 * pi * a;
      points.points_m.emplace_back(out * std::cos(turn), out * std::sin(turn), 0.03 * std::cos(pi * b));
    }
  }
  return fit_grid(u, v, points, {false, false, true, true}).value();
}

// Returns the parallelogram that has the edge from a to b and the sides `height`.
Surface plate(const Vector3& a, const Vector3& b, const Vector3& height) {
  const auto knots = KnotVector::clamped_uniform(1, 2).value();
  ControlNet net(2, 2);
  net.set_point(0, 0, a);
  net.set_point(1, 0, b);
  net.set_point(0, 1, a + height);
  net.set_point(1, 1, b + height);
  return {knots, knots, net};
}

std::vector<Surface> square_tube() {
  const Vector3 height(0, 0, 0.05);
  const std::vector<Vector3> corners{{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.02, 0}, {0, 0.02, 0}};
  std::vector<Surface> plates;
  for (std::size_t k = 0; k < 4; ++k) plates.push_back(plate(corners[k], corners[(k + 1) % 4], height));
  return plates;
}

TEST(Ring, ABodyOfRevolutionCutInFourIsOneAgain) {
  const Surface whole = turned_body();
  std::vector<Surface> parts = parts_of(whole, Direction::u, {0.1, 0.33, 0.6, 0.9, 1.1});
  // The patches may be given in any orientation and order.
  std::swap(parts[1], parts[2]);
  parts[3] = reversed(parts[3], Direction::v);
  for (const int continuity : {0, 1, 2}) {
    const auto merged = merge(parts, request_of(continuity));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    const Surface& surface = merged->surface;
    ASSERT_TRUE(surface.u.is_periodic());
    EXPECT_TRUE(is_pole(surface, Side::v_start));
    EXPECT_TRUE(is_pole(surface, Side::v_end));
    EXPECT_LT(merged->deviation_m, 1e-11);
    EXPECT_TRUE(merged->left_open.empty());
    const double volume_m3 = compute_enclosed_mass(whole).volume_m3;
    EXPECT_NEAR(compute_enclosed_mass(surface).volume_m3, volume_m3, 1e-9 * volume_m3);
    ASSERT_EQ(merged->joints.size(), 4U);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(merged->joints[k].closes, k == 3);
    EXPECT_EQ(merged->joints[3].along, Direction::u);
  }
}

TEST(Ring, FourPlatesMakeASquareTubeWithAnEdgeAtItsSeam) {
  const auto merged = merge(square_tube(), request_of(0));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  const Surface& surface = merged->surface;
  ASSERT_TRUE(surface.u.is_periodic());
  EXPECT_LT(merged->deviation_m, 1e-12);
  const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
  for (double share = 0.0; share < 1.0; share += 0.01) {
    const Vector3 p = position(surface, start + share * length, 0.5);
    const double off = std::max(std::abs(p.x() - 0.01), std::abs(p.y() - 0.01));
    EXPECT_NEAR(off, 0.01, 1e-12);
  }
  const Vector3 seam = position(surface, start, 0.5) - Vector3(0.01, 0.01, 0);
  EXPECT_NEAR(std::abs(seam.x()), 0.01, 1e-12);
  EXPECT_NEAR(std::abs(seam.y()), 0.01, 1e-12);
}

TEST(Ring, ASharpSeamIsRoundedWithinTheToleranceAsTheJointsAre) {
  const double tolerance_m = 2e-4;
  const auto merged = merge(square_tube(), request_of(1, tolerance_m));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  const Surface& surface = merged->surface;
  ASSERT_TRUE(surface.u.is_periodic()) << merged->left_open[0].reason;
  EXPECT_LE(merged->deviation_m, tolerance_m);
  EXPECT_GT(merged->deviation_m, 0.0);
  const double start = surface.u.domain_start(), end = surface.u.domain_end();
  const Vector3 first = evaluate(surface, start, 0.5).du,
                last = evaluate(surface, end - 1e-9 * (end - start), 0.5).du;
  EXPECT_LT((first - last).norm(), 1e-3 * first.norm());
  EXPECT_GT(position(surface, start, 0.5).head<2>().norm(), 1e-6);
}

// Edges that cannot be closed are reported with the reason if they were matched automatically, and are an
// error if the user chose them.
TEST(Ring, WhatCannotBeClosedStaysOpen) {
  std::vector<Surface> shifted = parts_of(ring_strip(0.0, 0.03, 16, 0.0), Direction::u, {0.0, 0.5, 1.0});
  // The last edge is on the first, with parameters shifted by 1 mm.
  Surface& last = shifted[1];
  const int end = last.net.rows - 1;
  for (int j = 1; j + 1 < last.net.columns; ++j) {
    last.net.set_point(end, j, last.net.point(end, j) + Vector3(1e-4, 0, 1e-3));
  }
  const auto merged = merge(shifted, request_of(2, 5e-5));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_FALSE(merged->surface.u.is_periodic());
  ASSERT_EQ(merged->left_open.size(), 1U);
  EXPECT_NE(merged->left_open[0].reason.find("apart"), std::string::npos) << merged->left_open[0].reason;
  MergeRequest chosen = request_of(2, 5e-5);
  chosen.chosen = {{{0, Side::u_end}, {1, Side::u_start}}, {{1, Side::u_end}, {0, Side::u_start}}};
  const auto refused = merge(shifted, chosen);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::mismatch) << refused.error().message;
}

TEST(Ring, ABandWithHalfATwistStaysOpen) {
  const auto u = KnotVector::clamped_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, 4).value();
  std::vector<Surface> halves;
  for (const double half : {0.0, 0.5}) {
    PointGrid points{uniform_parameters(u, 96), uniform_parameters(v, 12), {}};
    for (const double a : points.u) {
      for (const double b : points.v) {
        const double turn = 2 * pi * (half + 0.5 * a), out = 0.03 + 0.01 * (b - 0.5) * std::cos(0.5 * turn);
        points.points_m.emplace_back(out * std::cos(turn), out * std::sin(turn),
                                     0.01 * (b - 0.5) * std::sin(0.5 * turn));
      }
    }
    halves.push_back(fit_grid(u, v, points).value());
  }
  const auto merged = merge(halves, request_of(2, 2e-4));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_FALSE(merged->surface.u.is_periodic());
  EXPECT_EQ(merged->left_open.size(), 1U);
}

TEST(Ring, AGridThatClosesBothWaysDoes) {
  const Surface whole = ring_body();
  std::vector<Surface> parts;
  for (const Surface& half : parts_of(whole, Direction::u, {0.0, 0.5, 1.0})) {
    for (const Surface& quarter : parts_of(half, Direction::v, {0.0, 0.4, 1.0})) parts.push_back(quarter);
  }
  const auto merged = merge(parts, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(merged->surface.u.is_periodic());
  EXPECT_TRUE(merged->surface.v.is_periodic());
  EXPECT_LT(merged->deviation_m, 1e-11);
  // Both columns and both rows have a joint and a seam each.
  EXPECT_EQ(merged->joints.size(), 8U);
  for (double a = 0.0; a < 1.0; a += 0.07) {
    EXPECT_LT((position(merged->surface, a, 1.0 - a) - position(whole, a, 1.0 - a)).norm(), 1e-11);
  }
}

TEST(Ring, PipesThatMeetAtBothEndsDoToo) {
  const Surface whole = ring_body();
  for (const auto& places : {std::vector{0.0, 0.5, 1.0}, std::vector{0.0, 0.3, 0.6, 1.0}}) {
    const auto merged = merge(parts_of(whole, Direction::v, places), request_of(2));
    ASSERT_TRUE(merged.ok()) << merged.error().message;
    EXPECT_TRUE(merged->surface.u.is_periodic());
    EXPECT_TRUE(merged->surface.v.is_periodic());
    EXPECT_LT(merged->deviation_m, 1e-11);
  }
}

TEST(Ring, StopsWhereverItIsAskedTo) {
  MergeRequest request = request_of(1, 2e-4);
  std::vector<double> shares;
  request.join.progress = Progress([&](double share) {
    shares.push_back(share);
    return true;
  });
  ASSERT_TRUE(merge(square_tube(), request).ok());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
  ASSERT_GT(shares.size(), 10U);
  for (std::size_t stop = 0; stop < shares.size(); ++stop) {
    std::size_t asked = 0;
    request.join.progress = Progress([&](double) { return asked++ < stop; });
    const auto merged = merge(square_tube(), request);
    ASSERT_FALSE(merged.ok()) << stop;
    EXPECT_EQ(merged.error().code, ErrorCode::cancelled);
    EXPECT_LE(asked, stop + 2);  // merging stops at once
  }
}

TEST(Ring, EveryJointOfAGridIsListed) {
  std::vector<Surface> parts;
  for (const Surface& half : parts_of(level_sheet(0.0, 0.04), Direction::u, {0.0, 0.5, 1.0})) {
    for (const Surface& quarter : parts_of(half, Direction::v, {0.0, 0.02, 0.04})) parts.push_back(quarter);
  }
  const auto merged = merge(parts, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_EQ(merged->joints.size(), 4U);
}

TEST(Ring, ASeamIsAsSmoothAsAsked) {
  const Surface whole = ring_strip(0.0, 0.03, 16, 0.0);
  const Surface opened = part_of(whole, Direction::u, 0.0, 1.0).value();
  for (const int continuity : {0, 1, 2, 3, 4}) {
    const auto closed = close_around(opened, Direction::u, continuity, 1e-4);
    ASSERT_TRUE(closed.ok()) << closed.error().message;
    const KnotVector& u = closed->surface.u;
    EXPECT_EQ(u.degree(), std::max(3, continuity + 1));
    EXPECT_EQ(knot_multiplicities(u).front().multiplicity, u.degree() - continuity);
  }
}

}  // namespace
}  // namespace spoonbill
