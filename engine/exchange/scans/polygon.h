// Polygons cut into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Appends the triangles of a polygon of three or more corners, which are indices of `points`. Ears are
// clipped in the plane of the polygon's area (Meisters 1975), so that a concave polygon is covered once. The
// number of triangles is always the number of corners minus two, even if the polygon has no area or crosses
// itself. The time is at most proportional to the square of the number of corners.
void cut_polygon(std::span<const std::uint32_t> corners, const std::vector<Vector3>& points,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace spoonbill
