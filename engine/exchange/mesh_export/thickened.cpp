#include "engine/exchange/mesh_export/thickened.h"

#include <set>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Of the area: what may turn over, for slivers do by rounding.
constexpr double turned_share = 1e-3;

Vector3 twice_area(const std::vector<Vector3>& points_m, const TriangleCorners& corners) {
  return (points_m[corners[1]] - points_m[corners[0]]).cross(points_m[corners[2]] - points_m[corners[0]]);
}

// Weighted by area: the slivers along a trim have no normal worth the name.
std::vector<Vector3> normals_of(const TriangleMesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices_m.size(), Vector3::Zero());
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 area = twice_area(mesh.vertices_m, corners);
    for (const std::uint32_t corner : corners) normals[corner] += area;
  }
  for (Vector3& normal : normals) normal.stableNormalize();
  return normals;
}

// Those that a triangle runs along one way and no other back.
std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_of(const TriangleMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> open;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      if (open.erase({to, from}) == 0) open.insert({from, to});
    }
  }
  return {open.begin(), open.end()};
}

}  // namespace

Result<TriangleMesh> thickened(const TriangleMesh& outer, double thickness_m) {
  SPOONBILL_ASSERT(thickness_m > 0.0);
  const auto count = static_cast<std::uint32_t>(outer.vertices_m.size());
  TriangleMesh shell = outer;
  const std::vector<Vector3> normals = normals_of(outer);
  for (std::uint32_t v = 0; v < count; ++v) {
    shell.vertices_m.emplace_back(outer.vertices_m[v] - thickness_m * normals[v]);
  }
  double area = 0.0, turned = 0.0;
  Vector3 turned_m = Vector3::Zero();
  for (const TriangleCorners& corners : outer.triangles) {
    const TriangleCorners behind = {corners[0] + count, corners[2] + count, corners[1] + count};
    const Vector3 normal = twice_area(shell.vertices_m, corners);
    area += normal.norm();
    if (!(twice_area(shell.vertices_m, behind).dot(normal) < 0.0)) {
      if (turned == 0.0) turned_m = outer.vertices_m[corners[0]];
      turned += normal.norm();
    }
    shell.triangles.push_back(behind);
  }
  if (turned > turned_share * area) {
    return Error{"a shell of " + number_text(1e3 * thickness_m) + " mm is thicker than it is curved at " +
                 position_text(turned_m)};
  }
  for (const auto& [from, to] : edges_of(outer)) {
    shell.triangles.push_back({to, from, from + count});
    shell.triangles.push_back({to, from + count, to + count});
  }
  return shell;
}

}  // namespace spoonbill
