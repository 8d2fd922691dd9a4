#include "engine/material/springs/flat_corners.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

// Ratio of a corner's volume to that at rest below which its cell is watched for a tick.
constexpr float watched_corner_ratio = 0.5f;

// K of a corner, divided by LatticeView::crushed_stiffness, which is 8 G V.
constexpr double stiffness_ratio = 15.0 / 8.0 / 8.0;

// Number of corners that move an inner node: those of the 8 cells around it, and their neighbours along the
// three axes.
constexpr double corners_at_node = 32.0;

Vector3 rest_edge(const LatticeView& view, int axis_bit, int node) {
  const SpringArrays& springs = view.springs[view.corner_direction[axis_bit]];
  return {springs.rest_x[node], springs.rest_y[node], springs.rest_z[node]};
}

Vector3 displacement(const LatticeView& view, int node) {
  return {view.dx[node], view.dy[node], view.dz[node]};
}

// The corner of a cell with the bits `corner`: its node, and those at the other ends of its edges along the
// three axes.
struct Corner {
  int node;
  std::array<int, 3> neighbours;
  std::array<double, 3> signs;  // +1 if the edge leads from the node to the neighbour, -1 if it leads back
  std::array<Vector3, 3> rest, present;  // edges in the direction of the axes
};

Corner find_corner(const LatticeView& view, int first, int corner) {
  constexpr std::array<int, 3> axis_bits = {4, 2, 1};
  Corner found;
  found.node = first + view.corner_offset[corner];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int bit = axis_bits[axis];
    const int low = first + view.corner_offset[corner & ~bit],
              high = first + view.corner_offset[corner | bit];
    const bool is_low = (corner & bit) == 0;
    found.neighbours[axis] = is_low ? high : low;
    found.signs[axis] = is_low ? 1.0 : -1.0;
    found.rest[axis] = rest_edge(view, bit, low);
    found.present[axis] = found.rest[axis] + displacement(view, high) - displacement(view, low);
  }
  return found;
}

double volume(const std::array<Vector3, 3>& edges) {
  return edges[0].dot(edges[1].cross(edges[2]));
}

void add_force(const LatticeView& view, int node, const Vector3& force_n) {
  view.fx[node] += static_cast<float>(force_n.x());
  view.fy[node] += static_cast<float>(force_n.y());
  view.fz[node] += static_cast<float>(force_n.z());
}

void add_forces_of(const LatticeView& view, int first, int corner, double h_s) {
  const Corner at = find_corner(view, first, corner);
  const double built = volume(at.rest), per_m3 = static_cast<double>(view.inverse_volume[first]);
  if (!(std::abs(built) * per_m3 >= static_cast<double>(least_corner_volume))) return;
  const double rest = built * static_cast<double>(view.rest_volume_sum[first]) / 12.0 * per_m3;
  const double ratio = volume(at.present) / rest;
  if (!(ratio < static_cast<double>(flat_corner_ratio))) return;
  // Gradients of the ratio at the neighbours; that at the node is the opposite of their sum.
  std::array<Vector3, 3> gradients;
  Vector3 at_node = Vector3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector3 across = at.present[(axis + 1) % 3].cross(at.present[(axis + 2) % 3]);
    gradients[axis] = at.signs[axis] / rest * across;
    at_node -= gradients[axis];
  }
  double per_kg = at_node.squaredNorm() * static_cast<double>(view.inverse_mass[at.node]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    per_kg += gradients[axis].squaredNorm() * static_cast<double>(view.inverse_mass[at.neighbours[axis]]);
  }
  const double stiffness_j = stiffness_ratio * static_cast<double>(view.crushed_stiffness[first]);
  const double push_j = stiffness_j * (static_cast<double>(flat_corner_ratio) - ratio) /
                        (1.0 + corners_at_node * h_s * h_s * stiffness_j * per_kg);
  for (std::size_t axis = 0; axis < 3; ++axis) add_force(view, at.neighbours[axis], push_j * gradients[axis]);
  add_force(view, at.node, push_j * at_node);
}

}  // namespace

FlatCorners::FlatCorners(const LatticeMesh& mesh) {
  if (mesh.is_frame) return;
  is_body_cell_.assign(static_cast<std::size_t>(mesh.node_count()), 0);
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        if (mesh.is_filled(i, j, k)) is_body_cell_[static_cast<std::size_t>(mesh.index(i, j, k))] = 1;
      }
    }
  }
  flat_.reserve(is_body_cell_.size());
  is_flat_.assign(is_body_cell_.size() + lattice_block, 0);
}

void FlatCorners::find(const LatticeKernels& kernels, const LatticeView& view) {
  flat_.clear();
  if (is_body_cell_.empty()) return;
  SPOONBILL_ASSERT_DEBUG(static_cast<std::size_t>(view.padded_count) <= is_flat_.size());
  if (!kernels.find_flat_cells(view, watched_corner_ratio, least_corner_volume, is_flat_.data())) return;
  for (std::size_t n = 0; n < is_body_cell_.size(); ++n) {
    if (is_flat_[n] != 0 && is_body_cell_[n] != 0) flat_.push_back(static_cast<int>(n));
  }
}

void FlatCorners::add_forces(const LatticeView& view, float h_s) const {
  for (const int first : flat_) {
    for (int corner = 0; corner < 8; ++corner) add_forces_of(view, first, corner, static_cast<double>(h_s));
  }
}

}  // namespace spoonbill
