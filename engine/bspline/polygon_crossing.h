// Whether polygons in the plane cross themselves or each other. Pure, outside the tick; any thread.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace spoonbill {

// Of two edges that cross: the polygons that they belong to, which may be one, and a point near the crossing.
struct PolygonCrossing {
  std::size_t first = 0, second = 0;  // first <= second
  Eigen::Vector2d near;
};

// Edges that only touch, within `tolerance` (above 0) along each axis, do not cross. The time grows as edges
// times those that lie beside them in x.
std::optional<PolygonCrossing> find_crossing(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                             const Eigen::Vector2d& tolerance);

}  // namespace spoonbill
