#include "engine/collision/meshes/triangle_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/hole_filling.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/meshes/vertex_join.h"

namespace spoonbill {
namespace {

Status check_numbers(const TriangleMesh& mesh, const std::string& source, std::size_t triangle_limit) {
  if (mesh.triangles.empty()) {
    return Error{source + ": has no triangles; a tool is made of a surface mesh, export one"};
  }
  if (mesh.triangles.size() > triangle_limit) {
    return Error{source + ": has " + std::to_string(mesh.triangles.size()) + " triangles, more than the " +
                 std::to_string(triangle_limit) + " that are read; reduce it"};
  }
  for (const Vector3& vertex : mesh.vertices_m) {
    if (!vertex.allFinite()) return Error{source + ": a coordinate is no finite number; export it anew"};
    if ((vertex.array() < position_range_m.low).any() || (vertex.array() > position_range_m.high).any()) {
      return Error{source + ": a coordinate is beyond 100 m; is the unit right? --unit names another"};
    }
  }
  for (const TriangleCorners& corners : mesh.triangles) {
    if (*std::max_element(corners.begin(), corners.end()) >= mesh.vertices_m.size()) {
      return Error{source + ": a triangle names a vertex that is not there; export it anew"};
    }
  }
  return {};
}

// Of the vertices that triangles have; a file may hold others.
Box used_box(const TriangleMesh& mesh) {
  Box box;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) box.include(mesh.vertices_m[corner]);
  }
  return box;
}

bool is_degenerate(const TriangleMesh& mesh, const TriangleCorners& corners, double least_height) {
  const auto& [a, b, c] = corners;
  if (a == b || b == c || c == a) return true;
  const Vector3 ab = mesh.vertices_m[b] - mesh.vertices_m[a], ac = mesh.vertices_m[c] - mesh.vertices_m[a];
  const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
  return ab.cross(ac).norm() <= least_height * longest;
}

// Keeps the first of those with the same corners.
std::size_t drop_duplicates(std::vector<TriangleCorners>& triangles) {
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> table(std::bit_ceil(2 * triangles.size() + 2), none);
  const std::uint64_t mask = table.size() - 1;
  const auto sorted = [](TriangleCorners corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  std::size_t kept = 0;
  for (const TriangleCorners& corners : triangles) {
    const TriangleCorners key = sorted(corners);
    std::uint64_t spread = 0;
    for (const std::uint32_t corner : key) {
      spread = (spread ^ corner) * 0x9e3779b97f4a7c15ULL;
      spread ^= spread >> 29;
    }
    std::uint64_t slot = spread & mask;
    while (table[slot] != none && sorted(triangles[table[slot]]) != key) slot = (slot + 1) & mask;
    if (table[slot] != none) continue;
    table[slot] = static_cast<std::uint32_t>(kept);
    triangles[kept++] = corners;
  }
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

void join_and_drop(TriangleMesh& mesh, double size, MeshReport& report) {
  const JoinedVertices joined = join_vertices(mesh.vertices_m, vertex_joining_share * size);
  report.vertices_joined = mesh.vertices_m.size() - joined.vertices_m.size();
  mesh.vertices_m = joined.vertices_m;
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = joined.joined_into[corner];
  }
  report.degenerate_dropped = std::erase_if(mesh.triangles, [&](const TriangleCorners& corners) {
    return is_degenerate(mesh, corners, degenerate_share * size);
  });
  report.duplicates_dropped = drop_duplicates(mesh.triangles);
}

// Turned triangles have their corners in another order than their vertices came in. What is clean is cleaned
// into itself, so that a document that holds it is written as it was read.
void number_by_first_use(TriangleMesh& mesh) {
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> number(mesh.vertices_m.size(), none);
  std::vector<Vector3> vertices_m;
  vertices_m.reserve(mesh.vertices_m.size());
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) {
      std::uint32_t& mine = number[corner];
      if (mine == none) {
        mine = static_cast<std::uint32_t>(vertices_m.size());
        vertices_m.push_back(mesh.vertices_m[corner]);
      }
      corner = mine;
    }
  }
  mesh.vertices_m = std::move(vertices_m);
}

}  // namespace

Result<CleanMesh> clean_mesh(TriangleMesh mesh, const std::string& source, std::size_t triangle_limit) {
  if (Status status = check_numbers(mesh, source, triangle_limit); !status) return status.error();
  CleanMesh clean;
  MeshReport& report = clean.report;
  report.vertices_read = mesh.vertices_m.size();
  report.triangles_read = mesh.triangles.size();
  const Box box = used_box(mesh);
  report.size_m = box.high - box.low;
  if (!(box.size() > 0.0)) return Error{source + ": all its triangles are in one point; export it anew"};

  join_and_drop(mesh, box.size(), report);
  if (mesh.triangles.empty()) {
    return Error{source + ": none of its triangles has an area; export it anew"};
  }
  {
    const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
    report.open_edges = edges.open_count();
    report.branching_edges = edges.branching_count();
  }
  MeshParts parts = split_into_parts(mesh);
  mesh = {};
  report.triangles_turned = parts.triangles_turned;
  report.holes_filled = fill_small_holes(parts);
  report.specks_dropped = drop_specks(parts);
  turn_outward(parts.mesh, parts.parts, report);
  number_by_first_use(parts.mesh);
  clean.mesh = std::move(parts.mesh);
  clean.parts = std::move(parts.parts);
  return clean;
}

}  // namespace spoonbill
