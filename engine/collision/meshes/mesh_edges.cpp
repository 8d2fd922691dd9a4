#include "engine/collision/meshes/mesh_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {

namespace {

struct SideAtVertex {
  std::uint32_t other;  // the side's other vertex, which has the higher index
  MeshSide side;
  friend bool operator<(const SideAtVertex& a, const SideAtVertex& b) {
    return a.other != b.other ? a.other < b.other : a.side < b.side;
  }
};

// Groups the sides of all triangles by their vertex with the lower index. `first` receives the start of each
// vertex's group.
std::vector<SideAtVertex> sides_by_vertex(const std::vector<TriangleCorners>& triangles,
                                          std::vector<std::uint32_t>& first) {
  const auto count = static_cast<MeshSide>(3 * triangles.size());
  const auto lower = [&](MeshSide side) {
    return std::min(side_start(triangles, side), side_end(triangles, side));
  };
  for (MeshSide side = 0; side < count; ++side) ++first[lower(side) + 1];
  for (std::size_t vertex = 1; vertex < first.size(); ++vertex) first[vertex] += first[vertex - 1];
  std::vector<SideAtVertex> sides(count);
  std::vector<std::uint32_t> next_position(first.begin(), first.end() - 1);
  for (MeshSide side = 0; side < count; ++side) {
    const std::uint32_t higher = std::max(side_start(triangles, side), side_end(triangles, side));
    sides[next_position[lower(side)]++] = {higher, side};
  }
  return sides;
}

}  // namespace

MeshEdges::MeshEdges(const std::vector<TriangleCorners>& triangles, std::size_t vertices) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(triangles.begin(), triangles.end(), [&](const TriangleCorners& t) {
    return t[0] < vertices && t[1] < vertices && t[2] < vertices && t[0] != t[1] && t[1] != t[2] &&
           t[2] != t[0];
  }));
  std::vector<std::uint32_t> first(vertices + 1, 0);
  std::vector<SideAtVertex> sides = sides_by_vertex(triangles, first);
  across_.assign(sides.size(), open);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto begin = sides.begin() + first[vertex], end = sides.begin() + first[vertex + 1];
    std::sort(begin, end);
    for (auto edge = begin; edge != end;) {
      const auto next =
          std::find_if(edge, end, [&](const SideAtVertex& at) { return at.other != edge->other; });
      if (next - edge == 1) {
        ++open_count_;
        boundary_.push_back(edge->side);
      } else if (next - edge == 2) {
        across_[edge[0].side] = edge[1].side;
        across_[edge[1].side] = edge[0].side;
      } else {
        ++branching_count_;
        std::ptrdiff_t upward = 0;
        for (auto at = edge; at != next; ++at) {
          across_[at->side] = branching;
          upward += side_start(triangles, at->side) == vertex ? 1 : -1;
        }
        std::ptrdiff_t surplus = std::abs(upward);
        for (auto at = edge; at != next && surplus > 0; ++at) {
          if ((side_start(triangles, at->side) == vertex) != (upward > 0)) continue;
          boundary_.push_back(at->side);
          --surplus;
        }
      }
      edge = next;
    }
  }
}

namespace {

constexpr std::uint32_t uncut = 0xffffffffU;

// Adds a midpoint vertex to each edge longer than `longest`. Returns the vertex index of each side's
// midpoint, or `uncut` for a side without a midpoint.
std::vector<std::uint32_t> cut_edges(TriangleMesh& mesh, double longest) {
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  std::vector<std::uint32_t> midpoint(3 * mesh.triangles.size(), uncut);
  for (MeshSide side = 0; side < midpoint.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other < side) {
      midpoint[side] = midpoint[other];
      continue;
    }
    const Vector3 &start = mesh.vertices_m[side_start(mesh.triangles, side)],
                  &end = mesh.vertices_m[side_end(mesh.triangles, side)];
    if ((end - start).squaredNorm() <= longest * longest) continue;
    midpoint[side] = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.push_back(0.5 * (start + end));
  }
  return midpoint;
}

// Appends the triangles into which the midpoints divide a triangle. First rotates `corner` so that a single
// cut side comes first, or a single uncut side last.
void add_pieces(const TriangleMesh& mesh, TriangleCorners corner, std::array<std::uint32_t, 3> midpoint,
                std::vector<TriangleCorners>& out) {
  int cuts = 0;
  for (const std::uint32_t each : midpoint) cuts += each != uncut ? 1 : 0;
  if (cuts == 0) return out.push_back(corner);
  while (cuts < 3 && (midpoint[0] == uncut || midpoint[2] != uncut)) {
    corner = {corner[1], corner[2], corner[0]};
    midpoint = {midpoint[1], midpoint[2], midpoint[0]};
  }
  const auto [a, b, c] = corner;
  const auto [ab, bc, ca] = midpoint;
  if (cuts == 1) {
    out.insert(out.end(), {{a, ab, c}, {ab, b, c}});
  } else if (cuts == 3) {
    out.insert(out.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  } else {
    const std::vector<Vector3>& at = mesh.vertices_m;
    const bool from_a = (at[bc] - at[a]).squaredNorm() <= (at[c] - at[ab]).squaredNorm();
    out.push_back({ab, b, bc});
    if (from_a) {
      out.insert(out.end(), {{a, ab, bc}, {a, bc, c}});
    } else {
      out.insert(out.end(), {{a, ab, c}, {ab, bc, c}});
    }
  }
}

}  // namespace

Result<TriangleMesh> refine_edges(TriangleMesh mesh, double longest_m, std::size_t triangle_limit) {
  SPOONBILL_ASSERT(longest_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(!mesh.triangles.empty() &&
                         MeshEdges(mesh.triangles, mesh.vertices_m.size()).open_count() == 0);
  for (;;) {
    const std::size_t vertices = mesh.vertices_m.size();
    const std::vector<std::uint32_t> midpoint = cut_edges(mesh, longest_m);
    if (mesh.vertices_m.size() == vertices) return mesh;
    std::vector<TriangleCorners> finer;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      add_pieces(mesh, mesh.triangles[t], {midpoint[3 * t], midpoint[3 * t + 1], midpoint[3 * t + 2]}, finer);
    }
    mesh.triangles = std::move(finer);
    if (mesh.triangles.size() > triangle_limit) {
      return Error(ErrorCode::too_many, "has more than " + std::to_string(triangle_limit) +
                                            " triangles after splitting edges longer than " +
                                            number_text(longest_m * 1e3) + " mm");
    }
  }
}

namespace {

// Smallest cosine of the angle between the normals of two triangles that are smoothed together. The largest
// angle is 30 degrees.
constexpr double least_cosine = 0.866;

}  // namespace

SmoothNormals::SmoothNormals(const TriangleMesh& mesh)
    : mesh_(&mesh), starts_(mesh.vertices_m.size() + 1, 0), adjacent_(3 * mesh.triangles.size()) {
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) ++starts_[corner + 1];
  }
  for (std::size_t vertex = 1; vertex < starts_.size(); ++vertex) starts_[vertex] += starts_[vertex - 1];
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    for (const std::uint32_t corner : mesh.triangles[triangle]) adjacent_[next[corner]++] = triangle;
  }
}

Vector3 SmoothNormals::twice_area(std::uint32_t triangle) const {
  const auto& [a, b, c] = mesh_->triangles[triangle];
  const std::vector<Vector3>& points = mesh_->vertices_m;
  return (points[b] - points[a]).cross(points[c] - points[a]);
}

Vector3 SmoothNormals::at(std::uint32_t triangle, double to_b, double to_c) const {
  SPOONBILL_ASSERT_DEBUG(triangle < mesh_->triangles.size());
  const Vector3 own = twice_area(triangle).stableNormalized();
  const std::array<double, 3> weights = {1.0 - to_b - to_c, to_b, to_c};
  Vector3 normal = Vector3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = mesh_->triangles[triangle][k];
    Vector3 sum = Vector3::Zero();
    for (std::uint32_t n = starts_[corner]; n < starts_[corner + 1]; ++n) {
      const Vector3 other = twice_area(adjacent_[n]);
      if (other.dot(own) >= least_cosine * other.norm()) sum += other;
    }
    normal += weights[k] * sum.stableNormalized();
  }
  return normal.stableNormalized();
}

}  // namespace spoonbill
