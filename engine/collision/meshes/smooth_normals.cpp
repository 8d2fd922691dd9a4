#include "engine/collision/meshes/smooth_normals.h"

#include <array>
#include <cstddef>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Of 30 degrees.
constexpr double least_cosine = 0.866;

}  // namespace

SmoothNormals::SmoothNormals(const TriangleMesh& mesh)
    : mesh_(&mesh), starts_(mesh.vertices_m.size() + 1, 0), around_(3 * mesh.triangles.size()) {
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) ++starts_[corner + 1];
  }
  for (std::size_t vertex = 1; vertex < starts_.size(); ++vertex) starts_[vertex] += starts_[vertex - 1];
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    for (const std::uint32_t corner : mesh.triangles[triangle]) around_[next[corner]++] = triangle;
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
  const std::array<double, 3> shares = {1.0 - to_b - to_c, to_b, to_c};
  Vector3 normal = Vector3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = mesh_->triangles[triangle][k];
    Vector3 sum = Vector3::Zero();
    for (std::uint32_t n = starts_[corner]; n < starts_[corner + 1]; ++n) {
      const Vector3 other = twice_area(around_[n]);
      if (other.dot(own) >= least_cosine * other.norm()) sum += other;
    }
    normal += shares[k] * sum.stableNormalized();
  }
  return normal.stableNormalized();
}

}  // namespace spoonbill
