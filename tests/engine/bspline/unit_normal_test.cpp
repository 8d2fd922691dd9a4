#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

constexpr int tube_around = 12, tube_along = 9;

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(UnitNormal, IsTheProductOfTheTangents) {
  Random random(14);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Surface surface = random_surface(random);
    const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
    const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
    const SurfacePoint point = evaluate(surface, u, v);
    const Vector3 expected = point.du.cross(point.dv).normalized();
    // The rounding error of the normal grows as the tangents become parallel; these tangents are far from
    // parallel.
    EXPECT_LT((unit_normal(surface, u, v) - expected).norm(), 1e-11);
  }
}

TEST(UnitNormal, SmoothPolesHaveOneNormal) {
  const Surface tube = ellipsoid_tube(tube_around, tube_along);
  for (const Surface& surface : {tube, transposed(tube)}) {
    const bool poles_in_v = surface.u.is_periodic();
    const double sign = poles_in_v ? 1.0 : -1.0;
    for (int step = 0; step < 33; ++step) {
      const double t = (step + 0.2) / 33;
      const Vector3 start = poles_in_v ? unit_normal(surface, t, 0.0) : unit_normal(surface, 0.0, t);
      const Vector3 end = poles_in_v ? unit_normal(surface, t, 1.0) : unit_normal(surface, 1.0, t);
      // The normal is exact up to rounding, because the ring of control points beside the pole is in one
      // plane.
      EXPECT_LT((start - Vector3(0, 0, -sign)).norm(), 1e-12) << start.transpose();
      EXPECT_LT((end - Vector3(0, 0, sign)).norm(), 1e-12) << end.transpose();
    }
  }
}

// Compares the normals at the poles with those beside them. For any net, they differ only by what the
// curvature adds over a millionth of the domain.
void expect_limits(const Surface& surface, bool poles_in_v) {
  constexpr double inside = 1e-6, tolerance = 1e-4;
  for (int step = 0; step < 15; ++step) {
    const double t = (step + 0.2) / 15;
    const Vector3 start = poles_in_v ? unit_normal(surface, t, 0.0) : unit_normal(surface, 0.0, t);
    const Vector3 near_start = poles_in_v ? unit_normal(surface, t, inside) : unit_normal(surface, inside, t);
    const Vector3 end = poles_in_v ? unit_normal(surface, t, 1.0) : unit_normal(surface, 1.0, t);
    const Vector3 near_end =
        poles_in_v ? unit_normal(surface, t, 1.0 - inside) : unit_normal(surface, 1.0 - inside, t);
    EXPECT_NEAR(start.norm(), 1.0, 1e-14);
    EXPECT_NEAR(end.norm(), 1.0, 1e-14);
    EXPECT_LT(angle_between(start, near_start), tolerance) << "at " << t;
    EXPECT_LT(angle_between(end, near_end), tolerance) << "at " << t;
  }
}

TEST(UnitNormal, PolesAreTheLimitFromInside) {
  Random random(15);
  for (int repeat = 0; repeat < 20; ++repeat) {
    Surface tube = ellipsoid_tube(tube_around, tube_along, {0.3, -0.2, 0.1});
    for (int i = 0; i < tube_around; ++i) {
      for (int j = 1; j < tube_along - 1; ++j) {
        const Vector3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        tube.net.set_point(i, j, tube.net.point(i, j) + 0.001 * jitter);
      }
    }
    expect_limits(tube, true);
    expect_limits(transposed(tube), false);
  }
}

TEST(UnitNormal, RingsThatCoincideToSinglePrecisionArePoles) {
  Random random(16);
  Surface tube = ellipsoid_tube(tube_around, tube_along);
  for (int i = 0; i < tube_around; ++i) {
    for (const int j : {0, tube_along - 1}) {
      const Vector3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      tube.net.set_point(i, j, tube.net.point(i, j) + 1e-9 * jitter);
    }
  }
  for (int step = 0; step < 20; ++step) {
    const double u = (step + 0.2) / 20;
    // The tolerance is well above the jitter of 1e-9 m divided by the radius of the ring of control points
    // beside the pole, which is at least 3 mm.
    EXPECT_LT(angle_between(unit_normal(tube, u, 0.0), Vector3(0, 0, -1)), 1e-5);
    EXPECT_LT(angle_between(unit_normal(tube, u, 1.0), Vector3(0, 0, 1)), 1e-5);
  }
}

TEST(UnitNormal, PolesWhereTwoRingsCoincideAreStillPoles) {
  Surface tube = ellipsoid_tube(tube_around, tube_along);
  for (int i = 0; i < tube_around; ++i) tube.net.set_point(i, 1, tube.net.point(0, 0));
  for (int step = 0; step < 20; ++step) {
    const double u = (step + 0.2) / 20;
    const Vector3 normal = unit_normal(tube, u, 0.0);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
    EXPECT_LT(angle_between(normal, unit_normal(tube, u, 1e-4)), 0.02);
  }
}

TEST(UnitNormal, ACornerWithParallelTangentsHasTheNormalBesideIt) {
  const auto knots = KnotVector::clamped_uniform(2, 3).value();
  ControlNet net(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) net.set_point(i, j, {double(i), double(j), 0.0});
  }
  // Both edges leave the corner (0, 0) along the same line.
  net.set_point(1, 0, {0.5, -0.5, 0.0});
  net.set_point(0, 1, {-0.5, 0.5, 0.0});
  const Surface surface = make_surface(knots, knots, net).value();
  EXPECT_LT((unit_normal(surface, 0.0, 0.0) - Vector3(0, 0, 1)).norm(), 1e-12);
}

TEST(UnitNormal, AnEdgeWithParallelTangentsHasTheNormalBesideIt) {
  const auto knots = KnotVector::clamped_uniform(2, 3).value();
  ControlNet net(3, 3);
  for (int i = 0; i < 3; ++i) {
    net.set_point(i, 0, {double(i), 0.0, 0.0});
    net.set_point(i, 1, {i + 0.3, 0.0, 0.0});
    net.set_point(i, 2, {i + 0.6, 1.0, 0.5 + 0.2 * i});
  }
  const Surface surface = make_surface(knots, knots, net).value();
  // du = (2, 0, 0) and dvv = (0, 2, 1.4). The normal is their cross product, whatever the normals nearby.
  EXPECT_LT((unit_normal(surface, 0.5, 0.0) - Vector3(0, -1.4, 2).normalized()).norm(), 1e-12);
}

TEST(UnitNormal, AnApexHasOneNormalForEachDirection) {
  const auto u = KnotVector::periodic_uniform(3, 16).value();
  const auto v = KnotVector::clamped_uniform(1, 2).value();
  ControlNet net(16, 2);
  for (int i = 0; i < 16; ++i) {
    const double angle = 2.0 * 3.141592653589793 * i / 16;
    net.set_point(i, 0, {0, 0, 0});
    net.set_point(i, 1, {std::cos(angle), std::sin(angle), 1.0});
  }
  const Surface cone = make_surface(u, v, net).value();
  for (int step = 0; step < 10; ++step) {
    const double t = (step + 0.2) / 10;
    EXPECT_LT((unit_normal(cone, t, 0.0) - unit_normal(cone, t, 0.5)).norm(), 1e-12);
  }
}

TEST(UnitNormal, PointsAndLinesHaveNone) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  ControlNet point(6, 6), line(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      point.set_point(i, j, {0.1, 0.7, -0.3});
      line.set_point(i, j, Vector3(0.1, 0.7, -0.3) + (i * 0.37 + j * 0.11) * Vector3(1, 2, -0.5));
    }
  }
  const Surface point_surface = make_surface(knots, knots, point).value();
  const Surface line_surface = make_surface(knots, knots, line).value();
  for (const double u : uniform_parameters(knots, 9)) {
    for (const double v : uniform_parameters(knots, 9)) {
      EXPECT_EQ(unit_normal(point_surface, u, v), Vector3::Zero());
      EXPECT_EQ(unit_normal(line_surface, u, v), Vector3::Zero());
    }
  }
}

}  // namespace
}  // namespace spoonbill
