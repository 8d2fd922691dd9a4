#include "engine/collision/rigid/rigid_mesh.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {

namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

// Coordinates are scaled so that twice the area of the smallest triangle is at least this value. FCL's
// triangle distance ignores normals whose squared length is below 1e-15.
constexpr double smallest_doubled_area = 1e-6;

void update_smallest_area(const TriangleMesh& mesh, double& doubled_area) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3& corner = mesh.vertices_m[a];
    const double doubled = (mesh.vertices_m[b] - corner).cross(mesh.vertices_m[c] - corner).norm();
    if (doubled > 0.0) doubled_area = std::min(doubled_area, doubled);
  }
}

}  // namespace

RigidScale scale_for(const TriangleMesh& first, const TriangleMesh& second) {
  double doubled_area = std::numeric_limits<double>::infinity();
  update_smallest_area(first, doubled_area);
  update_smallest_area(second, doubled_area);
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

std::vector<RigidMesh::Crossing> RigidMesh::find_crossings(const RigidMesh& other, std::size_t limit) const {
  SPOONBILL_ASSERT(tree_->scale.per_m == other.tree_->scale.per_m);
  const fcl::Transform3d here = fcl::Transform3d::Identity();
  const fcl::CollisionRequest<double> request(limit, false);
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

PosedMesh::PosedMesh(CleanMesh mesh, const Pose& pose, double thickness_m)
    : mesh_(std::move(mesh)),
      half_thickness_m_(0.5 * thickness_m),
      part_of_vertex_(mesh_.mesh.vertices_m.size()) {
  SPOONBILL_ASSERT(!mesh_.parts.empty() && thickness_m > 0.0);
  const Eigen::Matrix3d rotation = pose.orientation.normalized().toRotationMatrix();
  for (Vector3& vertex : mesh_.mesh.vertices_m) vertex = rotation * vertex + pose.position_m;
  boxes_.reserve(mesh_.parts.size());
  for (std::uint32_t p = 0; p < mesh_.parts.size(); ++p) {
    const MeshPart& part = mesh_.parts[p];
    Box box{vertex(part.first_vertex), vertex(part.first_vertex)};
    for (std::uint32_t v = part.first_vertex; v < part.end_vertex; ++v) {
      part_of_vertex_[v] = p;
      box = joined(box, {vertex(v), vertex(v)});
    }
    boxes_.push_back({box.low.array() - half_thickness_m(p), box.high.array() + half_thickness_m(p)});
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
  return high - low + 2.0 * half_thickness_m(part);
}

}  // namespace spoonbill
