#include "engine/collision/surfaces/surface_self_collider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/surfaces/crossing_samples.h"
#include "tests/engine/collision/surfaces/random_pairs.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

struct SelfAnswer {
  SelfResult result;
  std::vector<PairContact> contacts;
};

SelfAnswer collide_with_itself(const Surface& surface, bool closed = false, int levels = 2) {
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, levels).value();
  SurfaceSelfCollider collider(nested);
  const SelfResult result = collider.collide(surface, {closed});
  EXPECT_FALSE(result.overflow);
  return {result, collider.contacts()};
}

// Returns the surface of a curve extruded along y from 0 to 1. `curve` contains the control points of the
// curve, which is in the x-z plane.
Surface drawn_out(const KnotVector& knots, const std::vector<Vector3>& curve) {
  const KnotVector along = KnotVector::clamped_uniform(1, 6).value();
  ControlNet net(knots.control_point_count(), 6);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < 6; ++j) net.set_point(i, j, curve[i] + Vector3(0, 0.2 * j, 0));
  }
  return make_surface(knots, along, net).value();
}

// Returns the sheet x = t^2, z = t^3 - t for t from -1.5 to 1.5. It crosses itself where x = 1 and z = 0, at
// t = -1 and t = 1. Its control points are the polar forms of x and z.
Surface looped_sheet() {
  std::vector<double> t = {-1.5, -1.5, -1.5};
  for (int k = 0; k <= 10; ++k) t.push_back(-1.5 + 0.3 * k);
  t.insert(t.end(), 3, 1.5);
  const KnotVector knots = KnotVector::open(3, t).value();
  std::vector<Vector3> curve;
  for (int i = 0; i < knots.control_point_count(); ++i) {
    const double a = t[i + 1], b = t[i + 2], c = t[i + 3];
    curve.emplace_back((a * b + b * c + c * a) / 3.0, 0.0, a * b * c - (a + b + c) / 3.0);
  }
  return drawn_out(knots, curve);
}

// Returns a tube along y whose lower wall is at z = -gap / 20 and whose upper wall is at gap / 20, both flat
// for x from -0.3 to 0.3. A negative gap means that the walls have passed through each other. The ends bulge
// out, and du x dv points outwards.
Surface pressed_tube(double gap) {
  const double h = 0.5 * gap;
  const std::vector<Vector3> upper = {{4, 0, h},  {3, 0, h},  {2, 0, h},  {1, 0, h}, {0, 0, h},
                                      {-1, 0, h}, {-2, 0, h}, {-3, 0, h}, {-4, 0, h}};
  std::vector<Vector3> curve = {{6, 0, -2}, {8, 0, 0}, {6, 0, 2}};
  curve.insert(curve.end(), upper.begin(), upper.end());
  curve.insert(curve.end(), {{-6, 0, 2}, {-8, 0, 0}, {-6, 0, -2}});
  for (auto point = upper.rbegin(); point != upper.rend(); ++point) curve.push_back({point->x(), 0, -h});
  for (Vector3& point : curve) point *= 0.1;
  return drawn_out(KnotVector::periodic_uniform(2, static_cast<int>(curve.size())).value(), curve);
}

constexpr int eight_points = 24;

// Returns a surface extruded from a Lissajous curve 1:2, which crosses itself at its centre by symmetry.
Surface figure_eight() {
  std::vector<Vector3> curve;
  for (int k = 0; k < eight_points; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / eight_points;
    curve.emplace_back(std::sin(angle), 0.0, 0.5 * std::sin(2.0 * angle));
  }
  return drawn_out(KnotVector::periodic_uniform(3, eight_points).value(), curve);
}

TEST(SurfaceSelf, SheetsAreClearOfThemselves) {
  EXPECT_FALSE(collide_with_itself(quadric_sheet(1.0, 0.0, 0.0, 6)).result.touching) << "flat";
  EXPECT_FALSE(collide_with_itself(quadric_sheet(1.0, 0.8, -0.6, 6)).result.touching) << "a saddle";
  EXPECT_FALSE(collide_with_itself(quadric_sheet(1.0, 0.8, 0.6, 3), false, 0).result.touching)
      << "one element";
}

TEST(SurfaceSelf, SeamsAndPolesAreNoContact) {
  for (const int levels : {0, 1, 2, 3}) {
    EXPECT_FALSE(collide_with_itself(ellipsoid_tube(12, 12), true, levels).result.touching) << levels;
    EXPECT_FALSE(collide_with_itself(transposed(ellipsoid_tube(9, 14)), false, levels).result.touching)
        << levels;
  }
  EXPECT_FALSE(collide_with_itself(round_tube(0.02, 0.1)).result.touching);
  EXPECT_FALSE(collide_with_itself(round_torus(0.05, 0.02), true, 1).result.touching);
}

// A surface whose two ends coincide has a seam as well, even if its knots are open.
TEST(SurfaceSelf, ATubeClosedByItsEndsIsNoContact) {
  const KnotVector knots = KnotVector::clamped_uniform(3, 9).value();
  std::vector<Vector3> curve;
  for (int k = 0; k < 9; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 8;
    curve.emplace_back(std::cos(angle), 0.0, std::sin(angle));
  }
  curve[8] = curve[0];
  EXPECT_FALSE(collide_with_itself(drawn_out(knots, curve)).result.touching);
  curve[0] = {1.6, 0, -0.4};
  curve[8] = {1.5, 0, 0.2};
  EXPECT_TRUE(collide_with_itself(drawn_out(knots, curve)).result.touching)
      << "one end passed through the other";
}

TEST(SurfaceSelf, ALoopCrossesWhereTheClosedFormSays) {
  const SelfAnswer answer = collide_with_itself(looped_sheet());
  ASSERT_EQ(answer.contacts.size(), 1u);
  const PairContact& contact = answer.contacts[0];
  const bool swapped = contact.first.u0 > 0.0;
  const ParameterRange& low = swapped ? contact.second : contact.first;
  const ParameterRange& high = swapped ? contact.first : contact.second;
  // A knot span is 0.3 wide, and a cell is a quarter of that. A region may extend up to one cell beyond the
  // crossing.
  constexpr double cell = 0.075;
  EXPECT_LE(low.u0, -1.0);
  EXPECT_GE(low.u1, -1.0);
  EXPECT_LE(low.u1 - low.u0, 3.0 * cell);
  EXPECT_LE(high.u0, 1.0);
  EXPECT_GE(high.u1, 1.0);
  EXPECT_LE(high.u1 - high.u0, 3.0 * cell);
  EXPECT_EQ(low.v0, 0.0) << "all along";
  EXPECT_EQ(low.v1, 1.0);
  EXPECT_GT(contact.depth_m, 0.0);
}

// The walls are flat where they overlap most, so the depth equals the distance between them up to rounding.
TEST(SurfaceSelf, APressedTubeIsAsDeepInItselfAsItsWallsHavePassed) {
  for (const double depth : {0.05, 0.01, 1e-3}) {
    const SelfAnswer answer = collide_with_itself(pressed_tube(-10.0 * depth), true);
    ASSERT_EQ(answer.contacts.size(), 2u) << "it crosses itself on the left and on the right";
    for (const PairContact& contact : answer.contacts) {
      EXPECT_NEAR(contact.depth_m, depth, 1e-9);
      EXPECT_NEAR(std::abs(contact.normal.z()), 1.0, 1e-7);
      EXPECT_NEAR(contact.pair.distance_m(), depth, 1e-9);
    }
  }
}

TEST(SurfaceSelf, ATubeWhoseWallsTouchIsInContactAndOneWithAGapIsNot) {
  EXPECT_TRUE(collide_with_itself(pressed_tube(0.0), true).result.touching);
  EXPECT_FALSE(collide_with_itself(pressed_tube(5e-5), true).result.touching) << "five micrometres apart";
}

TEST(SurfaceSelf, AFigureOfEightCrossesInItsMiddle) {
  const SelfAnswer answer = collide_with_itself(figure_eight());
  ASSERT_EQ(answer.contacts.size(), 1u);
  const PairContact& contact = answer.contacts[0];
  const bool swapped = contact.first.u0 > 0.4;
  // The peak of a cubic basis function is two knots after its start.
  const double crossing = 2.0 / eight_points;
  const ParameterRange& one = swapped ? contact.second : contact.first;
  const ParameterRange& other = swapped ? contact.first : contact.second;
  constexpr double cell = 0.25 / eight_points;
  EXPECT_NEAR(0.5 * (one.u0 + one.u1), crossing, 2.0 * cell);
  EXPECT_NEAR(0.5 * (other.u0 + other.u1), crossing + 0.5, 2.0 * cell);
  EXPECT_LE(one.u1 - one.u0, 6.0 * cell);
}

// The seam is at the crossing: regions that are connected across the seam count as one.
TEST(SurfaceSelf, ACrossingInTheSeamIsOneContact) {
  std::vector<Vector3> curve;
  for (int k = 0; k < eight_points; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 2) / eight_points;
    curve.emplace_back(std::sin(angle), 0.0, 0.5 * std::sin(2.0 * angle));
  }
  EXPECT_EQ(collide_with_itself(drawn_out(KnotVector::periodic_uniform(3, eight_points).value(), curve))
                .contacts.size(),
            1u);
}

TEST(SurfaceSelf, AllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  const Surface clear = pressed_tube(0.4), crossing = pressed_tube(-0.4);
  const NestedGrid nested = make_nested_grid(clear.u, clear.v, 2).value();
  SurfaceSelfCollider collider(nested);
  const std::size_t before = allocation_count();
  EXPECT_FALSE(collider.collide(clear, {true}).touching);
  EXPECT_TRUE(collider.collide(crossing, {true}).touching);
  EXPECT_EQ(allocation_count(), before);
}

// Compares the result with intersections of triangles between dense samples, which are found without cones,
// hulls or levels.
TEST(SurfaceSelf, NoCrossingOfDenseTrianglesIsMissed) {
  constexpr int levels = 2;
  Random random(81);
  int crossing = 0, clear = 0;
  std::map<std::string, int> missed, invented;
  for (int trial = 0; trial < random_cases(60, 500); ++trial) {
    const RandomPair pair = random_pair(random, 0.0);
    const Surface& surface = pair.first;
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, levels).value();
    SurfaceSelfCollider collider(nested);
    const bool touching = collider.collide(surface, {}).touching;
    const bool crosses = samples_cross(surface, nested, 2);
    ++(crosses ? crossing : clear);
    if (crosses && !touching) ++missed[pair.kind];
    if (touching && !crosses) ++invented[pair.kind];
  }
  for (const auto& [kind, count] : missed) ADD_FAILURE() << count << " missed, " << kind;
  for (const auto& [kind, count] : invented) ADD_FAILURE() << count << " invented, " << kind;
  EXPECT_GT(crossing, random_cases(60, 500) / 10);
  EXPECT_GT(clear, random_cases(60, 500) / 10);
}

TEST(SurfaceSelfCollider, StopsWhenAskedTo) {
  const Surface sheet = looped_sheet();
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceSelfCollider collider(nested);
  SelfQuery query;
  query.progress = Progress([](double fraction) { return fraction < 0.0; });
  const SelfResult stopped = collider.collide(sheet, query);
  EXPECT_TRUE(stopped.stopped);
  EXPECT_FALSE(stopped.touching);
  query.progress = Progress([](double fraction) { return fraction <= 1.0; });
  const SelfResult whole = collider.collide(sheet, query);
  EXPECT_FALSE(whole.stopped);
  EXPECT_TRUE(whole.touching);
}

}  // namespace
}  // namespace spoonbill
