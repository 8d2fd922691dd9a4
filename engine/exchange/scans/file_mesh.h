// The triangles of a mesh file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Largest number of corners of one face of a file.
inline constexpr std::size_t face_corner_limit = 4096;

// Vertices in the file's own unit, and triangles with valid indices. Coordinates may be NaN or infinite.
struct FileMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace spoonbill
