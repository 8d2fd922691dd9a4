#include "engine/material/implicit/implicit_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/material/hexahedron.h"

namespace spoonbill {
namespace {

constexpr int iteration_limit = 4;
// Of the residual that a step begins with, in the norm of the preconditioner.
constexpr double enough = 1e-4;
// In how many ticks a new factor is taken.
constexpr int ticks_a_factor = 4;
// Of the largest entry of its diagonal.
constexpr double least_pivot = 1e-14;
constexpr int power_steps = 200;

template <class Kernels>
const Kernels& chosen(InstructionSet set, const Kernels& baseline, const Kernels& avx2,
                      const Kernels& avx512) {
  switch (set) {
    case InstructionSet::avx512:
      return avx512;
    case InstructionSet::avx2:
      return avx2;
    case InstructionSet::baseline:
      break;
  }
  return baseline;
}

int rounded_up(int count, int block) {
  return (count + block - 1) / block * block;
}

void take_cell(CellBatch& batch, int lane, const CellCorners& corners, const CellMatrix& stiffness,
               double youngs_modulus_pa) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& corner : corners) middle += corner / 8.0;
  const CellGradients gradients = middle_gradients(corners);
  for (int c = 0; c < 8; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      batch.rest[3 * c + axis][lane] = corners[static_cast<std::size_t>(c)][axis] - middle[axis];
      batch.gradient[3 * c + axis][lane] = gradients(c, axis);
    }
  }
  int entry = 0;
  for (int row = 0; row < cell_axes; ++row) {
    for (int column = 0; column <= row; ++column, ++entry) {
      batch.stiffness[entry][lane] = static_cast<float>(stiffness(row, column));
    }
  }
  const double size = std::cbrt(cell_volume(corners));
  batch.stress_stiffness[lane] = youngs_modulus_pa * size;
  batch.inverse_size[lane] = 1.0 / size;
}

}  // namespace

Result<ImplicitBody> ImplicitBody::make(const LatticeMesh& mesh, const Material& material,
                                        InstructionSet set) {
  if (const Status status = check_material(material); !status.ok()) return status.error();
  for (const int count : mesh.count) {
    if (count < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  ImplicitBody body;
  body.band_ =
      &chosen(set, kernels_baseline::band_kernels, kernels_avx2::band_kernels, kernels_avx512::band_kernels);
  body.cells_ =
      &chosen(set, kernels_baseline::cell_kernels, kernels_avx2::cell_kernels, kernels_avx512::cell_kernels);
  body.lay_out(mesh);
  body.take_cells(material);
  body.take_damping(material);
  body.hold(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  return body;
}

void ImplicitBody::lay_out(const LatticeMesh& mesh) {
  mesh_ = mesh;
  size_ = 3 * mesh.node_count();
  const int half_band = 3 * (mesh.index(1, 1, 1) + 1) - 1;
  const int stride = rounded_up(half_band + 1, band_block) + band_block;
  padded_ = rounded_up(size_, band_block) + stride;
  for (Doubles* a : {&mass3_, &free_, &moved_, &velocity_, &applied_, &force_, &residual_, &direction_,
                     &image_, &conditioned_}) {
    a->assign(static_cast<std::size_t>(padded_), 0.0);
  }
  mass_.assign(static_cast<std::size_t>(mesh.node_count()), 0.0);
  for (Doubles& columns : columns_) {
    columns.assign(static_cast<std::size_t>(size_ + 1) * static_cast<std::size_t>(stride), 0.0);
  }
  taken_ = {size_, half_band, stride, columns_[0].data()};
  next_.band = {size_, half_band, stride, columns_[1].data()};
}

void ImplicitBody::take_cells(const Material& material) {
  for (int k = 0; k + 1 < mesh_.count[2]; ++k) {
    layer_batches_.push_back(static_cast<int>(batches_.size()));
    int lane = cell_lanes;
    for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
        const CellCorners corners = mesh_.cell(i, j, k);
        const double share = mesh_.share(i, j, k);
        if (lane == cell_lanes) {
          batches_.emplace_back();
          batches_.back() = {};
          lane = 0;
        }
        CellBatch& batch = batches_.back();
        take_cell(batch, lane, corners,
                  share * hexahedron_stiffness(corners, material.youngs_modulus_pa, material.poissons_ratio),
                  share * material.youngs_modulus_pa);
        for (int c = 0; c < 8; ++c) {
          const int node = mesh_.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
          mass_[static_cast<std::size_t>(node)] +=
              material.density_kg_per_m3 * share * cell_volume(corners) / 8.0;
          for (int rest = lane; rest < cell_lanes; ++rest) batch.node[c][rest] = node;
        }
        for (int rest = lane; rest < cell_lanes; ++rest) {
          batch.quaternion[0][rest] = 1.0;
          for (const int diagonal : {0, 4, 8}) batch.turning[diagonal][rest] = 0.5;
        }
        ++lane;
      }
    }
  }
  layer_batches_.push_back(static_cast<int>(batches_.size()));
}

// The largest eigenvalue of M^-1 K, by power iteration.
double ImplicitBody::fastest_square() {
  std::uint32_t mixed = 1;
  for (int n = 0; n < size_; ++n) {
    mixed = mixed * 1664525u + 1013904223u;
    direction_[static_cast<std::size_t>(n)] = static_cast<double>(mixed >> 16) / 32768.0 - 1.0;
  }
  double square = 0.0;
  for (int step = 0; step < power_steps; ++step) {
    std::fill(image_.begin(), image_.end(), 0.0);
    cells_->apply(batches_.data(), static_cast<int>(batches_.size()), 1.0, direction_.data(), image_.data());
    for (int n = 0; n < size_; ++n) {
      image_[static_cast<std::size_t>(n)] /= mass_[static_cast<std::size_t>(n / 3)];
    }
    const double length = std::sqrt(band_->dot(image_.data(), image_.data(), rounded_up(size_, band_block)));
    square =
        length / std::sqrt(band_->dot(direction_.data(), direction_.data(), rounded_up(size_, band_block)));
    for (int n = 0; n < size_; ++n) {
      direction_[static_cast<std::size_t>(n)] = image_[static_cast<std::size_t>(n)] / length;
    }
  }
  return square;
}

// As springs are damped: the ratio is of the fastest mode.
void ImplicitBody::take_damping(const Material& material) {
  std::fill(force_.begin(), force_.end(), 0.0);
  cells_->take_forces(batches_.data(), static_cast<int>(batches_.size()), moved_.data(), force_.data());
  damping_time_ = 2.0 * material.damping_ratio / std::sqrt(fastest_square());
}

void ImplicitBody::hold(std::span<const std::uint8_t> held) {
  for (int n = 0; n < node_count(); ++n) {
    const bool is_free = held[static_cast<std::size_t>(n)] == 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(3 * n + axis);
      free_[at] = is_free ? 1.0 : 0.0;
      mass3_[at] = is_free ? mass_[static_cast<std::size_t>(n)] : 0.0;
    }
    if (!is_free) set_velocity(n, Vector3::Zero());
  }
  next_.stiffness = 0.0;  // no factor yet
}

void ImplicitBody::free_only(Doubles& of) const {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) of[n] *= free_[n];
}

void ImplicitBody::begin_factor(double inertia, double stiffness) {
  next_.inertia = inertia;
  next_.stiffness = stiffness;
  next_.layers = next_.columns = 0;
  std::fill_n(next_.band.columns,
              static_cast<std::size_t>(size_) * static_cast<std::size_t>(next_.band.stride), 0.0);
  for (int n = 0; n < size_; ++n) {
    next_.band.columns[static_cast<std::ptrdiff_t>(n) * next_.band.stride] =
        inertia * mass_[static_cast<std::size_t>(n / 3)];
  }
}

// The stiffness of one cell, turned, into the band.
void ImplicitBody::add_cell(const CellBatch& b, int lane) {
  Eigen::Matrix3d rotation;
  for (int e = 0; e < 9; ++e) rotation(e / 3, e % 3) = b.turn[e][lane] + (e % 4 == 0 ? 1.0 : 0.0);
  const auto entry = [&](int row, int column) {
    const int low = std::min(row, column), high = std::max(row, column);
    return static_cast<double>(b.stiffness[high * (high + 1) / 2 + low][lane]);
  };
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 8; ++c) {
      const int row_node = b.node[a][lane], column_node = b.node[c][lane];
      if (row_node < column_node) continue;
      Eigen::Matrix3d here;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) here(row, column) = entry(3 * a + row, 3 * c + column);
      }
      Eigen::Matrix3d turned = rotation * here * rotation.transpose();
      turned.diagonal().array() += b.held[lane] * (a == c ? 0.875 : -0.125);
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          const int at_row = 3 * row_node + row, at_column = 3 * column_node + column;
          if (at_row < at_column) continue;
          const double free =
              free_[static_cast<std::size_t>(at_row)] * free_[static_cast<std::size_t>(at_column)];
          next_.band
              .columns[static_cast<std::ptrdiff_t>(at_column) * next_.band.stride + (at_row - at_column)] +=
              free * next_.stiffness * turned(row, column);
        }
      }
    }
  }
}

void ImplicitBody::add_layer(int k) {
  const int cells = (mesh_.count[0] - 1) * (mesh_.count[1] - 1);
  const auto at = static_cast<std::size_t>(k);
  for (int batch = layer_batches_[at]; batch < layer_batches_[at + 1]; ++batch) {
    const int here = std::min(cell_lanes, cells - (batch - layer_batches_[at]) * cell_lanes);
    for (int lane = 0; lane < here; ++lane) add_cell(batches_[static_cast<std::size_t>(batch)], lane);
  }
}

// A column needs the cells on both sides of its nodes.
void ImplicitBody::factor_some(int columns) {
  const int layer_columns = 3 * mesh_.count[0] * mesh_.count[1];
  const int to = std::min(size_, next_.columns + columns);
  const int layers = std::min(mesh_.count[2] - 1, (to - 1) / layer_columns + 1);
  for (; next_.layers < layers; ++next_.layers) add_layer(next_.layers);
  const double least =
      least_pivot * (next_.inertia * mass_[0] + next_.stiffness * batches_[0].stiffness[0][0]);
  band_->factor(next_.band, next_.columns, to, least);
  next_.columns = to;
  if (to == size_) std::swap(taken_, next_.band);
}

void ImplicitBody::precondition(const Doubles& from, Doubles& to) const {
  std::copy_n(from.begin(), size_, to.begin());
  band_->forward(taken_, 0, to.data());
  std::fill(to.begin() + size_, to.end(), 0.0);
  band_->backward(taken_, to.data());
  free_only(to);
}

void ImplicitBody::apply_matrix(double inertia, double stiffness, const Doubles& field, Doubles& out) const {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) out[n] = inertia * mass3_[n] * field[n];
  cells_->apply(batches_.data(), static_cast<int>(batches_.size()), stiffness, field.data(), out.data());
  free_only(out);
}

// From the present velocities on, with the residual taken.
ImplicitReport ImplicitBody::solve(double inertia, double stiffness) {
  const int blocks = rounded_up(size_, band_block);
  const auto dot = [&](const Doubles& a, const Doubles& b) { return band_->dot(a.data(), b.data(), blocks); };
  precondition(residual_, conditioned_);
  std::copy(conditioned_.begin(), conditioned_.end(), direction_.begin());
  const double first = dot(residual_, conditioned_);
  double square = first;
  ImplicitReport report;
  while (report.iterations < iteration_limit && square > enough * enough * first && first > 0.0) {
    apply_matrix(inertia, stiffness, direction_, image_);
    const double step = square / dot(direction_, image_);
    if (!std::isfinite(step)) break;
    ++report.iterations;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      velocity_[n] += step * direction_[n];
      residual_[n] -= step * image_[n];
    }
    precondition(residual_, conditioned_);
    const double next = dot(residual_, conditioned_), turn = next / square;
    square = next;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      direction_[n] = conditioned_[n] + turn * direction_[n];
    }
  }
  report.residual = first > 0.0 ? std::sqrt(square / first) : 0.0;
  return report;
}

ImplicitReport ImplicitBody::step(const ImplicitStep& step) {
  const double h = step.step_s, inertia = 1.0 + h * step.damping_per_s, stiffness = h * (h + damping_time_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    force_[n] = applied_[n] + mass3_[n] * step.gravity_m_per_s2[static_cast<Eigen::Index>(n % 3)];
  }
  cells_->take_forces(batches_.data(), static_cast<int>(batches_.size()), moved_.data(), force_.data());
  if (next_.stiffness == 0.0) {
    begin_factor(inertia, stiffness);
    factor_some(size_);
  }
  if (next_.columns == size_ || next_.inertia != inertia || next_.stiffness != stiffness) {
    begin_factor(inertia, stiffness);
  }
  factor_some((size_ + ticks_a_factor - 1) / ticks_a_factor);
  // b - A v.
  apply_matrix(inertia, stiffness, velocity_, image_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    residual_[n] = free_[n] * (mass3_[n] * velocity_[n] + h * force_[n] - image_[n]);
  }
  const ImplicitReport report = solve(inertia, stiffness);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) moved_[n] += h * velocity_[n];
  return report;
}

}  // namespace spoonbill
