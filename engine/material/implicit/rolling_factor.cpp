#include "engine/material/implicit/rolling_factor.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace spoonbill {
namespace {

// Number of multiplications in one part of the factorisation. A part takes about 0.1 to 0.2 ms; a long body
// has about four parts.
constexpr double products_a_piece = 8e5;

}  // namespace

int node_reach(const LatticeMesh& mesh) {
  return mesh.closed ? mesh.index(mesh.count[0] - 2, mesh.count[1] - 1, 1) : mesh.index(1, 1, 1);
}

RollingFactor::RollingFactor(const LatticeMesh& mesh, const BandKernels& kernels)
    : kernels_(&kernels), slice_columns_(3 * mesh.count[0] * mesh.count[1]) {
  const int size = 3 * mesh.node_count(), half_band = 3 * (node_reach(mesh) + 1) - 1;
  const int stride = (half_band + band_block) / band_block * band_block + band_block;
  for (Doubles& columns : columns_) {
    columns.assign(static_cast<std::size_t>(size + 1) * static_cast<std::size_t>(stride), 0.0);
  }
  used_ = {size, half_band, stride, columns_[0].data()};
  next_.band = {size, half_band, stride, columns_[1].data()};
}

RollingFactor::RollingFactor(const RollingFactor& other)
    : kernels_(other.kernels_),
      slice_columns_(other.slice_columns_),
      used_(other.used_),
      next_(other.next_),
      columns_{other.columns_[0], other.columns_[1]} {
  for (BandView* const band : {&used_, &next_.band}) {
    band->columns = columns_[band->columns == other.columns_[0].data() ? 0 : 1].data();
  }
}

int RollingFactor::padded_size() const {
  return (used_.size + band_block - 1) / band_block * band_block + used_.stride;
}

void RollingFactor::begin(double inertia, double stiffness) {
  next_.inertia = inertia;
  next_.stiffness = stiffness;
  next_.layers = next_.columns = 0;
}

// Clears the columns of the nodes with one grid index k and sets their mass terms.
void RollingFactor::clear_slice(const MatrixParts& parts, int k) {
  const int columns = slice_columns_;
  double* column = next_.band.columns + static_cast<std::ptrdiff_t>(k) * columns * next_.band.stride;
  std::fill_n(column, static_cast<std::ptrdiff_t>(columns) * next_.band.stride, 0.0);
  for (int n = k * columns; n < (k + 1) * columns; ++n, column += next_.band.stride) {
    *column = next_.inertia * parts.mass[n / 3];
  }
}

// Adds the stiffness of one cell, rotated into the frame, to the band.
void RollingFactor::add_cell(const MatrixParts& parts, const CellBatch& b, int lane) {
  Eigen::Matrix3d rotation;
  for (int e = 0; e < 9; ++e) rotation(e / 3, e % 3) = b.turn[e][lane] + (e % 4 == 0 ? 1.0 : 0.0);
  rotation = parts.frame.transpose() * rotation;
  const auto entry = [&](int row, int column) {
    const int low = std::min(row, column), high = std::max(row, column);
    return b.stiffness[high * (high + 1) / 2 + low][lane];
  };
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 8; ++c) {
      const int row_node = b.node[a][lane], column_node = b.node[c][lane];
      if (row_node < column_node) continue;
      Eigen::Matrix3d here;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) here(row, column) = entry(3 * a + row, 3 * c + column);
      }
      Eigen::Matrix3d rotated = rotation * here * rotation.transpose();
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          const int at_row = 3 * row_node + row, at_column = 3 * column_node + column;
          if (at_row < at_column) continue;
          const double free = parts.free[at_row] * parts.free[at_column];
          next_.band
              .columns[static_cast<std::ptrdiff_t>(at_column) * next_.band.stride + (at_row - at_column)] +=
              free * next_.stiffness * rotated(row, column);
        }
      }
    }
  }
}

void RollingFactor::add_layer(const MatrixParts& parts, int k) {
  if (k == 0) clear_slice(parts, 0);
  clear_slice(parts, k + 1);
  const CellBlock& cells = *parts.cells;
  const auto at = static_cast<std::size_t>(k);
  for (int batch = cells.layers[at]; batch < cells.layers[at + 1]; ++batch) {
    const int here = std::min(cell_lanes, cells.layer_cells - (batch - cells.layers[at]) * cell_lanes);
    for (int lane = 0; lane < here; ++lane) {
      add_cell(parts, cells.batches[static_cast<std::size_t>(batch)], lane);
    }
  }
}

// Factorises further columns. A column is complete when the cells on both sides of its nodes have been added.
void RollingFactor::factorise_columns(const MatrixParts& parts, int count) {
  const int to = std::min(next_.band.size, next_.columns + count);
  const int all_layers = static_cast<int>(parts.cells->layers.size()) - 1;
  const int layers = std::min(all_layers, (to - 1) / slice_columns_ + 1);
  for (; next_.layers < layers; ++next_.layers) add_layer(parts, next_.layers);
  // If K is positive semidefinite, no pivot of D + K is below the corresponding entry of the diagonal matrix
  // D, except for rounding. The second node of a seam pair has no mass and is skipped.
  double lightest = std::numeric_limits<double>::max();
  for (const double* mass = parts.mass; mass != parts.mass + next_.band.size / 3; ++mass) {
    if (*mass > 0.0) lightest = std::min(lightest, *mass);
  }
  kernels_->factor(next_.band, next_.columns, to, next_.inertia * lightest);
  next_.columns = to;
  if (to == next_.band.size) std::swap(used_, next_.band);
}

void RollingFactor::advance(const MatrixParts& parts) {
  const int size = next_.band.size;
  const bool changed = next_.inertia != parts.inertia || next_.stiffness != parts.stiffness;
  if (changed) {
    begin(parts.inertia, parts.stiffness);
    factorise_columns(parts, size);
  }
  if (next_.columns == size) begin(parts.inertia, parts.stiffness);
  const double products_a_column = 0.5 * next_.band.half_band * next_.band.half_band;
  factorise_columns(parts, static_cast<int>(std::ceil(products_a_piece / products_a_column)));
}

void RollingFactor::solve(const double* from, const double* free, double* to) const {
  std::copy_n(from, used_.size, to);
  kernels_->forward(used_, 0, to);
  std::fill_n(to + used_.size, padded_size() - used_.size, 0.0);
  kernels_->backward(used_, to);
  for (int n = 0; n < used_.size; ++n) to[n] *= free[n];
}

}  // namespace spoonbill
