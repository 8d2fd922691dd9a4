#include "engine/collision/meshes/shell_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_self_contact.h"
#include "engine/collision/meshes/nearest_on_triangle.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t leaf_size = 4;
// Nearer than this share of the size the way to the surface has no direction worth the name.
constexpr double on_surface_share = 1e-12;
constexpr double convex_share = 1e-7;
// Every face is held against every vertex.
constexpr std::size_t convex_triangles = 20'000;

std::vector<Box> boxes_of(const std::vector<Vector3>& vertices,
                          const std::vector<TriangleCorners>& triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const auto& [i, j, k] : triangles) {
    boxes.push_back(bounding_box(Triangle{vertices[i], vertices[j], vertices[k]}));
  }
  return boxes;
}

std::vector<std::uint32_t> corners_at_vertices(const std::vector<TriangleCorners>& triangles,
                                               std::size_t vertices) {
  std::vector<std::uint32_t> corners(vertices, 0);
  for (const TriangleCorners& triangle : triangles) {
    for (const std::uint32_t corner : triangle) ++corners[corner];
  }
  return corners;
}

// Every edge has two triangles, and those at a vertex make one umbrella.
bool is_manifold(const std::vector<TriangleCorners>& triangles, const MeshEdges& edges,
                 std::size_t vertices) {
  if (edges.open_count() > 0 || edges.branching_count() > 0) return false;
  const std::vector<std::uint32_t> corners = corners_at_vertices(triangles, vertices);
  std::vector<bool> walked(vertices, false);
  for (MeshSide side = 0; side < 3 * triangles.size(); ++side) {
    const std::uint32_t vertex = start_of(triangles, side);
    if (walked[vertex]) continue;
    walked[vertex] = true;
    MeshSide at = side;
    std::uint32_t count = 0;
    do {
      at = edges.across(next_side(next_side(at)));
      ++count;
    } while (at != side && count <= corners[vertex]);
    if (count != corners[vertex]) return false;
  }
  return true;
}

}  // namespace

struct ShellDistance::Nearest {
  double squared = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
  NearestOnTriangle on;
};

ShellDistance::ShellDistance(std::vector<Vector3> vertices_m, std::vector<TriangleCorners> triangles,
                             Kind kind)
    : vertices_m_(std::move(vertices_m)),
      tree_(boxes_of(vertices_m_, triangles), leaf_size),
      kind_(kind),
      size_m_(tree_.nodes()[0].box.size()) {
  SPOONBILL_ASSERT(!triangles.empty());
  triangles_.reserve(triangles.size());
  for (const std::uint32_t index : tree_.order()) triangles_.push_back(triangles[index]);
  triangles = {};
  if (kind_ == Kind::sheets) return;
  take_normals();
  if (!is_told_by_normals()) winding_.emplace(vertices_m_, triangles_, tree_);
}

void ShellDistance::take_normals() {
  if (triangles_.size() > checked_triangles) return;
  const MeshEdges edges(triangles_, vertices_m_.size());
  if (!is_manifold(triangles_, edges, vertices_m_.size())) return;
  if (meets_itself(vertices_m_, triangles_, tree_)) return;
  across_.resize(3 * triangles_.size());
  for (MeshSide side = 0; side < across_.size(); ++side) across_[side] = edges.across(side) / 3;
  corner_normals_.assign(vertices_m_.size(), Vector3::Zero());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vector3 normal = face_normal(t);
    for (int k = 0; k < 3; ++k) {
      const Vector3& corner = vertices_m_[triangles_[t][k]];
      const Vector3 to_next = vertices_m_[triangles_[t][(k + 1) % 3]] - corner;
      const Vector3 to_last = vertices_m_[triangles_[t][(k + 2) % 3]] - corner;
      const double angle = std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
      corner_normals_[triangles_[t][k]] += angle * normal;
    }
  }
}

Vector3 ShellDistance::face_normal(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles_[triangle];
  return (vertices_m_[b] - vertices_m_[a]).cross(vertices_m_[c] - vertices_m_[a]).normalized();
}

Vector3 ShellDistance::normal_at(const Nearest& nearest) const {
  using On = NearestOnTriangle::On;
  Vector3 face = face_normal(nearest.triangle);
  if (!is_told_by_normals() || nearest.on.on == On::face) return face;
  if (nearest.on.on == On::side) return face + face_normal(across_[3 * nearest.triangle + nearest.on.which]);
  return corner_normals_[triangles_[nearest.triangle][nearest.on.which]];
}

ShellDistance::Nearest ShellDistance::nearest(const Vector3& point) const {
  Nearest best;
  const std::vector<BoxTree::Node>& nodes = tree_.nodes();
  tree_.search([&](std::uint32_t index) { return nodes[index].box.squared_distance(point) < best.squared; },
               [&](std::uint32_t left, std::uint32_t right) {
                 return nodes[right].box.squared_distance(point) < nodes[left].box.squared_distance(point);
               },
               [&](std::uint32_t first, std::uint32_t count) {
                 for (std::uint32_t t = first; t < first + count; ++t) {
                   const auto& [a, b, c] = triangles_[t];
                   const auto on = nearest_on_triangle(vertices_m_[a], vertices_m_[b], vertices_m_[c], point);
                   const double squared = (on.point - point).squaredNorm();
                   if (squared < best.squared) best = {squared, t, on};
                 }
               });
  return best;
}

bool ShellDistance::is_behind(const Nearest& nearest, const Vector3& point) const {
  if (is_told_by_normals()) return (point - nearest.on.point).dot(normal_at(nearest)) < 0.0;
  const bool beyond = signed_distance(bounds(), point) > 0.0;
  if (kind_ == Kind::cavity) return beyond || winding_->at(point) > -0.5;
  return !beyond && winding_->at(point) > 0.5;
}

DistanceSample ShellDistance::at(const Vector3& point_m) const {
  const Nearest found = nearest(point_m);
  const double distance = std::sqrt(found.squared);
  const double side = kind_ != Kind::sheets && is_behind(found, point_m) ? -1.0 : 1.0;
  if (distance > on_surface_share * size_m_) {
    return {side * distance, side / distance * (point_m - found.on.point)};
  }
  return {side * distance, normal_at(found).normalized()};
}

std::uint32_t ShellDistance::nearest_triangle(const Vector3& point_m) const {
  return tree_.order()[nearest(point_m).triangle];
}

bool ShellDistance::is_convex() const {
  if (kind_ != Kind::solid || !is_told_by_normals() || triangles_.size() > convex_triangles) return false;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vector3 normal = face_normal(t);
    const double foremost = normal.dot(vertices_m_[triangles_[t][0]]) + convex_share * size_m_;
    const bool before = std::any_of(vertices_m_.begin(), vertices_m_.end(),
                                    [&](const Vector3& vertex) { return normal.dot(vertex) > foremost; });
    if (before) return false;
  }
  return true;
}

}  // namespace spoonbill
