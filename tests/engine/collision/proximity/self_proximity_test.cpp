// Tests that the search for points where a torus is near to itself works across its seams as it does
// elsewhere.
#include "engine/collision/proximity/self_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/halve_elements.h"

namespace spoonbill {
namespace {

constexpr double torus_ring_m = 0.02, torus_tube_m = 0.005, cell_m = 0.002, proximity_margin_m = 0.5 * cell_m;
constexpr int torus_around = 12, torus_along = 24;

// Returns a torus about y. u runs around its tube. v runs along the tube and starts at control point `first`
// of `torus_along`. `squeeze` scales the width of the centre line along x.
Surface torus(int first, double squeeze = 1.0) {
  ControlNet net(torus_around, torus_along);
  const auto turn = [](int index, int count) { return 2.0 * std::numbers::pi * index / count; };
  for (int i = 0; i < torus_around; ++i) {
    for (int j = 0; j < torus_along; ++j) {
      const double angle = turn(j + first, torus_along), out = torus_tube_m * std::cos(turn(i, torus_around));
      const Vector3 middle(squeeze * torus_ring_m * std::cos(angle), 0.0, -torus_ring_m * std::sin(angle));
      net.set_point(i, j,
                    middle + Vector3(out * std::cos(angle), -torus_tube_m * std::sin(turn(i, torus_around)),
                                     -out * std::sin(angle)));
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, torus_around).value(),
                      KnotVector::periodic_uniform(3, torus_along).value(), std::move(net))
      .value();
}

NestedGrid nested_grid_of(const Surface& surface) {
  return make_nested_grid(surface.u, surface.v, 1).value();
}

TEST(RestPairs, OfARingAreNeighboursOverTheSeamAsElsewhere) {
  const Surface ring = torus(0);
  const RestPairs pairs(nested_grid_of(ring).grid, ring, cell_m);
  const auto can_meet = [&](double u, double v, double other_u, double beyond) {
    return pairs.can_meet(ring.u.into_domain(u), ring.v.into_domain(v), ring.u.into_domain(other_u),
                          ring.v.into_domain(v + beyond));
  };
  const double element = (ring.v.domain_end() - ring.v.domain_start()) / torus_along;
  int meet = 0, pairs_seen = 0;
  for (int i = 0; i < torus_around; ++i) {
    for (int k = 0; k < torus_around; ++k) {
      for (int apart = 0; apart <= torus_along / 2; ++apart) {
        const double u = ring.u.domain_start() + (i + 0.5) * element, other_u = u + (k - i) * element;
        const bool expected = can_meet(u, ring.v.domain_start() + 0.5 * element, other_u, apart * element);
        for (int j = 1; j < torus_along; ++j) {
          const double v = ring.v.domain_start() + (j + 0.5) * element;
          EXPECT_EQ(can_meet(u, v, other_u, apart * element), expected) << i << ", " << k << ", " << apart;
        }
        meet += expected ? 1 : 0;
        ++pairs_seen;
      }
    }
  }
  EXPECT_GT(meet, 0);
  EXPECT_LT(meet, pairs_seen);
}

// Finds the contacts of the squeezed torus with itself. Returns the gaps at its samples in ascending order.
std::vector<double> gaps_m(int first, double squeeze) {
  const Surface rest = torus(first), now = torus(first, squeeze);
  const NestedGrid nested = nested_grid_of(rest);
  SelfProximity proximity(nested, rest, cell_m);
  proximity.find(now, proximity_margin_m);
  EXPECT_FALSE(proximity.overflow());
  std::vector<double> gaps;
  for (const NearPoint& near : proximity.points()) {
    if (near.sample >= 0) gaps.push_back(near.gap_m);
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

TEST(SelfProximity, OfARingAtRestIsNone) {
  const Surface ring = torus(0);
  const NestedGrid nested = nested_grid_of(ring);
  SelfProximity proximity(nested, ring, cell_m);
  proximity.find(ring, proximity_margin_m);
  EXPECT_TRUE(proximity.points().empty());
  EXPECT_TRUE(proximity.is_clear());
}

// The walls of the ring's hole are pressed together at the seam of v, and away from this seam.
TEST(SelfProximity, OfARingPressedTogetherIsAlikeOverTheSeam) {
  for (const double gap_m : {0.4 * proximity_margin_m, -0.4 * proximity_margin_m}) {
    const double squeeze = (torus_tube_m + 0.5 * gap_m) / torus_ring_m;
    const std::vector<double> beside = gaps_m(torus_along / 4, squeeze), over = gaps_m(0, squeeze);
    EXPECT_GT(beside.size(), 10u);
    ASSERT_EQ(over.size(), beside.size()) << gap_m;
    for (std::size_t k = 0; k < over.size(); ++k) EXPECT_NEAR(over[k], beside[k], 1e-9) << gap_m;
  }
}

Surface with_halved_elements(Surface surface) {
  const int control_points = static_cast<int>(surface.net.size());
  return halve_long_elements(std::move(surface), 1e-6, 4 * control_points, 1000).value();
}

// Smallest gap between the walls of the hole, in tenths of a millimetre, at which a search with nothing known
// finds nothing near.
double find_clear_gap_m(SelfProximity& search, const std::function<Surface(double)>& shape) {
  for (double gap_m = proximity_margin_m;; gap_m += 1e-4) {
    search.find(shape(gap_m), proximity_margin_m);
    if (search.is_clear()) return gap_m;
  }
}

// The walls of the hole approach each other by almost as much as a search allows for, then the knots are
// refined, then the walls come too near.
TEST(SelfProximity, OfARefinedSurfaceKnowsHowFarItHasMovedSinceTheLastSearch) {
  const auto shape = [](double gap_m) { return torus(0, (torus_tube_m + 0.5 * gap_m) / torus_ring_m); };
  const auto refined = [&](double gap_m) { return with_halved_elements(shape(gap_m)); };
  const Surface rest = torus(0), finer_rest = with_halved_elements(rest);
  const NestedGrid nested = nested_grid_of(rest), finer_nested = nested_grid_of(finer_rest);
  SelfProximity coarse(nested, rest, cell_m), finer(finer_nested, finer_rest, cell_m),
      fresh(finer_nested, finer_rest, cell_m);
  const double apart_m = find_clear_gap_m(coarse, shape), near_m = apart_m - 0.9 * cell_m;
  const double too_near_m = apart_m - 1.1 * cell_m;
  ASSERT_LT(too_near_m, find_clear_gap_m(fresh, refined));

  finer.carry_over(coarse, shape(near_m).net, refined(near_m).net);
  EXPECT_TRUE(finer.is_clear());
  finer.find(refined(near_m), proximity_margin_m);
  EXPECT_TRUE(finer.is_clear());
  finer.find(refined(too_near_m), proximity_margin_m);
  EXPECT_FALSE(finer.is_clear());
}

}  // namespace
}  // namespace spoonbill
