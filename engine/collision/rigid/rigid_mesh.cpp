#include "engine/collision/rigid/rigid_mesh.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

// FCL's triangle distance takes no normal whose square is below 1e-15; twice the area of the smallest
// triangle is scaled to this.
constexpr double smallest_doubled_area = 1e-6;

void take_smallest(const TriangleMesh& mesh, double& doubled_area) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3& corner = mesh.vertices_m[a];
    const double doubled = (mesh.vertices_m[b] - corner).cross(mesh.vertices_m[c] - corner).norm();
    if (doubled > 0.0) doubled_area = std::min(doubled_area, doubled);
  }
}

}  // namespace

RigidScale scale_for(const TriangleMesh& first, const TriangleMesh& second) {
  double doubled_area = std::numeric_limits<double>::infinity();
  take_smallest(first, doubled_area);
  take_smallest(second, doubled_area);
  RigidScale scale;
  if (!first.vertices_m.empty()) scale.origin_m = first.vertices_m.front();
  if (std::isfinite(doubled_area))
    scale.per_m = std::max(1.0, std::sqrt(smallest_doubled_area / doubled_area));
  return scale;
}

struct RigidMesh::Tree {
  Model model;
  RigidScale scale;
};

RigidMesh::RigidMesh(std::span<const Vector3> vertices_m, std::span<const TriangleCorners> triangles,
                     std::uint32_t first_vertex, const RigidScale& scale)
    : tree_(std::make_unique<Tree>()) {
  SPOONBILL_ASSERT(!triangles.empty());
  tree_->scale = scale;
  std::vector<fcl::Vector3<double>> points;
  points.reserve(vertices_m.size());
  for (const Vector3& vertex : vertices_m) points.emplace_back(scale.per_m * (vertex - scale.origin_m));
  std::vector<fcl::Triangle> corners;
  corners.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    corners.emplace_back(a - first_vertex, b - first_vertex, c - first_vertex);
  }
  Model& model = tree_->model;
  model.beginModel(static_cast<int>(corners.size()), static_cast<int>(points.size()));
  model.addSubModel(points, corners);
  const int status = model.endModel();
  SPOONBILL_ASSERT(status == fcl::BVH_OK);
}

RigidMesh::~RigidMesh() = default;
RigidMesh::RigidMesh(RigidMesh&&) noexcept = default;
RigidMesh& RigidMesh::operator=(RigidMesh&&) noexcept = default;

std::optional<RigidMesh::Nearest> RigidMesh::nearest(const RigidMesh& other, double below_m) const {
  const RigidScale& scale = tree_->scale;
  SPOONBILL_ASSERT(scale.per_m == other.tree_->scale.per_m);
  const fcl::Transform3d here = fcl::Transform3d::Identity();
  const fcl::DistanceRequest<double> request(true);
  fcl::DistanceResult<double> result(std::min(below_m * scale.per_m, std::numeric_limits<double>::max()));
  fcl::distance(&tree_->model, here, &other.tree_->model, here, request, result);
  if (result.o1 == nullptr) return std::nullopt;
  return Nearest{std::max(result.min_distance, 0.0) / scale.per_m,
                 scale.origin_m + result.nearest_points[0] / scale.per_m,
                 scale.origin_m + result.nearest_points[1] / scale.per_m};
}

std::vector<RigidMesh::Crossing> RigidMesh::find_crossings(const RigidMesh& other, std::size_t most) const {
  SPOONBILL_ASSERT(tree_->scale.per_m == other.tree_->scale.per_m);
  const fcl::Transform3d here = fcl::Transform3d::Identity();
  const fcl::CollisionRequest<double> request(most, false);
  fcl::CollisionResult<double> result;
  fcl::collide(&tree_->model, here, &other.tree_->model, here, request, result);
  std::vector<Crossing> crossings;
  crossings.reserve(result.numContacts());
  for (std::size_t k = 0; k < result.numContacts(); ++k) {
    const fcl::Contact<double>& contact = result.getContact(k);
    crossings.emplace_back(static_cast<std::uint32_t>(contact.b1), static_cast<std::uint32_t>(contact.b2));
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace spoonbill
