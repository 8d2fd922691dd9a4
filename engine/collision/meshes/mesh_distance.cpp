#include "engine/collision/meshes/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {

namespace {

// Distance beyond which a node of the tree counts as a dipole, in radii of the node. Barill et al. use 2 with
// second-order moments; without such moments, 3 gives the same accuracy.
constexpr double far_radii = 3.0;

struct Moments {
  Vector3 area = Vector3::Zero();  // sum of the triangles' area vectors
  Vector3 weighted = Vector3::Zero();
  double weight = 0.0;
};

}  // namespace

WindingNumber::WindingNumber(const std::vector<Vector3>& vertices_m,
                             const std::vector<TriangleCorners>& triangles, const BoxTree& tree)
    : vertices_m_(&vertices_m), triangles_(&triangles), tree_(&tree), dipoles_(tree.nodes().size()) {
  SPOONBILL_ASSERT(tree.order().size() == triangles.size());
  std::vector<Moments> moments(dipoles_.size());
  for (std::size_t index = dipoles_.size(); index-- > 0;) {
    const BoxTree::Node& node = tree.nodes()[index];
    Moments& sum = moments[index];
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
      const auto& [i, j, k] = triangles[t];
      const Vector3 &a = vertices_m[i], &b = vertices_m[j], &c = vertices_m[k];
      const Vector3 area = 0.5 * (b - a).cross(c - a);
      sum.area += area;
      sum.weight += area.norm();
      sum.weighted += area.norm() / 3.0 * (a + b + c);
    }
    if (!node.is_leaf()) {
      for (const std::size_t child : {index + 1, static_cast<std::size_t>(node.first)}) {
        sum.area += moments[child].area;
        sum.weight += moments[child].weight;
        sum.weighted += moments[child].weighted;
      }
    }
    const Vector3 centre = sum.weighted / sum.weight;
    const Vector3 farthest = (node.box.high - centre).cwiseMax(centre - node.box.low);
    dipoles_[index] = {centre, sum.area, far_radii * farthest.norm()};
  }
}

double WindingNumber::at(const Vector3& point_m) const {
  double angle = 0.0;
  tree_->search(
      [&](std::uint32_t index) {
        const Dipole& dipole = dipoles_[index];
        const Vector3 offset = dipole.centre_m - point_m;
        const double distance = offset.norm();
        if (distance <= dipole.far_m) return true;
        angle += offset.dot(dipole.area_m2) / (distance * distance * distance);
        return false;
      },
      [](std::uint32_t, std::uint32_t) { return false; },
      [&](std::uint32_t first, std::uint32_t count) {
        for (std::uint32_t t = first; t < first + count; ++t) {
          const auto& [a, b, c] = (*triangles_)[t];
          const std::vector<Vector3>& vertices = *vertices_m_;
          angle += solid_angle(vertices[a] - point_m, vertices[b] - point_m, vertices[c] - point_m);
        }
      });
  return angle / full_solid_angle;
}

namespace {

// Smallest distance of a point from its nearest point on the mesh at which the direction between the two is
// reliable, as a fraction of the mesh's size.
constexpr double on_surface_fraction = 1e-12;
constexpr double convex_fraction = 1e-7;
// Largest number of triangles for which convexity is tested, because the test compares every face with every
// vertex.
constexpr std::size_t convex_triangles = 20'000;

std::vector<Box> make_boxes(const std::vector<Vector3>& vertices,
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

// Returns true if every edge has exactly two triangles and the triangles at every vertex form one fan.
bool is_manifold(const std::vector<TriangleCorners>& triangles, const MeshEdges& edges,
                 std::size_t vertices) {
  if (edges.open_count() > 0 || edges.branching_count() > 0) return false;
  const std::vector<std::uint32_t> corners = corners_at_vertices(triangles, vertices);
  std::vector<bool> walked(vertices, false);
  for (MeshSide side = 0; side < 3 * triangles.size(); ++side) {
    const std::uint32_t vertex = side_start(triangles, side);
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
      tree_(make_boxes(vertices_m_, triangles), triangle_leaf_size),
      kind_(kind),
      size_m_(tree_.nodes()[0].box.size()) {
  SPOONBILL_ASSERT(!triangles.empty());
  triangles_.reserve(triangles.size());
  for (const std::uint32_t index : tree_.order()) triangles_.push_back(triangles[index]);
  triangles = {};
  if (kind_ == Kind::sheets) return;
  compute_normals();
  if (!uses_normals()) winding_.emplace(vertices_m_, triangles_, tree_);
}

void ShellDistance::compute_normals() {
  if (triangles_.size() > checked_triangles) return;
  const MeshEdges edges(triangles_, vertices_m_.size());
  if (!is_manifold(triangles_, edges, vertices_m_.size())) return;
  if (is_self_intersecting(vertices_m_, triangles_, tree_)) return;
  across_.resize(3 * triangles_.size());
  for (MeshSide side = 0; side < across_.size(); ++side) across_[side] = edges.across(side) / 3;
  corner_normals_.assign(vertices_m_.size(), Vector3::Zero());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vector3 normal = face_normal(t);
    for (int k = 0; k < 3; ++k) {
      const Vector3& corner = vertices_m_[triangles_[t][k]];
      const Vector3 to_next = vertices_m_[triangles_[t][(k + 1) % 3]] - corner;
      const Vector3 to_previous = vertices_m_[triangles_[t][(k + 2) % 3]] - corner;
      const double angle = std::atan2(to_next.cross(to_previous).norm(), to_next.dot(to_previous));
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
  if (!uses_normals() || nearest.on.on == On::face) return face;
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
  if (uses_normals()) return (point - nearest.on.point).dot(normal_at(nearest)) < 0.0;
  const bool beyond = signed_distance(bounds(), point) > 0.0;
  if (kind_ == Kind::cavity) return beyond || winding_->at(point) > -0.5;
  return !beyond && winding_->at(point) > 0.5;
}

DistanceSample ShellDistance::at(const Vector3& point_m) const {
  const Nearest found = nearest(point_m);
  const double distance = std::sqrt(found.squared);
  const double side = kind_ != Kind::sheets && is_behind(found, point_m) ? -1.0 : 1.0;
  if (distance > on_surface_fraction * size_m_) {
    return {side * distance, side / distance * (point_m - found.on.point)};
  }
  return {side * distance, normal_at(found).normalized()};
}

std::uint32_t ShellDistance::nearest_triangle(const Vector3& point_m) const {
  return tree_.order()[nearest(point_m).triangle];
}

bool ShellDistance::is_convex() const {
  if (kind_ != Kind::solid || !uses_normals() || triangles_.size() > convex_triangles) return false;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vector3 normal = face_normal(t);
    const double foremost = normal.dot(vertices_m_[triangles_[t][0]]) + convex_fraction * size_m_;
    const bool has_vertex_in_front =
        std::any_of(vertices_m_.begin(), vertices_m_.end(),
                    [&](const Vector3& vertex) { return normal.dot(vertex) > foremost; });
    if (has_vertex_in_front) return false;
  }
  return true;
}

namespace {

std::unique_ptr<ShellDistance> make_shell(TriangleMesh mesh, ShellDistance::Kind kind) {
  return std::make_unique<ShellDistance>(std::move(mesh.vertices_m), std::move(mesh.triangles), kind);
}

}  // namespace

std::vector<MeshDistance::Solid> MeshDistance::make_solids(const CleanMesh& mesh, double thickness_m) {
  using Kind = ShellDistance::Kind;
  std::vector<Solid> solids;
  std::vector<std::size_t> solid_index(mesh.parts.size(), 0);
  TriangleMesh sheets;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const MeshPart& part = mesh.parts[p];
    if (!part.closed) append_part(mesh.mesh, part, sheets);
    if (!part.closed || part.cavity_of >= 0) continue;
    TriangleMesh own;
    append_part(mesh.mesh, part, own);
    solid_index[p] = solids.size();
    solids.emplace_back().outside = make_shell(std::move(own), Kind::solid);
  }
  for (const MeshPart& part : mesh.parts) {
    if (part.cavity_of < 0) continue;
    TriangleMesh own;
    append_part(mesh.mesh, part, own);
    solids[solid_index[static_cast<std::size_t>(part.cavity_of)]].cavities.push_back(
        make_shell(std::move(own), Kind::cavity));
  }
  if (!sheets.triangles.empty()) {
    solids.emplace_back().outside = make_shell(std::move(sheets), Kind::sheets);
    solids.back().half_thickness_m = 0.5 * thickness_m;
  }
  return solids;
}

std::vector<Box> MeshDistance::make_boxes(const std::vector<Solid>& solids) {
  std::vector<Box> boxes;
  boxes.reserve(solids.size());
  for (const Solid& solid : solids) {
    const Box& box = solid.outside->bounds();
    boxes.push_back({box.low.array() - solid.half_thickness_m, box.high.array() + solid.half_thickness_m});
  }
  return boxes;
}

MeshDistance::MeshDistance(const CleanMesh& mesh, double thickness_m)
    : solids_(make_solids(mesh, thickness_m)),
      tree_(make_boxes(solids_), 1),
      convex_(solids_.size() == 1 && solids_[0].cavities.empty() && solids_[0].outside->is_convex()) {
  SPOONBILL_ASSERT(!mesh.parts.empty());
  SPOONBILL_ASSERT(thickness_m > 0.0);
}

DistanceSample MeshDistance::Solid::at(const Vector3& point_m) const {
  DistanceSample sample = outside->at(point_m);
  sample.distance_m -= half_thickness_m;
  if (sample.distance_m >= 0.0) return sample;
  for (const auto& cavity : cavities) {
    const DistanceSample other = cavity->at(point_m);
    if (other.distance_m > sample.distance_m) sample = other;
  }
  return sample;
}

DistanceSample MeshDistance::at(const Vector3& point_m) const {
  if (solids_.size() == 1) return solids_[0].at(point_m);
  DistanceSample best;
  best.distance_m = std::numeric_limits<double>::infinity();
  const std::vector<BoxTree::Node>& nodes = tree_.nodes();
  tree_.search(
      [&](std::uint32_t index) { return signed_distance(nodes[index].box, point_m) < best.distance_m; },
      [&](std::uint32_t left, std::uint32_t right) {
        return signed_distance(nodes[right].box, point_m) < signed_distance(nodes[left].box, point_m);
      },
      [&](std::uint32_t first, std::uint32_t) {
        const DistanceSample sample = solids_[tree_.order()[first]].at(point_m);
        if (sample.distance_m < best.distance_m) best = sample;
      });
  return best;
}

Box MeshDistance::bounds() const {
  return tree_.nodes()[0].box;
}

}  // namespace spoonbill
