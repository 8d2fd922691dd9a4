#include "engine/bspline/piece_basis.h"

#include <gtest/gtest.h>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

// Compares two evaluations of a surface: by its polynomial pieces, each scaled to -1..1, and by the B-spline
// recursion. The tolerances grow with the derivatives, which are larger the shorter the pieces are.
void expect_agreement(const Surface& surface, double u, double v) {
  const PieceBasis in_u(surface.u), in_v(surface.v);
  const PiecewiseSurface pieces{&surface, &in_u, &in_v};
  const SurfacePoint ours = evaluate(pieces, u, v), theirs = evaluate(surface, u, v);
  const auto near = [](const Vector3& a, const Vector3& b, double size) {
    return (a - b).norm() <= 1e-11 * size;
  };
  EXPECT_TRUE(near(ours.position_m, theirs.position_m, 1.0));
  EXPECT_TRUE(near(position(pieces, u, v), theirs.position_m, 1.0));
  const double first = 1.0 + theirs.du.norm() + theirs.dv.norm();
  EXPECT_TRUE(near(ours.du, theirs.du, first) && near(ours.dv, theirs.dv, first));
  const double second = 100.0 * (first + theirs.duu.norm() + theirs.duv.norm() + theirs.dvv.norm());
  EXPECT_TRUE(near(ours.duu, theirs.duu, second) && near(ours.duv, theirs.duv, second) &&
              near(ours.dvv, theirs.dvv, second));
}

TEST(PieceBasis, AgreesWithTheRecursion) {
  Random random(91);
  for (int trial = 0; trial < 200; ++trial) {
    const KnotVector u = random_knots(random, random.integer(1, 5), KnotKind::clamped);
    const KnotVector v = random_knots(random, random.integer(1, 5), KnotKind::periodic);
    const Surface surface = random_surface(random, u, v);
    expect_agreement(surface, random.uniform(u.domain_start(), u.domain_end()),
                     random.uniform(v.domain_start(), v.domain_end()));
    // The evaluations are also compared at the knots of u, which include both ends, and beyond the seam of v.
    for (const double knot : u.breakpoints()) expect_agreement(surface, knot, v.domain_end());
    expect_agreement(surface, u.domain_end(), v.domain_end() + 0.25 * (v.domain_end() - v.domain_start()));
  }
}

TEST(PieceBasis, NormalsAreThoseOfTheSurfaceAtPolesToo) {
  Random random(92);
  Surface surface = random_surface(random);
  const PieceBasis in_u(surface.u), in_v(surface.v);
  const PiecewiseSurface pieces{&surface, &in_u, &in_v};
  const auto expect_normal = [&](double u, double v) {
    const Vector3 ours = unit_normal(pieces, evaluate(pieces, u, v), u, v);
    EXPECT_LT((ours - unit_normal(surface, u, v)).norm(), 1e-9);
  };
  const double u0 = surface.u.domain_start(), u1 = surface.u.domain_end();
  expect_normal(0.4 * u0 + 0.6 * u1, 0.5 * (surface.v.domain_start() + surface.v.domain_end()));
  if (surface.u.is_periodic()) return;
  for (int j = 1; j < surface.net.columns; ++j) surface.net.set_point(0, j, surface.net.point(0, 0));
  expect_normal(u0, 0.3 * surface.v.domain_start() + 0.7 * surface.v.domain_end());
}

// Far from the origin, the derivative around a pole is rounding noise instead of zero.
TEST(PieceBasis, NormalsAtThePolesOfADistantTubePointOutward) {
  const Surface tube = ellipsoid_tube(12, 9, {0.3, -0.2, 0.1});
  const PieceBasis in_u(tube.u), in_v(tube.v);
  const PiecewiseSurface pieces{&tube, &in_u, &in_v};
  for (int step = 0; step < 100; ++step) {
    const double u = (step + 0.2) / 100;
    for (const double v : {0.0, 1.0}) {
      const Vector3 normal = unit_normal(pieces, evaluate(pieces, u, v), u, v);
      EXPECT_LT((normal - Vector3(0, 0, v > 0.5 ? 1 : -1)).norm(), 1e-12) << u << " " << v;
    }
  }
}

// After a refit in single precision, the control points of a pole are apart by about 1e-7 of their size. The
// pole is then the border of a tiny hole, also for parameters that differ from its own by rounding.
TEST(PieceBasis, NormalsBesideAPoleWithATinyHolePointOutward) {
  Random random(94);
  Surface tube = ellipsoid_tube(12, 9);
  for (int i = 0; i < tube.net.rows; ++i) {
    tube.net.set_point(i, 0, tube.net.point(i, 0) + random.in_box(Vector3::Constant(1e-9)));
  }
  const PieceBasis in_u(tube.u), in_v(tube.v);
  const PiecewiseSurface pieces{&tube, &in_u, &in_v};
  for (int step = 0; step < 100; ++step) {
    const double u = (step + 0.2) / 100;
    for (const double v : {0.0, 1e-20, 1e-9, 1e-7, 3e-6, 3e-5}) {
      const Vector3 normal = unit_normal(pieces, evaluate(pieces, u, v), u, v);
      EXPECT_LT((normal + Vector3::UnitZ()).norm(), 0.1) << u << " " << v;
    }
  }
}

TEST(PieceBasis, AllocatesNothingOnceMade) {
  Random random(93);
  const Surface surface = random_surface(random);
  const PieceBasis in_u(surface.u), in_v(surface.v);
  const std::size_t before = allocation_count();
  const SurfacePoint at = evaluate(PiecewiseSurface{&surface, &in_u, &in_v}, 0.3, 0.6);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_TRUE(at.position_m.allFinite());
}

}  // namespace
}  // namespace spoonbill
