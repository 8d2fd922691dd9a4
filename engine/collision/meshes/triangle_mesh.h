// Triangles as files hold them, and their cleaning: one treatment for every file, told in a report.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

using TriangleCorners = std::array<std::uint32_t, 3>;

struct TriangleMesh {
  std::vector<Vector3> vertices_m;
  std::vector<TriangleCorners> triangles;  // into vertices_m; counter-clockwise seen from outside
};

// Triangles that hang together over the edges that exactly two of them share. No other part has any of their
// vertices. A part that is not closed is a sheet without an inside.
struct MeshPart {
  std::uint32_t first_vertex = 0, end_vertex = 0;
  std::uint32_t first_triangle = 0, end_triangle = 0;
  bool closed = false;
  int cavity_of = -1;  // the closed part whose hollow this one bounds, facing into it; -1 for none
};

// What cleaning found and did.
struct MeshReport {
  std::size_t vertices_read = 0, triangles_read = 0;
  std::size_t vertices_joined = 0;
  std::size_t degenerate_dropped = 0;  // two corners in one place, or all three on a line
  std::size_t duplicates_dropped = 0;  // the same three corners, whichever way round
  std::size_t triangles_turned = 0;    // against most others of their part
  std::size_t parts_turned = 0;        // closed and inside out
  std::size_t open_edges = 0;          // of one triangle, before holes are filled
  std::size_t branching_edges = 0;     // of more than two triangles
  std::size_t holes_filled = 0;
  std::size_t specks_dropped = 0;  // small open parts beside closed ones
  std::size_t closed_parts = 0, cavities = 0, sheets = 0;
  Vector3 size_m = Vector3::Zero();
};

struct CleanMesh {
  TriangleMesh mesh;
  std::vector<MeshPart> parts;  // in the order of their triangles
  MeshReport report;
};

// Six million triangles are read and cleaned in bounded time and memory; more than a tool needs.
inline constexpr std::size_t mesh_triangle_limit = 6'000'000;
// Vertices nearer than this share of the mesh's size are one: above the rounding of single precision, which
// most files have, and below what a hand can make.
inline constexpr double vertex_joining_share = 1e-6;
// Triangles whose height is below this share have no normal worth the name.
inline constexpr double degenerate_share = 1e-9;
// The holes of a part are filled, each by a fan about its middle, when that adds no more than this share to
// its area: what a scanner missed. A part with larger openings is a sheet, and left as it is.
inline constexpr double hole_share = 0.05;
// Open parts below this share of the area of the closed ones are a scanner's dust, or fins on an edge.
inline constexpr double speck_share = 1e-3;

// Joins vertices, drops degenerate and repeated triangles, turns each part's triangles to face one way, fills
// small holes, drops specks and turns closed parts outward; a part facing the other way inside one that it
// does not touch is a cavity and stays one. `source` begins the line of an Error: no triangle left, an index
// beyond the vertices, a coordinate that is no number or outside position_range_m, no extent, too many
// triangles.
Result<CleanMesh> clean_mesh(TriangleMesh mesh, const std::string& source,
                             std::size_t triangle_limit = mesh_triangle_limit);

}  // namespace spoonbill
