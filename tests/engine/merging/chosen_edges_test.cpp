// Tests edges chosen by the user, and the reports on automatically matched edges.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/bspline/reparameterise.h"
#include "engine/merging/merge.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/merging/made_patches.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

TEST(ChosenEdges, AreJoined) {
  Random random(74);
  const Surface whole = random_surface(random, KnotVector::clamped_uniform(3, 8).value(),
                                       KnotVector::clamped_uniform(3, 9).value());
  const std::vector<Surface> parts{part_of(whole, Direction::v, 0.0, 0.4).value(),
                                   part_of(whole, Direction::v, 0.6, 1.0).value()};
  MergeRequest request = request_of(1);
  request.chosen = {{{0, Side::v_end}, {1, Side::v_start}}};
  const auto merged = merge(parts, request);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_EQ(merged->joints[0].a, (PatchEdge{0, Side::v_end}));
  request.chosen = {{{0, Side::v_end}, {2, Side::v_start}}};
  const auto unknown = merge(parts, request);
  EXPECT_EQ(unknown.error().code, ErrorCode::unknown);
  EXPECT_TRUE(unknown.error().message.starts_with("patch 3 ")) << unknown.error().message;
}

TEST(ChosenEdges, ThatContradictEachOtherAreRefused) {
  const std::vector<Surface> parts{level_sheet(0.0, 0.04), level_sheet(0.05, 0.09)};
  const ChosenEdges pair{{0, Side::v_end}, {1, Side::v_start}};
  const auto refused = [&](const ChosenEdges& more) {
    MergeRequest request = request_of(1);
    request.chosen = {pair, more};
    const auto merged = merge(parts, request);
    return Refusal(merged);
  };
  EXPECT_EQ(refused(pair), Refusal(ErrorCode::duplicate));
  EXPECT_TRUE(refused(pair).message.starts_with("patch 1's v_end ")) << refused(pair);
  EXPECT_EQ(refused({{0, Side::v_end}, {1, Side::v_end}}).message, refused(pair).message);
  const Refusal ring = refused({{0, Side::v_start}, {1, Side::v_end}});
  EXPECT_EQ(ring, Refusal(ErrorCode::mismatch));
  EXPECT_TRUE(ring.message.starts_with("patch 1's v_start and patch 2's v_end ")) << ring;
}

TEST(FoundEdges, OfARingOfSheetsCloseItAround) {
  std::vector<Surface> parts;
  const Surface whole = ring_strip(0.0, 0.03, 16, 0.0);
  for (const double start : {0.0, 0.25, 0.5, 0.75}) {
    parts.push_back(part_of(whole, Direction::u, start, start + 0.25).value());
  }
  const auto merged = merge(parts, request_of(2));
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_TRUE(merged->left_open.empty());
  ASSERT_TRUE(merged->surface.u.is_periodic());
  EXPECT_LT(merged->deviation_m, 1e-12);
  for (double u = 0.0; u < 1.0; u += 0.03) {
    EXPECT_LT((position(merged->surface, u, 0.4) - position(whole, u, 0.4)).norm(), 1e-12);
  }
  EXPECT_TRUE(merge({parts[0], parts[1]}, request_of(2))->left_open.empty());
}

TEST(ChosenEdges, MayRunAgainstEachOtherAndRingsBeTurned) {
  const Surface low = ring_strip(0.0, 0.03, 16, 0.0), high = ring_strip(0.04, 0.08, 16, 0.0);
  MergeRequest request = request_of(1);
  request.join.twist = 0.25;
  const auto twisted = merge({low, high}, request);
  ASSERT_TRUE(twisted.ok()) << twisted.error().message;
  const Surface& surface = twisted->surface;
  const Vector3 start = position(surface, 0.0, 0.0), end = position(surface, 0.0, surface.v.domain_end());
  // The merged surface twists by a quarter of a turn from one end to the other.
  EXPECT_NEAR(start.head<2>().normalized().dot(end.head<2>().normalized()), 0.0, 1e-9);
  MergeRequest against = request_of(1);
  against.chosen = {{{0, Side::v_end}, {1, Side::v_start}, true}};
  const auto crossed = merge({low, high}, against);
  ASSERT_TRUE(crossed.ok()) << crossed.error().message;
  const auto turn = [&](double v) {
    const Vector3 a = position(crossed->surface, 0.0, v), b = position(crossed->surface, 0.1, v);
    return a.x() * b.y() - a.y() * b.x();
  };
  EXPECT_LT(turn(0.0) * turn(crossed->surface.v.domain_end()), 0.0);
}

}  // namespace
}  // namespace spoonbill
