#include "engine/simulation/mesh_mapping.h"

#include <algorithm>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/embed_point.h"

namespace spoonbill {
namespace {

// Returns a number for the octant of a cell that contains the point. The number consists of the cell's first
// node and one bit for each direction.
int find_cell_octant(const EmbeddedPoint& point) {
  int octant = 0;
  for (int bit = 0; bit < 3; ++bit) {
    float upper_weight = 0.0f;
    for (int c = 0; c < 8; ++c) {
      if ((c >> bit & 1) != 0) upper_weight += point.weight[c];
    }
    octant |= upper_weight > 0.5f ? 1 << bit : 0;
  }
  return 8 * point.node[0] + octant;
}

}  // namespace

MeshMapping::MeshMapping(const TriangleMesh& rest, const std::vector<TriangleCorners>& drawn,
                         const SpringLattice& lattice)
    : rest_m_(rest.vertices_m),
      triangles_(std::make_shared<const std::vector<TriangleCorners>>(drawn)),
      node_moves_(4 * static_cast<std::size_t>(lattice.mesh().node_count()), 0.0f),
      current_(rest) {
  SPOONBILL_ASSERT(!rest.triangles.empty());
  embed(lattice);
  const LatticeMesh& mesh = lattice.mesh();
  patches_.resize(rest_m_.size());
  if (mesh.is_frame) {
    std::iota(patches_.begin(), patches_.end(), 0);
    return;
  }
  std::transform(rest_m_.begin(), rest_m_.end(), patches_.begin(),
                 [&](const Vector3& vertex) { return find_cell_octant(embed_in_box(mesh, vertex)); });
  std::vector<int> found = patches_;
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  for (int& patch : patches_) {
    patch = static_cast<int>(std::lower_bound(found.begin(), found.end(), patch) - found.begin());
  }
}

void MeshMapping::embed(const SpringLattice& lattice) {
  const LatticeMesh& mesh = lattice.mesh();
  embedding_.clear();
  embedding_.reserve(rest_m_.size());
  for (const Vector3& vertex : rest_m_) {
    const EmbeddedPoint point = mesh.is_frame ? embed_in_mesh(mesh, vertex) : embed_in_box(mesh, vertex);
    CellWeights& weights = embedding_.emplace_back();
    std::copy_n(point.node.begin(), 8, weights.node);
    std::copy_n(point.weight.begin(), 8, weights.weight);
  }
}

MeshMapping MeshMapping::rebased(const SpringLattice& lattice) const {
  MeshMapping mapping = *this;
  mapping.rest_m_ = current_.vertices_m();
  mapping.embed(lattice);
  return mapping;
}

void MeshMapping::update(const SpringLattice& lattice) {
  using Vector4 = float __attribute__((vector_size(16)));
  const auto nodes = static_cast<std::size_t>(lattice.mesh().node_count());
  const float *x = lattice.displacements(0), *y = lattice.displacements(1), *z = lattice.displacements(2);
  auto* const moves = reinterpret_cast<Vector4*>(node_moves_.data());
  for (std::size_t n = 0; n < nodes; ++n) moves[n] = Vector4{x[n], y[n], z[n], 0.0f};
  std::vector<Vector3>& vertices = current_.mutable_vertices_m();
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const CellWeights& cell = embedding_[v];
    const auto term = [&](int c) { return cell.weight[c] * moves[cell.node[c]]; };
    const Vector4 sum =
        ((term(0) + term(1)) + (term(2) + term(3))) + ((term(4) + term(5)) + (term(6) + term(7)));
    vertices[v] = rest_m_[v] + Vector3(sum[0], sum[1], sum[2]);
  }
  current_.refit();
}

void MeshMapping::place(const Pose& pose) {
  const Eigen::Matrix3d turn = pose.orientation.toRotationMatrix();
  std::vector<Vector3>& vertices = current_.mutable_vertices_m();
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] = pose.position_m + turn * rest_m_[v];
  current_.refit();
}

EmbeddedPoint MeshMapping::vertex(std::uint32_t vertex) const {
  const CellWeights& cell = embedding_[vertex];
  EmbeddedPoint point;
  point.count = 8;
  std::copy_n(cell.node, 8, point.node.begin());
  std::copy_n(cell.weight, 8, point.weight.begin());
  return point;
}

EmbeddedPoint MeshMapping::at(const PointOnMesh& on) const {
  EmbeddedPoint point;
  for (std::size_t c = 0; c < 3; ++c) point.add(vertex(on.vertex[c]), static_cast<float>(on.weight[c]));
  return point;
}

}  // namespace spoonbill
