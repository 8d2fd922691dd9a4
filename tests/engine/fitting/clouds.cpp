#include "tests/engine/fitting/clouds.h"

#include <cmath>
#include <numbers>
#include <random>

namespace spoonbill {

using std::numbers::pi;

Scan ellipsoid_cloud(int count, const Vector3& semi_axes_m) {
  Scan scan;
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / count, radius = std::sqrt(1.0 - z * z);
    const double angle = k * pi * (3.0 - std::sqrt(5.0));
    scan.points_m.push_back(
        semi_axes_m.cwiseProduct(Vector3(radius * std::cos(angle), radius * std::sin(angle), z)));
  }
  return scan;
}

Scan random_cloud(int count, std::uint64_t seed, const std::function<Vector3(double, double)>& place) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Scan scan;
  for (int k = 0; k < count; ++k) {
    const double s = share(random), t = share(random);
    scan.points_m.push_back(place(s, t));
  }
  return scan;
}

Vector3 on_cylinder(double s, double t, double radius_m, double length_m) {
  return {radius_m * std::cos(2.0 * pi * s), radius_m * std::sin(2.0 * pi * s), t * length_m};
}

Vector3 on_torus_sector(double s, double t, double displacement_m, double tube_m) {
  const double reach = displacement_m + tube_m * std::cos(2.0 * pi * s), turn = 0.5 * pi * t;
  return {reach * std::cos(turn), reach * std::sin(turn), tube_m * std::sin(2.0 * pi * s)};
}

double waves_height(double x_m, double y_m, double width_m, double height_m) {
  return height_m * std::sin(2.0 * pi * x_m / width_m) * std::cos(2.0 * pi * y_m / width_m);
}

Vector3 on_waves(double s, double t, double width_m, double height_m) {
  const double x = s * width_m, y = t * width_m;
  return {x, y, waves_height(x, y, width_m, height_m)};
}

void add_noise(Scan& scan, std::uint64_t seed, double deviation_m) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, deviation_m);
  for (Vector3& point : scan.points_m) {
    for (int axis = 0; axis < 3; ++axis) point[axis] += noise(random);
  }
}

void add_outliers(Scan& scan, std::uint64_t seed, double share) {
  std::mt19937_64 random(seed);
  Vector3 low = scan.points_m.front(), high = low;
  for (const Vector3& point : scan.points_m) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const auto count = static_cast<std::size_t>(share * static_cast<double>(scan.points_m.size()));
  for (std::size_t k = 0; k < count; ++k) {
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = std::uniform_real_distribution<double>(low[axis], high[axis])(random);
    }
    scan.points_m.push_back(point);
  }
}

void leave_out(Scan& scan, const std::function<bool(const Vector3&)>& out) {
  std::erase_if(scan.points_m, out);
}

void append(Scan& scan, const Scan& other, const Vector3& moved_m) {
  for (const Vector3& point : other.points_m) scan.points_m.push_back(point + moved_m);
}

}  // namespace spoonbill
