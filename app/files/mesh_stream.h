// A mesh or a cloud as bytes between two runs of this program on one machine: eight letters, two counts of 64
// bits, then of a mesh three doubles a vertex and three 32-bit indices a triangle; of a cloud how many points
// were skipped in 64 bits, then three doubles a point and three a normal. Or other letters, a length, and the
// line that says why there is none.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>

#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {

struct MeshStreamHead {
  static constexpr std::uint64_t mesh = 0x6873656d6c6e7073;     // "spnlmesh" in little-endian order
  static constexpr std::uint64_t cloud = 0x64756c636c6e7073;    // "spnlclud"
  static constexpr std::uint64_t faces = 0x656361666c6e7073;    // "spnlface": no cloud but a mesh; no more
  static constexpr std::uint64_t failure = 0x6c6961666c6e7073;  // "spnlfail"
  static constexpr std::uint64_t longest_failure = 400;         // bytes
  std::uint64_t letters = 0;
  std::uint64_t first_count = 0;   // vertices, points, or the length of the failure
  std::uint64_t second_count = 0;  // triangles, or normals
};

void write_mesh(std::ostream& out, const TriangleMesh& mesh);
void write_cloud(std::ostream& out, const PointCloud& cloud);
void write_has_faces(std::ostream& out);

// The failure of a child that has not the memory for its file.
inline constexpr const char* bad_allocation = "bad allocation";

// As one line of printable letters, cut to the longest.
void write_failure(std::ostream& out, const std::string& message);

}  // namespace spoonbill
