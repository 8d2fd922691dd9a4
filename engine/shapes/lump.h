// The lumps of clay a designer starts from, by their sizes.
#pragma once

#include <variant>

#include "engine/base/result.h"
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

// Nearer than this to the shape, every point has but one place of it nearest: a surface within it that does
// not fold meets itself nowhere (the reach of Federer 1959). Without limit of a sheet.
double reach_m(const LumpSize& size);

// The tolerance of a lump's fit where none is named: 0.01 mm; a thousandth of a body smaller than 10 mm, a
// hundred-thousandth of one that is larger than 1 m every way.
double usual_tolerance_m(const ExactShape& shape);

}  // namespace spoonbill
