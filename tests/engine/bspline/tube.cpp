#include "tests/engine/bspline/tube.h"

#include <cmath>
#include <numbers>

namespace spoonbill {

Surface ellipsoid_tube(int around, int along, const Vector3& centre) {
  const auto u = KnotVector::periodic_uniform(3, around).value();
  const auto v = KnotVector::clamped_uniform(3, along).value();
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j < along; ++j) {
      const bool pole = j == 0 || j == along - 1;
      const double latitude =
          std::numbers::pi * (std::min(std::max(j - 1, 0), along - 3) / (along - 3.0) - 0.5);
      const double radius = pole ? 0.0 : 0.3 + std::cos(latitude);
      net.set_point(i, j,
                    centre + Vector3(0.02 * radius * std::cos(angle), 0.01 * radius * std::sin(angle),
                                     0.05 * std::sin(latitude)));
    }
  }
  return make_surface(u, v, std::move(net)).value();
}

Surface transposed(const Surface& surface) {
  ControlNet net(surface.net.columns, surface.net.rows);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, surface.net.point(j, i));
  }
  return make_surface(surface.v, surface.u, std::move(net)).value();
}

}  // namespace spoonbill
