#include "engine/bspline/trim_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "loops.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

void expect_refused(const Result<TrimLoop>& loop, ErrorCode code) {
  ASSERT_FALSE(loop.ok());
  EXPECT_EQ(loop.error().code, code) << loop.error().message;
}

TEST(TrimLoop, APolygonIsKeptToTheBit) {
  const auto points = rectangle(0.1, -0.3, 1.7, 0.9);
  const auto polygon = to_polygon(polygon_loop(open_u, open_v, points), open_u, open_v);
  ASSERT_EQ(polygon.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(polygon[i], points[i]);
  // The exact area is the product of the side lengths.
  EXPECT_NEAR(signed_area(polygon), 1.6 * 1.2, 1e-14);
  EXPECT_NEAR(signed_area(backwards(polygon)), -1.6 * 1.2, 1e-14);
}

TEST(TrimLoop, ARoundLoopEnclosesItsClosedFormWithinTheChords) {
  for (const int count : {4, 7, 12}) {
    for (const bool clockwise : {false, true}) {
      const TrimLoop loop = round_loop(open_u, open_v, {0.9, 0.1}, 0.6, count, clockwise);
      const auto polygon = to_polygon(loop, open_u, open_v);
      const double expected = (clockwise ? -1.0 : 1.0) * round_loop_area(0.6, count);
      // The chords of the polygon, in a domain of 2 x 2, deviate by at most 2e-5 along a curve shorter than
      // 4.
      EXPECT_NEAR(signed_area(polygon), expected, 4.0 * 2e-5) << count;
      EXPECT_NE(signed_area(polygon), expected);
    }
  }
}

TEST(TrimLoop, ChordsStayWithinTheirShareOfTheDomain) {
  for (const int count : {4, 9}) {
    const TrimLoop loop = round_loop(open_u, open_v, {0.9, 0.1}, 0.7, count, false);
    const auto polygon = to_polygon(loop, open_u, open_v);
    double farthest = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector2d point = position(loop, i / 20000.0);
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t c = 0; c < polygon.size(); ++c) {
        const Eigen::Vector2d from = polygon[c], along = polygon[(c + 1) % polygon.size()] - from;
        const double share = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (from + share * along - point).norm());
      }
      farthest = std::max(farthest, nearest);
    }
    EXPECT_LE(farthest, trim_chord_fraction * 2.0);
    EXPECT_GT(farthest, 0.1 * trim_chord_fraction * 2.0) << "more chords than are needed";
  }
}

TEST(TrimLoop, AnOpenCurveOfDegreeThreeThatEndsWhereItStartsIsALoop) {
  const auto knots = KnotVector::clamped_uniform(3, 5).value();
  const auto loop = make_trim_loop(open_u, open_v, knots, {1, 1.8, 1, 0.2, 1}, {-0.5, 0, 0.8, 0, -0.5});
  ASSERT_TRUE(loop.ok()) << loop.error().message;
  EXPECT_GT(signed_area(to_polygon(loop.value(), open_u, open_v)), 0.0);
}

TEST(TrimLoop, RefusesWhatBoundsNothing) {
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {1, 0}}), ErrorCode::degenerate);
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {1, 0}, {0.5, 0}}), ErrorCode::degenerate);
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {1, 1}, {1, 0}, {0, 0.9}}),
                 ErrorCode::self_intersecting);
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {2.1, 0}, {1, 1}}), ErrorCode::out_of_range);
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {1, 0}, {1, std::nan("")}}),
                 ErrorCode::out_of_range);
  expect_refused(make_polygon_loop(open_u, open_v, {{0, 0}, {HUGE_VAL, 0}, {1, 1}}), ErrorCode::out_of_range);
  expect_refused(make_polygon_loop(periodic_u, open_v, {{0, 0}, {1.1, 0}, {1, 1}}), ErrorCode::out_of_range);
}

TEST(TrimLoop, RefusesCurvesThatAreOpen) {
  const auto knots = KnotVector::clamped_uniform(1, 3).value();
  const auto open = make_trim_loop(open_u, open_v, knots, {0, 1, 1}, {0, 0, 1});
  expect_refused(open, ErrorCode::mismatch);
  const auto once = make_trim_loop(periodic_u, open_v, knots, {0, 0.5, 1}, {0, 0, 0});
  expect_refused(once, ErrorCode::unsupported);
  EXPECT_FALSE(make_trim_loop(open_u, open_v, knots, {0, 1, 1, 0}, {0, 0, 1, 0}).ok());
}

TEST(TrimLoop, TakesRoundingAtTheStartAndAtTheDomainsEnds) {
  const auto knots = KnotVector::clamped_uniform(1, 4).value();
  const auto loop =
      make_trim_loop(open_u, open_v, knots, {-1e-9, 2.0 + 1e-9, 1, 1e-9}, {-1.0 - 1e-9, 0, 0.5, -1.0});
  ASSERT_TRUE(loop.ok()) << loop.error().message;
  for (const Eigen::Vector2d& corner : to_polygon(loop.value(), open_u, open_v)) {
    EXPECT_GE(corner.x(), 0.0);
    EXPECT_LE(corner.x(), 2.0);
    EXPECT_GE(corner.y(), -1.0);
  }
}

TEST(TrimLoop, RefusesACurveOfMoreChordsThanTheLimit) {
  std::vector<double> u, v;
  const int count = 3000;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    const double radius = i % 2 == 0 ? 0.9 : 0.2;
    u.push_back(1.0 + radius * std::cos(angle));
    v.push_back(radius * std::sin(angle));
  }
  const auto rough = make_trim_loop(open_u, open_v, KnotVector::periodic_uniform(2, count).value(), u, v);
  expect_refused(rough, ErrorCode::too_many);
}

// Expects `after` to be the curve `before` run backwards. `moved` converts the parameters of a surface point
// to the new parameters of the same point.
void expect_runs_backwards(const TrimLoop& before, const TrimLoop& after,
                           const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& moved) {
  const double start = before.knots.domain_start(), end = before.knots.domain_end();
  for (int i = 0; i <= 50; ++i) {
    const double parameter = start + (end - start) * i / 50;
    const Eigen::Vector2d expected = moved(position(before, parameter));
    // The bound allows for the rounding of coordinates, whose magnitude is at most 2.
    EXPECT_NEAR((position(after, end - (parameter - start)) - expected).norm(), 0.0, 1e-14);
  }
}

TEST(TrimLoop, FollowsASurfaceRunThroughOtherwise) {
  for (const bool polygon : {false, true}) {
    const TrimLoop loop = polygon ? polygon_loop(open_u, open_v, {{0, 0}, {1.5, -1}, {1, 1}})
                                  : round_loop(open_u, open_v, {0.9, 0.1}, 0.6, 7, false);
    expect_runs_backwards(loop, reversed(loop, Direction::u, open_u),
                          [](const auto& p) { return Eigen::Vector2d(2.0 - p.x(), p.y()); });
    expect_runs_backwards(loop, reversed(loop, Direction::v, open_v),
                          [](const auto& p) { return Eigen::Vector2d(p.x(), -p.y()); });
    expect_runs_backwards(loop, exchanged(loop), [](const auto& p) { return Eigen::Vector2d(p.y(), p.x()); });
    EXPECT_GT(signed_area(to_polygon(exchanged(loop), open_v, open_u)), 0.0) << "keeps the same side";
    EXPECT_EQ(exchanged(exchanged(loop)).u, loop.u);
    EXPECT_EQ(exchanged(exchanged(loop)).v, loop.v);
    const TrimLoop stretched = with_domain(loop, Direction::v, open_v, 3.0, 9.0);
    for (std::size_t i = 0; i < loop.v.size(); ++i) {
      EXPECT_NEAR(stretched.v[i], 3.0 + 3.0 * (loop.v[i] + 1.0), 1e-14);
      EXPECT_EQ(stretched.u[i], loop.u[i]);
    }
  }
}

TEST(TrimLoop, StaysWithinAPeriodOfTheDomainWhenTheSeamMoves) {
  for (const double middle : {0.05, 0.5, 0.95}) {
    const TrimLoop loop = round_loop(periodic_u, open_v, {middle, 0.0}, 0.2, 6, true);
    for (const double seam : {0.0, 0.1, 0.5, 0.99}) {
      const TrimLoop moved = with_seam_at(loop, Direction::u, periodic_u, seam);
      const Eigen::Vector2d gone = position(moved, 0.3) - position(loop, 0.3);
      EXPECT_NEAR(gone.x() + seam, std::round(gone.x() + seam), 1e-14);
      EXPECT_TRUE(make_trim_loop(periodic_u, open_v, moved.knots, moved.u, moved.v).ok());
    }
  }
}

}  // namespace
}  // namespace spoonbill
