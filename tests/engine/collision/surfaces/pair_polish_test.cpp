// Tests that the searches for nearest and deepest points on exact surfaces find them across poles.
#include "engine/collision/surfaces/pair_polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"

namespace spoonbill {
namespace {

constexpr double length_m = 0.02, width_m = 0.014, rounding_m = 0.001, tolerance_m = 2e-5;

// A block along x whose end faces have a pole in their middle.
struct Block {
  explicit Block(double centre_x_m, double turn_rad = 0.0)
      : surface(make(centre_x_m, turn_rad)), in_u(surface.u), in_v(surface.v) {}
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  PiecewiseSurface pieces() const { return {&surface, &in_u, &in_v}; }

  static Surface make(double centre_x_m, double turn_rad) {
    BoxSize size;
    size.size_m = {length_m, width_m, width_m};
    size.rounding_m = rounding_m;
    ShapeFit fit;
    fit.tolerance_m = tolerance_m;
    fit.degree = stock_shape_degree(size);
    return placed(fit_shape(stock_shape(size).value(), fit).value().surface,
                  {Vector3(centre_x_m, 0.0, 0.0), Quaternion(Eigen::AngleAxisd(turn_rad, Vector3::UnitZ()))});
  }

  Surface surface;
  PieceBasis in_u, in_v;
};

// Calls visit(u, v) for points of the end face near the pole at the start of v, up to `reach` in v.
template <class Visit>
void visit_around_pole(const Surface& surface, double reach, int steps, const Visit& visit) {
  for (int a = 0; a < 2 * steps; ++a) {
    for (int b = 0; b < steps; ++b) {
      visit(surface.u.parameter_at((a + 0.5) / (2 * steps)),
            surface.v.parameter_at(reach * (b + 0.5) / steps));
    }
  }
}

TEST(NearestPoint, IsFoundAcrossAPole) {
  const Block block(0.0);
  int misses = 0, searches = 0;
  double farthest_m = 0.0;
  visit_around_pole(block.surface, 0.05, 6, [&](double u, double v) {
    const Vector3 inside = position(block.surface, u, v) - 2e-6 * unit_normal(block.surface, u, v);
    visit_around_pole(block.surface, 0.05, 6, [&](double from_u, double from_v) {
      const NearestPoint found = nearest_point(block.pieces(), inside, from_u, from_v);
      const double distance_m = (found.at.position_m - inside).norm();
      farthest_m = std::max(farthest_m, distance_m);
      misses += distance_m > 2.001e-6 ? 1 : 0;
      ++searches;
    });
  });
  EXPECT_EQ(misses, 0) << "of " << searches << ", the farthest at " << farthest_m << " m";
}

// The depth must be measured at the nearest point. A search for it that ends on the other side of the pole
// would give the distance across the face.
TEST(DeepestPair, OfPressedFlatFacesIsNoDeeperThanTheirOverlap) {
  constexpr double overlap_m = 1e-6, turn_rad = 1e-4;
  const Block left(-0.5 * length_m), right(0.5 * length_m - overlap_m, turn_rad);
  double deepest_m = 0.0;
  visit_around_pole(right.surface, 0.05, 6, [&](double s, double t) {
    // The face of `left` is at the end of v. The search starts up to half a turn from the nearest point.
    const double u = left.surface.u.into_domain(0.25 - s), v = 1.0 - t;
    const DeepestPair found = deepest_pair(left.pieces(), right.pieces(), {u, v, s, t}, 1.0, 1.0);
    deepest_m = std::max(deepest_m, found.depth_m);
  });
  EXPECT_GT(deepest_m, overlap_m);
  EXPECT_LE(deepest_m, overlap_m + 0.5 * width_m * turn_rad + 2.0 * tolerance_m);
}

}  // namespace
}  // namespace spoonbill
