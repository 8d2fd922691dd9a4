#include "engine/material/lattice/embed_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace spoonbill {
namespace {

void search_cells_around(const LatticeMesh& mesh, int node, const Vector3& point, CellLocation& best,
                         std::array<int, 3>& cell) {
  const auto [ni, nj, nk] = mesh.grid_index(node);
  for (int i = std::max(0, ni - 1); i <= std::min(ni, mesh.count[0] - 2); ++i) {
    for (int j = std::max(0, nj - 1); j <= std::min(nj, mesh.count[1] - 2); ++j) {
      for (int k = std::max(0, nk - 1); k <= std::min(nk, mesh.count[2] - 2); ++k) {
        const CellLocation location = locate_in_cell(mesh.cell(i, j, k), point);
        if (location.outside < best.outside - 1e-9) {
          best = location;
          cell = {i, j, k};
        }
      }
    }
  }
}

// A cell, and weights of its corners.
struct WeighedCell {
  std::array<int, 3> cell{};
  std::array<double, 8> weights{};
  double size = std::numeric_limits<double>::infinity();  // sum of the magnitudes of the weights
};

// Weighs the corners of a cell that does not contain the point, so that the point follows the linear map that
// is nearest to the motion of the corners, and therefore every rigid motion. `size` stays infinite if the
// corners lie in a plane.
WeighedCell weigh_by_mean_motion(const LatticeMesh& mesh, const std::array<int, 3>& cell,
                                 const Vector3& point) {
  constexpr double plane_fraction = 1e-6;  // smallest relative extent, squared, of corners that span space
  const CellCorners corners = mesh.cell(cell[0], cell[1], cell[2]);
  WeighedCell weighed{cell};
  Vector3 centre = Vector3::Zero();
  for (const Vector3& corner : corners) centre += corner / 8.0;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vector3& corner : corners) moments += (corner - centre) * (corner - centre).transpose();
  const double trace = moments.trace();
  if (!(moments.determinant() > plane_fraction * trace * trace * trace)) return weighed;
  const Vector3 pull = moments.inverse() * (point - centre);
  weighed.size = 0.0;
  for (std::size_t c = 0; c < 8; ++c) {
    weighed.weights[c] = 0.125 + pull.dot(corners[c] - centre);
    weighed.size += std::abs(weighed.weights[c]);
  }
  return weighed;
}

// Finds the cell with this corner that needs the smallest weights.
void weigh_cells_around(const LatticeMesh& mesh, int node, const Vector3& point, WeighedCell& best) {
  const auto [ni, nj, nk] = mesh.grid_index(node);
  for (int i = std::max(0, ni - 1); i <= std::min(ni, mesh.count[0] - 2); ++i) {
    for (int j = std::max(0, nj - 1); j <= std::min(nj, mesh.count[1] - 2); ++j) {
      for (int k = std::max(0, nk - 1); k <= std::min(nk, mesh.count[2] - 2); ++k) {
        const WeighedCell weighed = weigh_by_mean_motion(mesh, {i, j, k}, point);
        if (weighed.size < (1.0 - 1e-9) * best.size) best = weighed;
      }
    }
  }
}

// Largest sum of the magnitudes of a point's weights. Larger weights would amplify the motions of nodes.
constexpr double largest_weights = 16.0;

}  // namespace

EmbeddedPoint embed_in_mesh(const LatticeMesh& mesh, const Vector3& point) {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0; n < mesh.node_count(); ++n) {
    const double distance = (mesh.nodes[n] - point).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = n;
    }
  }
  const int twin = mesh.twin(nearest);
  CellLocation best;
  best.outside = std::numeric_limits<double>::infinity();
  std::array<int, 3> cell{};
  search_cells_around(mesh, nearest, point, best, cell);
  if (twin != nearest) search_cells_around(mesh, twin, point, best, cell);
  EmbeddedPoint embedded;
  if (!(best.outside < 1.0)) {
    WeighedCell weighed;
    weigh_cells_around(mesh, nearest, point, weighed);
    if (twin != nearest) weigh_cells_around(mesh, twin, point, weighed);
    if (!(weighed.size <= largest_weights)) {
      embedded.count = 1;
      embedded.node[0] = nearest;
      embedded.weight[0] = 1.0f;
      return embedded;
    }
    cell = weighed.cell;
    best.weights = weighed.weights;
  }
  embedded.count = 8;
  for (int c = 0; c < 8; ++c) {
    embedded.node[c] =
        mesh.joined(mesh.index(cell[0] + (c >> 2 & 1), cell[1] + (c >> 1 & 1), cell[2] + (c & 1)));
    embedded.weight[c] = static_cast<float>(best.weights[c]);
  }
  return embedded;
}

}  // namespace spoonbill
