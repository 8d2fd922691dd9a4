#include "engine/simulation/smoothing.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Largest number of nodes that are smoothed in a tick.
constexpr std::size_t nodes_per_tick = 24;

// Fraction of a bump that is removed in one step. The largest eigenvalue of the smoothing flow is 8: each of
// the two lattice lines adds 4. An explicit step is therefore stable below 2 / 8.
constexpr double shell_fraction = 0.15;

// Fraction by which an inner node returns, in one step, to its rest position among its six neighbours. This
// keeps the cells even. It is stable for fractions below 1.
constexpr double inner_fraction = 0.3;

// Largest movement of a node in one step, in lattice cells.
constexpr double max_move_cells = 0.05;

}  // namespace

Smoothing::Smoothing(const LatticeMesh& mesh)
    : shell_(static_cast<std::size_t>(mesh.node_count())),
      rest_per_m_(shell_.size()),
      rest_centre_(shell_.size(), Vector3::Zero()),
      stride_{mesh.count[1], 1, mesh.count[0] * mesh.count[1]},
      count_i_(mesh.count[0]),
      closed_(mesh.closed) {
  near_.reserve(shell_.size());
  const auto at_rest = [&](int node) { return mesh.nodes[static_cast<std::size_t>(node)]; };
  for (int n = 0; n < mesh.node_count(); ++n) connect(mesh, n);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto index = static_cast<std::size_t>(n);
    if (shell_[index].pair_count == 0) {
      const NeighbourCentre centre = neighbour_centre_at(n, at_rest);
      rest_centre_[index] = centre.across.inverse() * centre.offset;  // invertible, because no cell is folded
    } else if (const auto curvature = curvature_at(n, at_rest)) {
      rest_per_m_[index] = curvature->per_m;
    }
  }
}

std::array<int, 2> Smoothing::beside(int node, int axis) const {
  const int stride = stride_[static_cast<std::size_t>(axis)];
  std::array<int, 2> nodes = {node - stride, node + stride};
  if (!closed_ || axis != 0) return nodes;
  const int i = node / stride % count_i_, around = stride * (count_i_ - 1);
  if (i == 0) nodes[0] += around;
  if (i == count_i_ - 1) nodes[1] -= around;
  return nodes;
}

void Smoothing::connect(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.grid_index(node);
  ShellNode& shell = shell_[static_cast<std::size_t>(node)];
  // Neighbours one step inwards, one for each axis along which the node is at an end of the block, in the
  // order i, j, k.
  std::array<int, 3> inward{};
  std::size_t ends = 0;
  Vector3 outward = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const bool low = at[axis] == 0, high = at[axis] == mesh.count[axis] - 1;
    if ((!low && !high) || (mesh.closed && axis == 0)) continue;
    inward[ends] = low ? node + stride_[axis] : node - stride_[axis];
    outward += (mesh.nodes[node] - mesh.nodes[inward[ends]]).normalized();
    ++ends;
  }
  if (ends == 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    const bool between = at[axis] > 0 && at[axis] < mesh.count[axis] - 1;
    if (between || (mesh.closed && axis == 0)) shell.pairs[shell.pair_count++] = beside(node, axis);
  }
  // At an edge of the block, the lattice line continues from one face to the next. At a corner, it continues
  // from the neighbour along i to the neighbour along j.
  if (ends >= 2) shell.pairs[shell.pair_count++] = {inward[0], inward[1]};
  const auto curvature = curvature_at(node, [&](int n) { return mesh.nodes[static_cast<std::size_t>(n)]; });
  if (curvature && curvature->normal.dot(outward) < 0.0) std::swap(shell.pairs[0][0], shell.pairs[0][1]);
}

template <class PositionOf>
std::optional<Smoothing::Curvature> Smoothing::curvature_at(int node, const PositionOf& position_of) const {
  const ShellNode& shell = shell_[static_cast<std::size_t>(node)];
  if (shell.pair_count < 2) return std::nullopt;
  const Vector3 here = position_of(node);
  std::array<Vector3, 2> along, over_chord;
  Curvature curvature;
  for (std::size_t p = 0; p < 2; ++p) {
    const Vector3 a = position_of(shell.pairs[p][0]), b = position_of(shell.pairs[p][1]);
    const double to_a = (here - a).norm(), to_b = (here - b).norm();
    if (!(to_a > 0.0 && to_b > 0.0)) return std::nullopt;
    along[p] = b - a;
    over_chord[p] = here - (to_b * a + to_a * b) / (to_a + to_b);
    // A point on a circle of radius r is at the height to_a * to_b / (2 r) above a chord. The two factors are
    // its distances from the ends of the chord.
    curvature.height_factor[p] = 0.5 * to_a * to_b;
  }
  const Vector3 across = along[0].cross(along[1]);
  const double length = across.norm();
  if (!(length > 0.0)) return std::nullopt;
  curvature.normal = across / length;
  for (std::size_t p = 0; p < 2; ++p) {
    curvature.per_m[p] = over_chord[p].dot(curvature.normal) / curvature.height_factor[p];
  }
  return curvature;
}

std::optional<Smoothing::Curvature> Smoothing::bend_at(const SpringLattice& lattice, int node) const {
  auto bend = curvature_at(node, [&](int n) { return lattice.position(n); });
  if (!bend) return std::nullopt;
  const std::array<double, 2>& rest = rest_per_m_[static_cast<std::size_t>(node)];
  for (std::size_t p = 0; p < 2; ++p) bend->per_m[p] -= rest[p];
  return bend;
}

std::optional<double> Smoothing::bend_toward(const SpringLattice& lattice, int neighbour, int node,
                                             double& height_factor) const {
  const auto bend = bend_at(lattice, neighbour);
  if (!bend) return std::nullopt;
  const ShellNode& shell = shell_[static_cast<std::size_t>(neighbour)];
  for (std::size_t p = 0; p < 2; ++p) {
    const int twin = lattice.mesh().twin(node);
    const auto leads = [&](int to) { return to == node || to == twin; };
    if (!leads(shell.pairs[p][0]) && !leads(shell.pairs[p][1])) continue;
    height_factor = std::min(height_factor, bend->height_factor[p]);
    return bend->per_m[p];
  }
  return std::nullopt;
}

Vector3 Smoothing::measure_bump(const SpringLattice& lattice, int node) const {
  const auto own = bend_at(lattice, node);
  if (!own) return Vector3::Zero();
  const ShellNode& shell = shell_[static_cast<std::size_t>(node)];
  const Vector3 here = lattice.position(node);
  double height = 0.0;
  for (std::size_t p = 0; p < 2; ++p) {
    const auto [a, b] = shell.pairs[p];
    // The smallest height factor of the three nodes keeps the flow stable with uneven cells.
    double height_factor = own->height_factor[p];
    const auto at_a = bend_toward(lattice, a, node, height_factor);
    const auto at_b = bend_toward(lattice, b, node, height_factor);
    if (!at_a || !at_b) continue;
    const double to_a = (here - lattice.position(a)).norm(), to_b = (here - lattice.position(b)).norm();
    height += height_factor * (own->per_m[p] - (to_b * *at_a + to_a * *at_b) / (to_a + to_b));
  }
  return height * own->normal;
}

template <class PositionOf>
Smoothing::NeighbourCentre Smoothing::neighbour_centre_at(int node, const PositionOf& position_of) const {
  NeighbourCentre centre{position_of(node), {}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = beside(node, axis);
    const Vector3 before = position_of(low), after = position_of(high);
    centre.offset -= (before + after) / 6.0;
    centre.across.col(axis) = after - before;
  }
  return centre;
}

Vector3 Smoothing::measure_centre_offset(const SpringLattice& lattice, int node) const {
  const NeighbourCentre centre = neighbour_centre_at(node, [&](int n) { return lattice.position(n); });
  return centre.offset - centre.across * rest_centre_[static_cast<std::size_t>(node)];
}

void Smoothing::apply(SpringLattice& lattice, const SmoothingBrush& brush, std::uint64_t tick) {
  SPOONBILL_ASSERT(brush.reach_m >= 0.0);
  const double reach_square = brush.reach_m * brush.reach_m;
  near_.clear();
  for (int n = 0; n < static_cast<int>(shell_.size()); ++n) {
    if (lattice.is_fixed(n) || lattice.mesh().joined(n) != n) continue;
    if ((lattice.position(n) - brush.centre_m).squaredNorm() < reach_square) near_.push_back(n);
  }
  const std::size_t rounds = (near_.size() + nodes_per_tick - 1) / nodes_per_tick;
  if (rounds == 0) return;
  const double largest_m = max_move_cells * static_cast<double>(lattice.cell_size_m());
  for (std::size_t i = tick % rounds; i < near_.size(); i += rounds) {
    const int node = near_[i];
    const bool inner = shell_[static_cast<std::size_t>(node)].pair_count == 0;
    const double inside = 1.0 - (lattice.position(node) - brush.centre_m).squaredNorm() / reach_square;
    const double weight = inside * inside * (inner ? inner_fraction : shell_fraction);
    Vector3 move = -weight * (inner ? measure_centre_offset(lattice, node) : measure_bump(lattice, node));
    const double length = move.norm();
    if (length > largest_m) move *= largest_m / length;
    lattice.reform(node, move);
  }
}

}  // namespace spoonbill
