#include "render/passes/lathe.h"

#include <cmath>
#include <numbers>

namespace spoonbill {
namespace {

// A point of the profile: distance from the axis, height, and the normal in that plane.
struct ProfilePoint {
  float radius, height, normal_out, normal_up;
};

SolidVertex turned(const ProfilePoint& p, double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{p.radius * c, p.height, p.radius * s}, {p.normal_out * c, p.normal_up, p.normal_out * s}};
}

// The band between two profile points, the lower one first.
void append_band(const ProfilePoint& low, const ProfilePoint& high, int segments,
                 std::vector<SolidVertex>& vertices) {
  for (int i = 0; i < segments; ++i) {
    const double a = 2.0 * std::numbers::pi * i / segments;
    const double b = 2.0 * std::numbers::pi * (i + 1) / segments;
    const SolidVertex low_a = turned(low, a), low_b = turned(low, b);
    const SolidVertex high_a = turned(high, a), high_b = turned(high, b);
    for (const SolidVertex& v : {low_a, high_b, low_b, low_a, high_a, high_b}) vertices.push_back(v);
  }
}

}  // namespace

std::vector<SolidVertex> lathe_sphere(int segments) {
  std::vector<SolidVertex> vertices;
  const int bands = segments / 2;
  const auto at = [&](int band) {
    const double latitude = std::numbers::pi * (static_cast<double>(band) / bands - 0.5);
    const auto out = static_cast<float>(std::cos(latitude)), up = static_cast<float>(std::sin(latitude));
    return ProfilePoint{out, up, out, up};
  };
  for (int band = 0; band < bands; ++band) append_band(at(band), at(band + 1), segments, vertices);
  return vertices;
}

std::vector<SolidVertex> lathe_cylinder(int segments) {
  std::vector<SolidVertex> vertices;
  append_band({0, 0, 0, -1}, {1, 0, 0, -1}, segments, vertices);
  append_band({1, 0, 1, 0}, {1, 1, 1, 0}, segments, vertices);
  append_band({1, 1, 0, 1}, {0, 1, 0, 1}, segments, vertices);
  return vertices;
}

std::vector<SolidVertex> lathe_cone(int segments) {
  std::vector<SolidVertex> vertices;
  const auto slant = static_cast<float>(std::numbers::sqrt2 / 2.0);
  append_band({0, 0, 0, -1}, {1, 0, 0, -1}, segments, vertices);
  append_band({1, 0, slant, slant}, {0, 1, slant, slant}, segments, vertices);
  return vertices;
}

std::vector<SolidVertex> unit_pane() {
  const Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  const SolidVertex a{{0, 0, 0}, normal}, b{{1, 0, 0}, normal}, c{{1, 1, 0}, normal}, d{{0, 1, 0}, normal};
  return {a, b, c, a, c, d};
}

}  // namespace spoonbill
