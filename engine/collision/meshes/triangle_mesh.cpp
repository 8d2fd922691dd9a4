#include "engine/collision/meshes/triangle_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_parts.h"

namespace spoonbill {

namespace {

constexpr std::uint32_t no_vertex = 0xffffffffU;
// Width of a grid cell, as a multiple of the tolerance. At this width, few vertices are within the tolerance
// of a neighbouring cell. A cell also has few kept vertices, because these are farther apart than the
// tolerance.
constexpr double cell_tolerances = 4.0;

// Mixes the bits of a hash by the finaliser of MurmurHash3 (Appleby 2011), because regularly spaced positions
// would otherwise collide.
std::uint64_t mix_bits(std::uint64_t bits) {
  bits ^= bits >> 33;
  bits *= 0xff51afd7ed558ccdULL;
  bits ^= bits >> 33;
  bits *= 0xc4ceb9fe1a85ec53ULL;
  return bits ^ (bits >> 33);
}

std::uint64_t mix_bits(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return mix_bits(x + mix_bits(y + mix_bits(z)));
}

std::size_t table_size(std::size_t entries) {
  return std::bit_ceil(2 * entries + 2);
}

JoinedVertices join_equal(const std::vector<Vector3>& vertices) {
  JoinedVertices result;
  result.joined_into.reserve(vertices.size());
  std::vector<std::uint32_t> table(table_size(vertices.size()), no_vertex);
  const std::uint64_t mask = table.size() - 1;
  for (const Vector3& input : vertices) {
    const Vector3 vertex = input.array() + 0.0;  // turns -0.0 into 0.0
    const auto bits = [&](int axis) { return std::bit_cast<std::uint64_t>(vertex[axis]); };
    std::uint64_t slot = mix_bits(bits(0), bits(1), bits(2)) & mask;
    while (table[slot] != no_vertex && result.vertices_m[table[slot]] != vertex) slot = (slot + 1) & mask;
    if (table[slot] == no_vertex) {
      table[slot] = static_cast<std::uint32_t>(result.vertices_m.size());
      result.vertices_m.push_back(vertex);
    }
    result.joined_into.push_back(table[slot]);
  }
  return result;
}

// Hash grid of the vertices that were not joined to others. Each slot has one chain of vertices; cells with
// the same slot share its chain.
class VertexGrid {
 public:
  VertexGrid(std::size_t count, double tolerance)
      : tolerance_(tolerance), first_(table_size(count), no_vertex), mask_(first_.size() - 1) {
    next_.reserve(count);
  }

  std::uint32_t find(const Vector3& vertex, const std::vector<Vector3>& kept) const {
    const auto low = cell(vertex.array() - tolerance_), high = cell(vertex.array() + tolerance_);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          for (std::uint32_t at = first_[slot({x, y, z})]; at != no_vertex; at = next_[at]) {
            if ((kept[at] - vertex).squaredNorm() <= tolerance_ * tolerance_) return at;
          }
        }
      }
    }
    return no_vertex;
  }

  // Adds a vertex. Its index is the number of vertices added before it.
  void add(const Vector3& vertex) {
    std::uint32_t& first = first_[slot(cell(vertex))];
    next_.push_back(first);
    first = static_cast<std::uint32_t>(next_.size() - 1);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell(const Vector3& point) const {
    const Vector3 cells = point / (cell_tolerances * tolerance_);
    return {static_cast<std::int64_t>(std::floor(cells.x())),
            static_cast<std::int64_t>(std::floor(cells.y())),
            static_cast<std::int64_t>(std::floor(cells.z()))};
  }
  std::size_t slot(const Cell& cell) const {
    return mix_bits(static_cast<std::uint64_t>(cell[0]), static_cast<std::uint64_t>(cell[1]),
                    static_cast<std::uint64_t>(cell[2])) &
           mask_;
  }

  double tolerance_;
  std::vector<std::uint32_t> first_, next_;
  std::uint64_t mask_;
};

}  // namespace

JoinedVertices join_vertices(const std::vector<Vector3>& vertices_m, double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(vertices_m.begin(), vertices_m.end(), [](const Vector3& at) { return at.allFinite(); }));
  JoinedVertices result = join_equal(vertices_m);
  const std::vector<Vector3> distinct = std::move(result.vertices_m);
  result.vertices_m.clear();
  VertexGrid near(distinct.size(), tolerance_m);
  std::vector<std::uint32_t> joined;
  joined.reserve(distinct.size());
  for (const Vector3& vertex : distinct) {
    std::uint32_t into = near.find(vertex, result.vertices_m);
    if (into == no_vertex) {
      into = static_cast<std::uint32_t>(result.vertices_m.size());
      near.add(vertex);
      result.vertices_m.push_back(vertex);
    }
    joined.push_back(into);
  }
  for (std::uint32_t& into : result.joined_into) into = joined[into];
  return result;
}

namespace {

Status check_input(const TriangleMesh& mesh, const std::string& source, std::size_t triangle_limit) {
  if (mesh.triangles.empty()) {
    return Error(ErrorCode::too_few, source + ": has no triangles; export a surface mesh");
  }
  if (mesh.triangles.size() > triangle_limit) {
    return Error(ErrorCode::too_many, source + ": has " + std::to_string(mesh.triangles.size()) +
                                          " triangles, at most " + std::to_string(triangle_limit) +
                                          " are supported; simplify the mesh");
  }
  for (const Vector3& vertex : mesh.vertices_m) {
    if (!vertex.allFinite()) {
      return Error(ErrorCode::out_of_range,
                   source + ": a coordinate is not a finite number; export the mesh again");
    }
    if ((vertex.array() < position_range_m.low).any() || (vertex.array() > position_range_m.high).any()) {
      return Error(ErrorCode::out_of_range,
                   source + ": a coordinate is beyond 100 m; check the unit (--unit)");
    }
  }
  for (const TriangleCorners& corners : mesh.triangles) {
    if (*std::max_element(corners.begin(), corners.end()) >= mesh.vertices_m.size()) {
      return Error(ErrorCode::malformed,
                   source + ": a triangle refers to a vertex that does not exist; export the mesh again");
    }
  }
  return {};
}

// Returns the box of the vertices that belong to a triangle. A file may contain vertices that no triangle
// uses.
Box box_of_used_vertices(const TriangleMesh& mesh) {
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

// Removes each triangle that has the same three corners as an earlier triangle, in any order. Returns the
// number of removed triangles.
std::size_t drop_duplicates(std::vector<TriangleCorners>& triangles) {
  std::vector<std::uint32_t> table(std::bit_ceil(2 * triangles.size() + 2), no_vertex);
  const std::uint64_t mask = table.size() - 1;
  const auto sorted = [](TriangleCorners corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  std::size_t kept = 0;
  for (const TriangleCorners& corners : triangles) {
    const TriangleCorners key = sorted(corners);
    std::uint64_t hash = 0;
    for (const std::uint32_t corner : key) {
      hash = (hash ^ corner) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    std::uint64_t slot = hash & mask;
    while (table[slot] != no_vertex && sorted(triangles[table[slot]]) != key) slot = (slot + 1) & mask;
    if (table[slot] != no_vertex) continue;
    table[slot] = static_cast<std::uint32_t>(kept);
    triangles[kept++] = corners;
  }
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

void join_and_drop(TriangleMesh& mesh, double size, MeshReport& report) {
  const JoinedVertices joined = join_vertices(mesh.vertices_m, vertex_joining_fraction * size);
  report.vertices_joined = mesh.vertices_m.size() - joined.vertices_m.size();
  mesh.vertices_m = joined.vertices_m;
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = joined.joined_into[corner];
  }
  report.degenerate_dropped = std::erase_if(mesh.triangles, [&](const TriangleCorners& corners) {
    return is_degenerate(mesh, corners, degenerate_height_fraction * size);
  });
  report.duplicates_dropped = drop_duplicates(mesh.triangles);
}

// Renumbers vertices in the order in which the triangles use them, because flipping triangles has changed
// that order. As a result, cleaning leaves a clean mesh unchanged, and a document is written as it was read.
void number_by_first_use(TriangleMesh& mesh) {
  std::vector<std::uint32_t> new_index(mesh.vertices_m.size(), no_vertex);
  std::vector<Vector3> vertices_m;
  vertices_m.reserve(mesh.vertices_m.size());
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) {
      std::uint32_t& index = new_index[corner];
      if (index == no_vertex) {
        index = static_cast<std::uint32_t>(vertices_m.size());
        vertices_m.push_back(mesh.vertices_m[corner]);
      }
      corner = index;
    }
  }
  mesh.vertices_m = std::move(vertices_m);
}

}  // namespace

Result<CleanMesh> clean_mesh(TriangleMesh mesh, const std::string& source, std::size_t triangle_limit) {
  if (Status status = check_input(mesh, source, triangle_limit); !status) return status.error();
  CleanMesh clean;
  MeshReport& report = clean.report;
  report.vertices_read = mesh.vertices_m.size();
  report.triangles_read = mesh.triangles.size();
  const Box box = box_of_used_vertices(mesh);
  report.size_m = box.high - box.low;
  if (!(box.size() > 0.0)) {
    return Error(ErrorCode::degenerate, source + ": all triangles are at one point; export the mesh again");
  }

  join_and_drop(mesh, box.size(), report);
  if (mesh.triangles.empty()) {
    return Error(ErrorCode::degenerate, source + ": no triangle has an area; export the mesh again");
  }
  {
    const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
    report.open_edges = edges.open_count();
    report.branching_edges = edges.branching_count();
  }
  MeshParts parts = split_into_parts(mesh);
  mesh = {};
  report.triangles_flipped = parts.triangles_flipped;
  report.holes_filled = fill_small_holes(parts);
  report.specks_dropped = drop_specks(parts);
  orient_outward(parts.mesh, parts.parts, report);
  number_by_first_use(parts.mesh);
  clean.mesh = std::move(parts.mesh);
  clean.parts = std::move(parts.parts);
  return clean;
}

}  // namespace spoonbill
