// Tests that the search for the nearest point on an exact surface crosses poles.
#include "engine/collision/surfaces/pair_polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <ostream>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"

namespace spoonbill {
namespace {

constexpr double length_m = 0.02, width_m = 0.014, rounding_m = 0.001, tolerance_m = 2e-5;

// A surface with what the searches need.
struct Searched {
  explicit Searched(Surface searched) : surface(std::move(searched)), in_u(surface.u), in_v(surface.v) {}
  Searched(const Searched&) = delete;
  Searched& operator=(const Searched&) = delete;
  PiecewiseSurface pieces() const { return {&surface, &in_u, &in_v}; }

  Surface surface;
  PieceBasis in_u, in_v;
};

// Returns a block along x whose end faces have a pole in their middle, at the ends of v.
Surface make_block(double centre_x_m, double turn_rad = 0.0) {
  BoxSize size;
  size.size_m = {length_m, width_m, width_m};
  size.rounding_m = rounding_m;
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.degree = stock_shape_degree(size);
  return placed(fit_shape(stock_shape(size).value(), fit).value().surface,
                {Vector3(centre_x_m, 0.0, 0.0), Quaternion(Eigen::AngleAxisd(turn_rad, Vector3::UnitZ()))});
}

// Calls visit(around, along) for parameters of points of an end face: `around` from 0 to 1 around the pole,
// and `along` the distance from the pole, up to 0.05.
template <class Visit>
void visit_face(const Visit& visit) {
  constexpr int steps = 6;
  for (int a = 0; a < 2 * steps; ++a) {
    for (int b = 0; b < steps; ++b) visit((a + 0.5) / (2 * steps), 0.05 * (b + 0.5) / steps);
  }
}

// The block's surface with its poles at the ends of u or of v. `at_end` selects the end face that is
// searched.
struct PoleAt {
  bool of_u, at_end;
};

void PrintTo(const PoleAt& pole, std::ostream* out) {
  *out << "pole at the " << (pole.at_end ? "end" : "start") << " of " << (pole.of_u ? "u" : "v");
}

class NearestPointBesidePole : public testing::TestWithParam<PoleAt> {
 protected:
  std::array<double, 2> parameters(double around, double along) const {
    const double from_end = GetParam().at_end ? 1.0 - along : along;
    return GetParam().of_u ? std::array<double, 2>{from_end, around}
                           : std::array<double, 2>{around, from_end};
  }
  const Searched block{GetParam().of_u ? exchanged(make_block(0.0)) : make_block(0.0)};
};

TEST_P(NearestPointBesidePole, IsFoundOnItsOtherSide) {
  int misses = 0, searches = 0;
  double farthest_m = 0.0;
  visit_face([&](double around, double along) {
    const auto [u, v] = parameters(around, along);
    const Vector3 beside = position(block.surface, u, v) - 2e-6 * unit_normal(block.surface, u, v);
    visit_face([&](double from_around, double from_along) {
      const auto [from_u, from_v] = parameters(from_around, from_along);
      const NearestPoint found = nearest_point(block.pieces(), beside, from_u, from_v);
      const double distance_m = (found.at.position_m - beside).norm();
      farthest_m = std::max(farthest_m, distance_m);
      misses += distance_m > 2.001e-6 ? 1 : 0;
      ++searches;
    });
  });
  EXPECT_EQ(misses, 0) << "of " << searches << ", the farthest at " << farthest_m << " m";
}

TEST_P(NearestPointBesidePole, KeepsToItsBudget) {
  visit_face([&](double around, double along) {
    const auto [u, v] = parameters(around, along);
    const auto [from_u, from_v] = parameters(around + (around < 0.5 ? 0.5 : -0.5), along);
    for (int allowed = 1; allowed < 50; ++allowed) {
      PolishBudget budget{allowed};
      nearest_point(block.pieces(), position(block.surface, u, v), from_u, from_v, &budget);
      EXPECT_GE(budget.evaluations_left, -1);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(, NearestPointBesidePole,
                         testing::Values(PoleAt{false, false}, PoleAt{false, true}, PoleAt{true, false},
                                         PoleAt{true, true}));

// The depth must be measured at the nearest point. At a point on the other side of the pole it would be the
// distance across the face.
TEST(DeepestPair, OfPressedFlatFacesIsNoDeeperThanTheirOverlap) {
  constexpr double overlap_m = 1e-6, turn_rad = 1e-4;
  const Searched left(make_block(-0.5 * length_m)), right(make_block(0.5 * length_m - overlap_m, turn_rad));
  visit_face([&](double s, double t) {
    // The face of `left` is at the end of v. The search starts up to half a turn from the nearest point.
    const double u = left.surface.u.into_domain(0.25 - s), v = 1.0 - t;
    const DeepestPair found = deepest_pair(left.pieces(), right.pieces(), {u, v, s, t}, 1.0, 1.0);
    EXPECT_GT(found.depth_m, 0.0);
    EXPECT_LE(found.depth_m, overlap_m + 0.5 * width_m * turn_rad);
  });
}

}  // namespace
}  // namespace spoonbill
