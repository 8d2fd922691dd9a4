#include "engine/collision/meshes/mesh_refinement.h"

#include <array>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/collision/meshes/mesh_edges.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t uncut = 0xffffffffU;

// The vertex in the middle of each side whose edge is too long.
std::vector<std::uint32_t> cut_edges(TriangleMesh& mesh, double longest) {
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  std::vector<std::uint32_t> middle(3 * mesh.triangles.size(), uncut);
  for (MeshSide side = 0; side < middle.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other < side) {
      middle[side] = middle[other];
      continue;
    }
    const Vector3 &start = mesh.vertices_m[start_of(mesh.triangles, side)],
                  &end = mesh.vertices_m[end_of(mesh.triangles, side)];
    if ((end - start).squaredNorm() <= longest * longest) continue;
    middle[side] = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.push_back(0.5 * (start + end));
  }
  return middle;
}

// `corner` is turned so that a lone cut is in the first side, and a lone uncut side is the last.
void add_pieces(const TriangleMesh& mesh, TriangleCorners corner, std::array<std::uint32_t, 3> middle,
                std::vector<TriangleCorners>& out) {
  int cuts = 0;
  for (const std::uint32_t each : middle) cuts += each != uncut ? 1 : 0;
  if (cuts == 0) return out.push_back(corner);
  while (cuts < 3 && (middle[0] == uncut || middle[2] != uncut)) {
    corner = {corner[1], corner[2], corner[0]};
    middle = {middle[1], middle[2], middle[0]};
  }
  const auto [a, b, c] = corner;
  const auto [ab, bc, ca] = middle;
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
    const std::vector<std::uint32_t> middle = cut_edges(mesh, longest_m);
    if (mesh.vertices_m.size() == vertices) return mesh;
    std::vector<TriangleCorners> finer;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      add_pieces(mesh, mesh.triangles[t], {middle[3 * t], middle[3 * t + 1], middle[3 * t + 2]}, finer);
    }
    mesh.triangles = std::move(finer);
    if (mesh.triangles.size() > triangle_limit) {
      return Error{"has more than " + std::to_string(triangle_limit) +
                   " triangles where no edge of it is longer than " + number_text(longest_m * 1e3) + " mm"};
    }
  }
}

}  // namespace spoonbill
