#include "engine/collision/rigid/posed_mesh.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

PosedMesh::PosedMesh(CleanMesh mesh, const Pose& pose, double thickness_m)
    : mesh_(std::move(mesh)), grown_m_(0.5 * thickness_m), part_of_vertex_(mesh_.mesh.vertices_m.size()) {
  SPOONBILL_ASSERT(!mesh_.parts.empty() && thickness_m > 0.0);
  const Eigen::Matrix3d turn = pose.orientation.normalized().toRotationMatrix();
  for (Vector3& vertex : mesh_.mesh.vertices_m) vertex = turn * vertex + pose.position_m;
  boxes_.reserve(mesh_.parts.size());
  for (std::uint32_t p = 0; p < mesh_.parts.size(); ++p) {
    const MeshPart& part = mesh_.parts[p];
    Box box{vertex(part.first_vertex), vertex(part.first_vertex)};
    for (std::uint32_t v = part.first_vertex; v < part.end_vertex; ++v) {
      part_of_vertex_[v] = p;
      box = joined(box, {vertex(v), vertex(v)});
    }
    boxes_.push_back({box.low.array() - grown_m(p), box.high.array() + grown_m(p)});
    has_plates_ = has_plates_ || !part.closed;
  }
}

void PosedMesh::make_rigid(const RigidScale& scale) {
  const std::span<const Vector3> vertices(mesh_.mesh.vertices_m);
  const std::span<const TriangleCorners> triangles(mesh_.mesh.triangles);
  rigid_.reserve(mesh_.parts.size());
  for (const MeshPart& part : mesh_.parts) {
    rigid_.emplace_back(vertices.subspan(part.first_vertex, part.end_vertex - part.first_vertex),
                        triangles.subspan(part.first_triangle, part.end_triangle - part.first_triangle),
                        part.first_vertex, scale);
  }
}

double PosedMesh::length_along(std::size_t part, const Vector3& direction) const {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::uint32_t v = mesh_.parts[part].first_vertex; v < mesh_.parts[part].end_vertex; ++v) {
    low = std::min(low, direction.dot(vertex(v)));
    high = std::max(high, direction.dot(vertex(v)));
  }
  return high - low + 2.0 * grown_m(part);
}

}  // namespace spoonbill
