// Makes vertices in the same place one.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

struct JoinedVertices {
  std::vector<Vector3> vertices_m;         // those that stay, in the order in which they were first met
  std::vector<std::uint32_t> joined_into;  // of each vertex given, into vertices_m
};

// A vertex joins an earlier one that stays and is equal, or no farther than the tolerance. Coordinates must
// be finite and the tolerance above 0. Time grows with the number of vertices, whatever their places.
JoinedVertices join_vertices(const std::vector<Vector3>& vertices_m, double tolerance_m);

}  // namespace spoonbill
