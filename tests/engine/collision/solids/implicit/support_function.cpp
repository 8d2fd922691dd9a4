#include "tests/engine/collision/solids/implicit/support_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace spoonbill {
namespace {

double across(const Vector3& n) {
  return std::hypot(n.x(), n.z());
}

struct SupportFunction {
  const Vector3& n;

  double operator()(const SphereShape& s) const { return s.radius_m; }
  double operator()(const EllipsoidShape& s) const { return s.semi_axes_m.cwiseProduct(n).norm(); }
  double operator()(const CylinderShape& s) const {
    return s.radius_m * across(n) + s.half_length_m * std::abs(n.y());
  }
  double operator()(const CapsuleShape& s) const { return s.radius_m + s.half_length_m * std::abs(n.y()); }
  double operator()(const BoxShape& s) const { return s.half_extents_m.dot(n.cwiseAbs()); }
  double operator()(const ConeShape& s) const {
    return std::max(s.base_radius_m * across(n), s.height_m * n.y());
  }
  double operator()(const TorusShape& s) const { return s.ring_radius_m * across(n) + s.tube_radius_m; }
  double operator()(const HalfSpaceShape&) const { return HUGE_VAL; }
  // The dual of a norm with exponent q has the exponent q / (q - 1); nested norms have nested duals.
  double operator()(const SuperquadricShape& s) const {
    const auto norm = [](double a, double b, double exponent) {
      const double power = 1.0 / (1.0 - 0.5 * exponent), high = std::max(a, b);
      return high > 0.0 ? high * std::pow(std::pow(a / high, power) + std::pow(b / high, power), 1.0 / power)
                        : 0.0;
    };
    const Vector3 w = s.semi_axes_m.cwiseProduct(n.cwiseAbs());
    return norm(norm(w.x(), w.z(), s.exponent_around), w.y(), s.exponent_along);
  }
};

struct Found {
  double value;
  Vector3 direction;
};

Found climb(const ImplicitShape& shape, const Vector3& point, Found best) {
  double step = 0.03;
  for (int round = 0; round < 49; ++round, step *= 0.7) {
    for (bool better = true; better;) {
      better = false;
      const Vector3 side = best.direction.unitOrthogonal(), other = best.direction.cross(side);
      for (int k = 0; k < 24; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 24;
        const Vector3 n =
            (best.direction + step * (std::cos(angle) * side + std::sin(angle) * other)).normalized();
        const double value = n.dot(point) - support(shape, n);
        if (value <= best.value) continue;
        best = {value, n};
        better = true;
      }
    }
  }
  return best;
}

}  // namespace

double support(const ImplicitShape& shape, const Vector3& direction) {
  return std::visit(SupportFunction{direction}, shape);
}

double distance_by_support(const ImplicitShape& shape, const Vector3& point) {
  std::vector<Found> found;
  constexpr int count = 2000;
  for (int k = 0; k < count; ++k) {
    const double height = 1.0 - (2.0 * k + 1.0) / count,
                 angle = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double out = std::sqrt(1.0 - height * height);
    const Vector3 n(out * std::cos(angle), height, out * std::sin(angle));
    found.push_back({n.dot(point) - support(shape, n), n});
  }
  for (int axis = 0; axis < 6; ++axis) {
    const Vector3 n = (axis < 3 ? 1.0 : -1.0) * Vector3::Unit(axis % 3);
    found.push_back({n.dot(point) - support(shape, n), n});
  }
  std::partial_sort(found.begin(), found.begin() + 20, found.end(),
                    [](const Found& a, const Found& b) { return a.value > b.value; });
  double best = found[0].value;
  for (int k = 0; k < 20; ++k) best = std::max(best, climb(shape, point, found[k]).value);
  return best;
}

Vector3 random_in_cube(Random& random) {
  const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0);
  return {x, y, random.uniform(-1.0, 1.0)};
}

Vector3 random_direction(Random& random) {
  Vector3 at = random_in_cube(random);
  while (!(at.norm() > 0.1 && at.norm() < 1.0)) at = random_in_cube(random);
  return at.normalized();
}

ImplicitShape random_convex_shape(Random& random, int kind) {
  const auto length = [&] { return 1e-3 * std::pow(10.0, random.uniform(0.0, 2.0)); };
  const double a = length(), b = length(), c = length();
  const double e1 = random.uniform(superquadric_exponent.low, superquadric_exponent.high),
               e2 = random.uniform(superquadric_exponent.low, superquadric_exponent.high);
  switch (kind) {
    case 0:
      return SphereShape{a};
    case 1:
      return EllipsoidShape{{a, b, c}};
    case 2:
      return CylinderShape{a, b};
    case 3:
      return CapsuleShape{a, b};
    case 4:
      return BoxShape{{a, b, c}};
    case 5:
      return ConeShape{a, b};
    default:
      return SuperquadricShape{{a, b, c}, e1, e2};
  }
}

Quaternion random_turn(Random& random) {
  const Vector3 axis = random_direction(random);
  return Quaternion(Eigen::AngleAxisd(random.uniform(0.0, 3.1), axis));
}

}  // namespace spoonbill
