#include "engine/material/lattice/lattice_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "engine/base/assert.h"

namespace spoonbill {

CellCorners LatticeMesh::cell(int i, int j, int k) const {
  SPOONBILL_ASSERT_DEBUG(i >= 0 && i + 1 < count[0] && j >= 0 && j + 1 < count[1] && k >= 0 &&
                         k + 1 < count[2]);
  CellCorners corners;
  for (int c = 0; c < 8; ++c) corners[c] = nodes[index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1))];
  return corners;
}

NodeLocation LatticeMesh::node_location(int i, int j, int k) const {
  if (!node_locations.empty()) return node_locations[static_cast<std::size_t>(index(i, j, k))];
  const bool end_of_i = !closed && (i == 0 || i == count[0] - 1);
  const bool at_end = end_of_i || j == 0 || k == 0 || j == count[1] - 1 || k == count[2] - 1;
  return at_end ? NodeLocation::on_shell : NodeLocation::in_body;
}

double LatticeMesh::mean_edge() const {
  SPOONBILL_ASSERT(nodes.size() == static_cast<std::size_t>(node_count()) && node_count() > 1);
  double sum = 0.0;
  int edges = 0;
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) {
      for (int k = 0; k < count[2]; ++k) {
        const int next[3][3] = {{i + 1, j, k}, {i, j + 1, k}, {i, j, k + 1}};
        for (const auto& n : next) {
          if (n[0] == count[0] || n[1] == count[1] || n[2] == count[2]) continue;
          sum += (nodes[index(n[0], n[1], n[2])] - nodes[index(i, j, k)]).norm();
          ++edges;
        }
      }
    }
  }
  return sum / edges;
}

namespace {

std::array<double, 8> trilinear_weights(double a, double b, double c) {
  std::array<double, 8> weights;
  for (int corner = 0; corner < 8; ++corner) {
    weights[corner] = (corner & 4 ? a : 1.0 - a) * (corner & 2 ? b : 1.0 - b) * (corner & 1 ? c : 1.0 - c);
  }
  return weights;
}

}  // namespace

double quad_cone_volume(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return (a.dot(b.cross(c)) + a.dot(c.cross(d)) + a.dot(b.cross(d)) + b.dot(c.cross(d))) / 12.0;
}

double cell_volume(const CellCorners& p) {
  const Vector3 centre = (p[0] + p[1] + p[2] + p[3] + p[4] + p[5] + p[6] + p[7]) / 8.0;
  CellCorners q;
  for (int c = 0; c < 8; ++c) q[c] = p[c] - centre;
  return quad_cone_volume(q[0], q[1], q[3], q[2]) + quad_cone_volume(q[0], q[2], q[6], q[4]) +
         quad_cone_volume(q[0], q[4], q[5], q[1]) + quad_cone_volume(q[4], q[6], q[7], q[5]) +
         quad_cone_volume(q[2], q[3], q[7], q[6]) + quad_cone_volume(q[1], q[5], q[7], q[3]);
}

Eigen::Matrix3d trilinear_jacobian(const CellCorners& p, double a, double b, double c) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const bool hi = corner & 4, hj = corner & 2, hk = corner & 1;
    const double wi = hi ? a : 1.0 - a, wj = hj ? b : 1.0 - b, wk = hk ? c : 1.0 - c;
    jacobian.col(0) += p[corner] * ((hi ? 1.0 : -1.0) * wj * wk);
    jacobian.col(1) += p[corner] * (wi * (hj ? 1.0 : -1.0) * wk);
    jacobian.col(2) += p[corner] * (wi * wj * (hk ? 1.0 : -1.0));
  }
  return jacobian;
}

double smallest_jacobian_ratio(const CellCorners& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 8; ++c) {
    smallest = std::min(
        smallest, trilinear_jacobian(corners, c & 4 ? 1 : 0, c & 2 ? 1 : 0, c & 1 ? 1 : 0).determinant());
  }
  return smallest / std::abs(cell_volume(corners));
}

Vector3 trilinear(const CellCorners& corners, double a, double b, double c) {
  const auto weights = trilinear_weights(a, b, c);
  Vector3 point = Vector3::Zero();
  for (int corner = 0; corner < 8; ++corner) point += weights[corner] * corners[corner];
  return point;
}

CellLocation locate_in_cell(const CellCorners& corners, const Vector3& point) {
  CellLocation location;
  location.outside = std::numeric_limits<double>::infinity();
  Vector3 local(0.5, 0.5, 0.5);
  for (int step = 0; step < 12; ++step) {
    const Vector3 miss = point - trilinear(corners, local.x(), local.y(), local.z());
    const Eigen::Matrix3d jacobian = trilinear_jacobian(corners, local.x(), local.y(), local.z());
    if (!(std::abs(jacobian.determinant()) > 0.0)) return location;
    const Vector3 move = jacobian.inverse() * miss;
    local += move;
    if (!(local.cwiseAbs().maxCoeff() < 10.0)) return location;
    if (move.cwiseAbs().maxCoeff() < 1e-12) break;
  }
  const Vector3 miss = point - trilinear(corners, local.x(), local.y(), local.z());
  if (!(miss.norm() < 1e-9 * (corners[7] - corners[0]).norm())) return location;
  location.weights = trilinear_weights(local.x(), local.y(), local.z());
  location.outside = ((local.array() - 0.5).abs() - 0.5).maxCoeff();
  return location;
}

LatticeMesh box_mesh(const Vector3& size_m, std::array<int, 3> counts) {
  SPOONBILL_ASSERT(size_m.minCoeff() > 0.0);
  SPOONBILL_ASSERT(counts[0] >= 2 && counts[1] >= 2 && counts[2] >= 2);
  LatticeMesh mesh;
  mesh.count = counts;
  mesh.nodes.reserve(static_cast<std::size_t>(mesh.node_count()));
  for (int k = 0; k < counts[2]; ++k) {
    for (int i = 0; i < counts[0]; ++i) {
      for (int j = 0; j < counts[1]; ++j) {
        mesh.nodes.emplace_back(size_m.x() * i / (counts[0] - 1), size_m.y() * j / (counts[1] - 1),
                                size_m.z() * k / (counts[2] - 1));
      }
    }
  }
  return mesh;
}

Status check_cells(const LatticeMesh& mesh) {
  SPOONBILL_ASSERT(mesh.nodes.size() == static_cast<std::size_t>(mesh.node_count()));
  double worst = std::numeric_limits<double>::infinity();
  std::array<int, 3> where{};
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        const CellCorners corners = mesh.cell(i, j, k);
        const double ratio = cell_volume(corners) > 0.0 ? smallest_jacobian_ratio(corners) : -1.0;
        if (ratio < worst) {
          worst = ratio;
          where = {i, j, k};
        }
      }
    }
  }
  if (worst > 0.0) return {};
  return Error{ErrorCode::self_intersecting, "lattice: cell (" + std::to_string(where[0]) + ", " +
                                                 std::to_string(where[1]) + ", " + std::to_string(where[2]) +
                                                 ") is folded over; use fewer nodes or a smoother surface"};
}

namespace {

using Counts = std::array<int, 3>;

Counts near_cubic_counts(const Vector3& size, int budget, const Counts& min_cells) {
  double edge = std::cbrt(size.x() * size.y() * size.z() / budget);
  for (;; edge *= 1.01) {
    // Each axis gets at most `budget` cells, so that extreme sizes do not overflow an int.
    const auto count = [&](int axis) {
      const double cells = std::min(size[axis] / edge, 1.0 * budget);
      return std::max(min_cells[static_cast<std::size_t>(axis)], static_cast<int>(std::lround(cells))) + 1;
    };
    const Counts counts = {count(0), count(1), count(2)};
    const double nodes = 1.0 * counts[0] * counts[1] * counts[2];
    const bool least = counts == Counts{min_cells[0] + 1, min_cells[1] + 1, min_cells[2] + 1};
    if (nodes <= budget || least) return counts;
  }
}

Result<Counts> choose_counts(const LatticeRequest& request, const Vector3& size_m, const Counts& min_cells) {
  const Counts counts =
      request.counts ? *request.counts : near_cubic_counts(size_m, request.node_budget, min_cells);
  for (const int count : counts) {
    if (count < 2)
      return Error{ErrorCode::out_of_range, "lattice: node counts must be at least 2 in each direction",
                   "nodes"};
  }
  return counts;
}

}  // namespace

Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m) {
  return choose_counts(request, size_m, {2, 2, 2});
}

Result<std::array<int, 3>> shell_counts(const LatticeRequest& request, const Vector3& size_m, bool closed) {
  constexpr int round_enough = 8;
  Result<Counts> counts = choose_counts(request, size_m, {closed ? round_enough : 2, 1, 2});
  if (counts.ok() && closed && counts.value()[0] <= min_cells_around) {
    return Error{ErrorCode::out_of_range,
                 "lattice: nodes[0] is " + std::to_string(counts.value()[0]) + ", must be at least " +
                     std::to_string(min_cells_around + 1) + " around a closed shell",
                 "nodes[0]"};
  }
  return counts;
}

}  // namespace spoonbill
