// A hole cut into an island of a scan, where a bridge begins.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/fitting/fit_points.h"

namespace spoonbill {

inline constexpr std::size_t nodes_around_bridge = 24;

struct Opening {
  FitPoints island;  // without the nodes that were cut out
  std::vector<std::uint32_t>
      rim;  // nodes_around_bridge nodes of the island, evenly along the hole's rim,
            // counterclockwise as seen from outside; none of an island that is too small
};

// Cuts out the nodes around one, by their ways along the surface; the points of what went belong to the
// nearest node that stayed. The rim is the shortest closed way through its nodes, where a step counts for
// more the more the normals turn, from their order around a view, or around the plane to which the surface is
// unrolled along the shortest ways (Schmidt, Grimm and Wyvill 2006): over the edge of a thin wall a rim lies
// folded on itself in all views. `towards` is where an island without normals is seen from.
Opening opened_at(const FitPoints& whole, std::uint32_t node, const Vector3& towards);

}  // namespace spoonbill
