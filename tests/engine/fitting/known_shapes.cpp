#include "tests/engine/fitting/known_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/bspline/surface.h"

namespace spoonbill {

double farthest_off(const Surface& surface, const Distance& distance) {
  double farthest = 0.0;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j <= 60; ++j) {
      farthest = std::max(farthest, distance(position(surface, i / 60.0, j / 60.0)));
    }
  }
  return farthest;
}

ScanFit fit(const Scan& scan, int control, IslandChoice islands) {
  FitRequest request;
  request.settings.control_u = request.settings.control_v = control;
  request.islands = islands;
  auto fitted = fit_scan(scan, request);
  EXPECT_TRUE(fitted) << fitted.error().message;
  return fitted ? std::move(fitted).value() : ScanFit{};
}

Distance from_sphere(double radius_m) {
  return [=](const Vector3& point) { return std::abs(point.norm() - radius_m); };
}

double volume_of(const Surface& surface) {
  double volume = 0.0;
  constexpr int grid = 200;
  for (int k = 0; k < grid * grid; ++k) {
    const SurfacePoint at = evaluate(surface, (k / grid + 0.5) / grid, (k % grid + 0.5) / grid);
    volume += at.position_m.dot(at.du.cross(at.dv)) / (3.0 * grid * grid);
  }
  return volume;
}

}  // namespace spoonbill
