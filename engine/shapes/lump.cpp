#include "engine/shapes/lump.h"

#include <algorithm>
#include <limits>

#include "engine/base/assert.h"
#include "engine/base/box.h"

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

double reach_of(const SphereSize& size) {
  return size.radius_m;
}
// What is convex curves nowhere more than its roundings.
double reach_of(const BoxSize& size) {
  return size.rounding_m;
}
double reach_of(const CylinderSize& size) {
  return size.rounding_m;
}
double reach_of(const ConeSize& size) {
  return size.rounding_m;
}
double reach_of(const PlateSize& size) {
  return 0.5 * size.thickness_m;
}
double reach_of(const SheetSize&) {
  return std::numeric_limits<double>::infinity();
}
double reach_of(const TorusSize& size) {
  return std::min(size.tube_radius_m, size.ring_radius_m - size.tube_radius_m);
}

}  // namespace

double reach_m(const LumpSize& size) {
  return std::visit([](const auto& sizes) { return reach_of(sizes); }, size);
}

Result<ExactShape> lump_shape(const LumpSize& size) {
  return std::visit([](const auto& sizes) { return shape_of(sizes); }, size);
}

double usual_tolerance_m(const ExactShape& shape) {
  SPOONBILL_ASSERT(static_cast<bool>(shape.at));
  constexpr int steps = 16;
  Box box;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const auto at = [&](const ShapeDirection& direction, int k) {
        return direction.start() + (direction.end() - direction.start()) * k / steps;
      };
      box.include(shape.at(at(shape.u, i), at(shape.v, j)));
    }
  }
  const Vector3 size = box.extent();
  return std::min(1e-5 * std::max(1.0, size.minCoeff()), 1e-3 * size.maxCoeff());
}

}  // namespace spoonbill
