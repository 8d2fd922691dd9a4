// Triangle meshes as read from files, and their cleaning with a report.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

using TriangleCorners = std::array<std::uint32_t, 3>;

// An indexed triangle mesh.
struct TriangleMesh {
  std::vector<Vector3> vertices_m;
  std::vector<TriangleCorners> triangles;  // indices into vertices_m; counter-clockwise seen from outside
};

// A set of triangles that are connected over edges shared by exactly two triangles. Parts have no vertices in
// common. An open part is a sheet and has no inside.
struct MeshPart {
  std::uint32_t first_vertex = 0, end_vertex = 0;
  std::uint32_t first_triangle = 0, end_triangle = 0;
  bool closed = false;
  int cavity_of = -1;  // index of the closed part that contains this cavity; -1 if the part is not a cavity
};

// Numbers of faults that cleaning found and of changes that it made.
struct MeshReport {
  std::size_t vertices_read = 0, triangles_read = 0;
  std::size_t vertices_joined = 0;
  std::size_t degenerate_dropped = 0;  // triangles with equal or nearly collinear corners
  std::size_t duplicates_dropped = 0;  // triangles with the same three corners as another, in any order
  std::size_t triangles_flipped = 0;   // triangles flipped to agree with most triangles of their part
  std::size_t parts_flipped = 0;       // closed parts that were inside out
  std::size_t open_edges = 0;          // edges of a single triangle, counted before holes are filled
  std::size_t branching_edges = 0;     // edges of more than two triangles
  std::size_t holes_filled = 0;
  std::size_t specks_dropped = 0;  // small open parts that were removed because there are closed parts
  std::size_t closed_parts = 0, cavities = 0, sheets = 0;
  Vector3 size_m = Vector3::Zero();
};

// Result of clean_mesh().
struct CleanMesh {
  TriangleMesh mesh;
  std::vector<MeshPart> parts;  // in the order of their triangles
  MeshReport report;
};

// Largest number of triangles accepted, which bounds time and memory.
inline constexpr std::size_t mesh_triangle_limit = 6'000'000;
// Vertices nearer to each other than this fraction of the mesh's size are joined. The fraction is above the
// single-precision rounding of most files and below any feature that a person can model.
inline constexpr double vertex_joining_fraction = 1e-6;
// Triangles with a height below this fraction of the mesh's size are dropped, because they have no reliable
// normal.
inline constexpr double degenerate_height_fraction = 1e-9;
// The holes of a part are filled if that increases its area by at most this fraction. A part with larger
// holes remains a sheet.
inline constexpr double hole_area_fraction = 0.05;
// Open parts whose area is below this fraction of the closed parts' area are dropped as scanner noise or fins
// on an edge.
inline constexpr double speck_area_fraction = 1e-3;

// Joins vertices, drops degenerate and duplicate triangles, orients each part consistently, fills small
// holes, drops specks and orients closed parts outward. A closed part that is inside another one and has the
// opposite orientation is a cavity and stays oriented inward.
//
// Error messages begin with `source`. Fails if there are no triangles or more than the limit, if an index is
// beyond the vertices, if a coordinate is not finite or outside position_range_m, or if the mesh has no
// extent or no area.
Result<CleanMesh> clean_mesh(TriangleMesh mesh, const std::string& source,
                             std::size_t triangle_limit = mesh_triangle_limit);

// Result of join_vertices().
struct JoinedVertices {
  std::vector<Vector3> vertices_m;         // kept vertices, in the order of their first occurrence
  std::vector<std::uint32_t> joined_into;  // for each input vertex, its index in vertices_m
};

// Joins each vertex to an earlier kept vertex within the tolerance, or keeps it. Coordinates must be finite
// and the tolerance positive. The time is linear in the number of vertices, whatever their positions.
JoinedVertices join_vertices(const std::vector<Vector3>& vertices_m, double tolerance_m);

}  // namespace spoonbill
