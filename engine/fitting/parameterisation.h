// Where points lie in the (u, v) square of a surface that is still to be fitted to them.
#pragma once

#include <string_view>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

enum class ShapeKind { sheet, tube, closed };

constexpr std::string_view name_of(ShapeKind kind) {
  return kind == ShapeKind::sheet ? "sheet" : kind == ShapeKind::tube ? "tube" : "closed";
}

// A sheet is open both ways, a tube periodic in u with open ends, a closed shape periodic in u with a pole at
// both ends of v.
struct Parameterisation {
  ShapeKind kind = ShapeKind::sheet;
  std::vector<Vector2> uv;  // of each point, within 0..1; NaN for those that have none yet
};

}  // namespace spoonbill
