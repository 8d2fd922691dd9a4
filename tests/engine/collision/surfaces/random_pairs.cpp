#include "tests/engine/collision/surfaces/random_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

KnotVector knots_of(Random& random) {
  const int degree = random.integer(1, 5);
  return random_knots(random, degree, random.integer(0, 2) == 0 ? KnotKind::periodic : KnotKind::clamped);
}

Vector3 pair_direction(Random& random) {
  for (;;) {
    const Vector3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

template <class Change>
void change_points(Surface& surface, const Change& change) {
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) {
      surface.net.set_point(i, j, change(surface.net.point(i, j)));
    }
  }
}

// Folds the half of the sheet with positive x over the other half. The heights of the folded half are scaled
// by -0.2 and raised by 0.05.
Vector3 folded(const Vector3& point) {
  return point.x() < 0.0 ? point : Vector3(-point.x(), 0.05 - 0.2 * point.y(), point.z());
}

Surface any_surface(Random& random, std::string& kind) {
  Surface surface = random_surface(random, knots_of(random), knots_of(random));
  switch (random.integer(0, 3)) {
    case 0:
      kind += "plain";
      break;
    case 1: {
      kind += "thin";
      const double width = random.uniform(0.005, 0.05);
      change_points(surface, [&](const Vector3& p) { return Vector3(width * p.x(), p.y(), p.z()); });
      break;
    }
    case 2:
      kind += "folded";
      change_points(surface, folded);
      break;
    default: {
      kind += "spiked";
      const int i = random.integer(0, surface.net.rows - 1), j = random.integer(0, surface.net.columns - 1);
      surface.net.set_point(i, j, surface.net.point(i, j) + Vector3(0, random.uniform(1, 3), 0));
    }
  }
  const Eigen::AngleAxisd turn(random.uniform(0, 6.28), pair_direction(random));
  change_points(surface, [&](const Vector3& p) -> Vector3 { return turn * p; });
  return surface;
}

}  // namespace

void move(Surface& surface, const Vector3& by) {
  change_points(surface, [&](const Vector3& p) -> Vector3 { return p + by; });
}

RandomPair random_pair(Random& random, double apart_m) {
  std::string kind;
  Surface first = any_surface(random, kind);
  kind += " and ";
  Surface second = any_surface(random, kind);
  move(second, random.uniform(0, apart_m) * pair_direction(random));
  return {std::move(first), std::move(second), std::move(kind)};
}

}  // namespace spoonbill
