#include "render/tessellation/mesh_shading.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_edges.h"

namespace spoonbill {
namespace {

// Faces that meet at a larger angle than 40 degrees have an edge between them.
constexpr float smooth_cosine = 0.766F;

Eigen::Vector3f position(const MeshSnapshot& mesh, std::uint32_t vertex) {
  return {mesh.x[vertex], mesh.y[vertex], mesh.z[vertex]};
}

// As long as twice the area.
Eigen::Vector3f across(const MeshSnapshot& mesh, const std::array<std::uint32_t, 3>& corners) {
  const Eigen::Vector3f a = position(mesh, corners[0]);
  return (position(mesh, corners[1]) - a).cross(position(mesh, corners[2]) - a);
}

// Corners that are drawn as one vertex.
class CornerGroups {
 public:
  explicit CornerGroups(std::size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

void MeshShading::make(const MeshSnapshot& mesh) {
  SPOONBILL_ASSERT(mesh.triangles != nullptr);
  triangles_ = mesh.triangles;
  const auto& triangles = *triangles_;
  const MeshEdges edges(triangles, mesh.x.size());
  CornerGroups groups(3 * triangles.size());
  for (MeshSide side = 0; side < 3 * triangles.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other == MeshEdges::open || other == MeshEdges::branching) continue;
    const Eigen::Vector3f one = across(mesh, triangles[side / 3]).normalized();
    if (one.dot(across(mesh, triangles[other / 3]).normalized()) < smooth_cosine) continue;
    // The other side runs the other way: it starts where this one ends.
    groups.join(side, next_side(other));
  }
  indices_.assign(3 * triangles.size(), 0);
  vertex_.clear();
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> drawn(3 * triangles.size(), none);
  for (std::uint32_t corner = 0; corner < indices_.size(); ++corner) {
    std::uint32_t& index = drawn[groups.find(corner)];
    if (index == none) {
      index = static_cast<std::uint32_t>(vertex_.size());
      vertex_.push_back(triangles[corner / 3][corner % 3]);
    }
    indices_[corner] = index;
  }
}

void MeshShading::shade(const MeshSnapshot& mesh, GridSamples<float>& samples) const {
  SPOONBILL_ASSERT(is_of(mesh));
  samples.resize(vertex_.size());
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    samples.x[v] = mesh.x[vertex_[v]];
    samples.y[v] = mesh.y[vertex_[v]];
    samples.z[v] = mesh.z[vertex_[v]];
    samples.nx[v] = samples.ny[v] = samples.nz[v] = 0.0F;
  }
  for (std::size_t t = 0; t < triangles_->size(); ++t) {
    const Eigen::Vector3f normal = across(mesh, (*triangles_)[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = indices_[3 * t + k];
      samples.nx[v] += normal.x();
      samples.ny[v] += normal.y();
      samples.nz[v] += normal.z();
    }
  }
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    const float length = std::hypot(samples.nx[v], samples.ny[v], samples.nz[v]);
    if (!(length > 0.0F)) continue;
    samples.nx[v] /= length;
    samples.ny[v] /= length;
    samples.nz[v] /= length;
  }
}

}  // namespace spoonbill
