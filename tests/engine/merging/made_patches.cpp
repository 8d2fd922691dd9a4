#include "tests/engine/merging/made_patches.h"

#include <cmath>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

MergeRequest request_of(int continuity, double tolerance_m) {
  MergeRequest request;
  request.join.continuity = continuity;
  request.join.tolerance_m = tolerance_m;
  return request;
}

Surface ring_strip(double from, double to, int count, double seam) {
  const auto u = KnotVector::periodic_uniform(3, count).value();
  const auto v = KnotVector::clamped_uniform(3, 5).value();
  PointGrid points{uniform_parameters_without_seam(u, 4 * count), uniform_parameters(v, 20), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      const double angle = 2.0 * std::numbers::pi * (a + seam), along = from + (to - from) * b;
      const double radius = 0.01 + 0.1 * along;
      points.points_m.emplace_back(radius * std::cos(angle), radius * std::sin(angle), along);
    }
  }
  return fit_grid(u, v, points).value();
}

Surface sheet_between(const std::function<double(double)>& low, const std::function<double(double)>& high,
                      double warp) {
  const auto knots = KnotVector::clamped_uniform(3, 12).value();
  PointGrid points{uniform_parameters(knots, 60), uniform_parameters(knots, 30), {}};
  for (const double a : points.u) {
    const double t = a + warp * a * (1.0 - a), x = 0.06 * t;
    for (const double b : points.v) points.points_m.emplace_back(x, 0.0, low(x) + (high(x) - low(x)) * b);
  }
  return fit_grid(knots, knots, points).value();
}

Surface level_sheet(double from, double to, int columns) {
  const auto u = KnotVector::clamped_uniform(3, 6).value();
  const auto v = with_domain(KnotVector::clamped_uniform(3, columns).value(), from, to).value();
  PointGrid points{uniform_parameters(u, 20), uniform_parameters(v, 3 * columns), {}};
  for (const double a : points.u) {
    for (const double b : points.v) points.points_m.emplace_back(0.06 * a, 0.0, b);
  }
  return fit_grid(u, v, points).value();
}

Surface ring_body() {
  constexpr int count = 12;
  const auto knots = KnotVector::periodic_uniform(3, count).value();
  ControlNet net(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double turn = M_PI * i / 6.0, around = M_PI * j / 6.0, out = 0.02 + 0.008 * std::cos(around);
      net.set_point(i, j, {out * std::cos(turn), out * std::sin(turn), 0.008 * std::sin(around)});
    }
  }
  return {knots, knots, net};
}

bool is_without_folds(const Surface& surface) {
  const double start = surface.v.domain_start(), end = surface.v.domain_end();
  for (double u = 0.0; u < 1.0; u += 0.02) {
    Vector3 last = unit_normal(surface, u, start);
    for (int k = 1; k <= 200; ++k) {
      const Vector3 next = unit_normal(surface, u, start + (end - start) * k / 200);
      if (next.dot(last) < 0.0) return false;
      last = next;
    }
  }
  return true;
}

}  // namespace spoonbill
