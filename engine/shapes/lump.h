// The lumps of clay a designer starts from, by their sizes.
#pragma once

#include <variant>

#include "engine/result.h"
#include "engine/shapes/box_shapes.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/round_shapes.h"

namespace spoonbill {

struct SphereSize {
  double radius_m = 0.03;
};

struct SheetSize {
  double x_size_m = 0.1, z_size_m = 0.06;
};

using LumpSize = std::variant<SphereSize, BoxSize, CylinderSize, ConeSize, PlateSize, SheetSize, TorusSize>;

// Refused with the size that is out of range.
Result<ExactShape> lump_shape(const LumpSize& size);

// The tolerance of a lump's fit where none is named: 0.01 mm, but at most a thousandth of its body's size and
// at least a hundredth of that.
double usual_tolerance_m(const ExactShape& shape);

}  // namespace spoonbill
