#include "app/report/surface_extent.h"

#include "engine/bspline/grid.h"

namespace spoonbill {
namespace {

constexpr int samples = 201;

}  // namespace

Box extent_of(const Surface& surface) {
  const Vector3 far = Vector3::Constant(1e30);
  Box box{far, -far};
  const auto v_parameters = uniform_parameters(surface.v, samples);
  for (const double u : uniform_parameters(surface.u, samples)) {
    for (const double v : v_parameters) {
      const Vector3 point = position(surface, u, v);
      box = joined(box, {point, point});
    }
  }
  return box;
}

}  // namespace spoonbill
