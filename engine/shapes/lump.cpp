#include "engine/shapes/lump.h"

#include <algorithm>

namespace spoonbill {

namespace {

Result<ExactShape> shape_of(const SphereSize& size) {
  return sphere_shape(size.radius_m);
}
Result<ExactShape> shape_of(const BoxSize& size) {
  return box_shape(size);
}
Result<ExactShape> shape_of(const CylinderSize& size) {
  return cylinder_shape(size);
}
Result<ExactShape> shape_of(const ConeSize& size) {
  return cone_shape(size);
}
Result<ExactShape> shape_of(const PlateSize& size) {
  return plate_shape(size);
}
Result<ExactShape> shape_of(const SheetSize& size) {
  return sheet_shape(size.x_size_m, size.z_size_m);
}
Result<ExactShape> shape_of(const TorusSize& size) {
  return torus_shape(size);
}

}  // namespace

Result<ExactShape> lump_shape(const LumpSize& size) {
  return std::visit([](const auto& sizes) { return shape_of(sizes); }, size);
}

double usual_tolerance_m(const ExactShape& shape) {
  constexpr int steps = 16;
  Vector3 low = Vector3::Constant(1e30), high = -low;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const auto at = [&](const ShapeDirection& direction, int k) {
        return direction.start() + (direction.end() - direction.start()) * k / steps;
      };
      const Vector3 point = shape.at(at(shape.u, i), at(shape.v, j));
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  const double size = (high - low).maxCoeff();
  return std::clamp(1e-5, 1e-5 * size, 1e-3 * size);
}

}  // namespace spoonbill
