#include "engine/material/lattice/outside_nodes.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

using GridIndex = std::array<int, 3>;

// Fraction of the speed cap to which nodes outside the body are limited, so that the cap does not count them.
constexpr float outside_speed_fraction = 0.95f;

// Returns the first corner of the filled cell whose centre is nearest to a node. The mesh must have a filled
// cell.
GridIndex find_nearest_cell(const LatticeMesh& mesh, int node) {
  GridIndex nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        if (!mesh.is_filled(i, j, k)) continue;
        const Vector3 centre = trilinear(mesh.cell(i, j, k), 0.5, 0.5, 0.5);
        const double square = (centre - mesh.nodes[static_cast<std::size_t>(node)]).squaredNorm();
        if (square >= least) continue;
        least = square;
        nearest = {i, j, k};
      }
    }
  }
  SPOONBILL_ASSERT(least < std::numeric_limits<double>::infinity());
  return nearest;
}

}  // namespace

OutsideNodes::OutsideNodes(const LatticeMesh& mesh) {
  if (mesh.node_locations.empty() || mesh.is_frame) return;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (mesh.node_locations[static_cast<std::size_t>(n)] != NodeLocation::outside_body) continue;
    const GridIndex cell = find_nearest_cell(mesh, n), at = mesh.grid_index(n);
    Node outside{n, {}, {}};
    for (std::size_t c = 0; c < 8; ++c) {
      const GridIndex bits = {static_cast<int>(c >> 2 & 1), static_cast<int>(c >> 1 & 1),
                              static_cast<int>(c & 1)};
      outside.corners[c] = mesh.index(cell[0] + bits[0], cell[1] + bits[1], cell[2] + bits[2]);
      // The mean over the corners, plus the mean slope along each axis times the distance from the cell's
      // centre in cells.
      double weight = 1.0 / 8.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        weight += (bits[axis] == 1 ? 0.25 : -0.25) * (at[axis] - cell[axis] - 0.5);
      }
      outside.weights[c] = static_cast<float>(weight);
    }
    nodes_.push_back(outside);
  }
}

void OutsideNodes::continue_field(const float* is_free, float* field) const {
  for (const Node& outside : nodes_) {
    if (is_free[outside.node] == 0.0f) continue;
    float sum = 0.0f;
    for (std::size_t c = 0; c < 8; ++c) sum += outside.weights[c] * field[outside.corners[c]];
    field[outside.node] = sum;
  }
}

void OutsideNodes::limit_speeds(const SpeedCap& cap, const LatticeView& view) const {
  const float most = outside_speed_fraction * cap.cap_m_per_s, most_square = most * most;
  for (const Node& outside : nodes_) {
    const int n = outside.node;
    if (view.free_node[n] == 0.0f) continue;
    const float x = view.vx[n] - cap.mean_x, y = view.vy[n] - cap.mean_y, z = view.vz[n] - cap.mean_z;
    const float square = x * x + y * y + z * z;
    if (square <= most_square) continue;
    const float scale = most / std::sqrt(square);
    view.vx[n] = cap.mean_x + scale * x;
    view.vy[n] = cap.mean_y + scale * y;
    view.vz[n] = cap.mean_z + scale * z;
  }
}

}  // namespace spoonbill
