#include "tests/engine/shapes/body_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "engine/collision/surfaces/surface_self_collider.h"

namespace spoonbill {
namespace {

constexpr int random_points = 20000;
constexpr int steps = 200;

// Six-point Gauss-Legendre quadrature (Abramowitz and Stegun 1964, table 25.4) is exact up to degree 11; a
// triple product of bicubics has degree 8.
constexpr std::array<double, 3> nodes = {0.238619186083197, 0.661209386466265, 0.932469514203152};
constexpr std::array<double, 3> weights = {0.467913934572691, 0.360761573048139, 0.171324492379170};

template <class Integrand>
double integral(const Surface& surface, Integrand integrand) {
  const std::vector<double> u = surface.u.breakpoints(), v = surface.v.breakpoints();
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const double half_u = 0.5 * (u[i + 1] - u[i]), half_v = 0.5 * (v[j + 1] - v[j]);
      for (int a = 0; a < 6; ++a) {
        for (int b = 0; b < 6; ++b) {
          const auto node = [](int n) { return n < 3 ? -nodes[n] : nodes[n - 3]; };
          const SurfacePoint point =
              evaluate(surface, u[i] + half_u * (1.0 + node(a)), v[j] + half_v * (1.0 + node(b)));
          sum += weights[a % 3] * weights[b % 3] * half_u * half_v * integrand(point);
        }
      }
    }
  }
  return sum;
}

struct Parameters {
  double u, v;
};

std::vector<Parameters> random_parameters(const Surface& surface) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(surface.u.domain_start(), surface.u.domain_end());
  std::uniform_real_distribution<double> v(surface.v.domain_start(), surface.v.domain_end());
  std::vector<Parameters> all(random_points);
  for (Parameters& one : all) {
    one.u = u(generator);
    one.v = v(generator);
  }
  return all;
}

double at(const KnotVector& knots, double share) {
  return knots.domain_start() + share * (knots.domain_end() - knots.domain_start());
}

}  // namespace

double volume_m3(const Surface& surface) {
  return integral(surface, [](const SurfacePoint& p) { return p.position_m.dot(p.du.cross(p.dv)) / 3.0; });
}

double area_m2(const Surface& surface) {
  return integral(surface, [](const SurfacePoint& p) { return p.du.cross(p.dv).norm(); });
}

double largest_distance_m(const Surface& surface, const std::function<double(const Vector3&)>& distance) {
  double largest = 0.0;
  for (const auto& [u, v] : random_parameters(surface)) {
    largest = std::max(largest, std::abs(distance(position(surface, u, v))));
  }
  return largest;
}

double least_outward(const Surface& surface, const std::function<double(const Vector3&)>& distance) {
  double least = 1.0;
  for (const auto& [u, v] : random_parameters(surface)) {
    const Vector3 point = position(surface, u, v);
    Vector3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 step = 1e-7 * Vector3::Unit(axis);
      gradient[axis] = distance(point + step) - distance(point - step);
    }
    least = std::min(least, unit_normal(surface, u, v).dot(gradient.normalized()));
  }
  return least;
}

Evenness evenness(const Surface& surface) {
  Evenness result;
  std::array<double, 2> along = {1e30, 0.0}, around = {1e30, 0.0};
  for (int k = 0; k < steps; ++k) {
    const double share = static_cast<double>(k) / steps, next = static_cast<double>(k + 1) / steps;
    double step = 0.0;  // sum of the steps over a ring of points
    for (int i = 0; i < 16; ++i) {
      const double u = at(surface.u, i / 16.0);
      step += (position(surface, u, at(surface.v, next)) - position(surface, u, at(surface.v, share))).norm();
    }
    along = {std::min(along[0], step), std::max(along[1], step)};
    const double middle = at(surface.v, 0.5);
    const double part =
        (position(surface, at(surface.u, next), middle) - position(surface, at(surface.u, share), middle))
            .norm();
    around = {std::min(around[0], part), std::max(around[1], part)};
  }
  result.along = along[1] / along[0];
  result.around = around[1] / around[0];
  return result;
}

double seam_jump(const Surface& surface) {
  // The parameter step is so small that no derivative across a smooth seam changes by more than a thousandth.
  const double start = surface.u.domain_start(), end = surface.u.domain_end(), step = 1e-7 * (end - start);
  double largest = 0.0;
  for (int k = 1; k < 16; ++k) {
    const double v = at(surface.v, k / 16.0);
    const SurfacePoint before = evaluate(surface, end - step, v), after = evaluate(surface, start + step, v);
    largest = std::max({largest, (before.position_m - after.position_m).norm() / before.du.norm(),
                        (before.du - after.du).norm() / before.du.norm(),
                        (before.duu - after.duu).norm() / (before.du.norm() / (end - start))});
  }
  return largest;
}

bool is_self_intersecting(const Surface& surface, bool closed) {
  const auto grid = make_nested_grid(surface.u, surface.v, 0);
  EXPECT_TRUE(grid.ok());
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = closed;
  return collider.collide(surface, query).touching;
}

FittedShape fitted(const Result<ExactShape>& shape, const ShapeFit& fit) {
  EXPECT_TRUE(shape.ok()) << (shape.ok() ? "" : shape.error().message);
  auto result = fit_shape(shape.value(), fit);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return std::move(result).value();
}

}  // namespace spoonbill
