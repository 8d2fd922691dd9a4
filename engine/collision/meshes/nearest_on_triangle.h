// The nearest point of a triangle, and on which of its features it lies.
#pragma once

#include <cstdint>

#include "engine/base/geometry.h"

namespace spoonbill {

struct NearestOnTriangle {
  Vector3 point = Vector3::Zero();
  enum class On : std::uint8_t { face, side, corner } on = On::face;
  std::uint32_t which = 0;  // side k goes from corner k to the next
};

// By the Voronoi regions of its features (Ericson 2005, 5.1.5). The triangle must have an area.
NearestOnTriangle nearest_on_triangle(const Vector3& a, const Vector3& b, const Vector3& c,
                                      const Vector3& point);

}  // namespace spoonbill
