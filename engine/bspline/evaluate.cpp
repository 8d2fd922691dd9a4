#include "engine/bspline/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

template <class Real>
const EvaluateKernels<Real>& select_precision(const EvaluateKernels<float>& single,
                                              const EvaluateKernels<double>& exact) {
  if constexpr (std::is_same_v<Real, float>) {
    return single;
  } else {
    return exact;
  }
}

template <class Real>
const EvaluateKernels<Real>& kernels_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return select_precision<Real>(kernels_avx512::evaluate_kernels_float,
                                    kernels_avx512::evaluate_kernels_double);
    case InstructionSet::avx2:
      return select_precision<Real>(kernels_avx2::evaluate_kernels_float,
                                    kernels_avx2::evaluate_kernels_double);
    case InstructionSet::baseline:
      break;
  }
  return select_precision<Real>(kernels_baseline::evaluate_kernels_float,
                                kernels_baseline::evaluate_kernels_double);
}

int count_blocks(int samples) {
  return (samples + evaluate_block - 1) / evaluate_block;
}

std::vector<double> row_magnitudes(const BlendingMatrix& matrix, double length) {
  std::vector<double> sums(static_cast<std::size_t>(matrix.rows), 0.0);
  for (int row = 0; row < matrix.rows; ++row) {
    for (int k = 0; k < matrix.bandwidth; ++k) {
      sums[row] += std::abs(matrix.values[row * matrix.bandwidth + k]) * length;
    }
  }
  return sums;
}

double max_value(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

// starts_on_edge() returns true if the first sample is at a clamped end of the domain, ends_on_edge() if the
// last sample is.
bool starts_on_edge(const GridDirection& direction) {
  return !direction.knots.is_periodic() && direction.values.values.front() == 1.0;
}
bool ends_on_edge(const GridDirection& direction) {
  return !direction.knots.is_periodic() && direction.values.values.back() == 1.0;
}

template <class Real>
struct NetExtent {
  Real largest_coordinate;  // largest magnitude of a coordinate
  Real reach;               // longest side of the box around the control net
};

template <class Real>
NetExtent<Real> measure_extent(const NetView<Real>& net, int count) {
  NetExtent<Real> extent{Real(0), Real(0)};
  for (const Real* values : {net.x, net.y, net.z}) {
    Real lowest = values[0], highest = values[0];
    for (int i = 1; i < count; ++i) {
      lowest = std::min(lowest, values[i]);
      highest = std::max(highest, values[i]);
    }
    extent.largest_coordinate = std::max({extent.largest_coordinate, -lowest, highest});
    extent.reach = std::max(extent.reach, highest - lowest);
  }
  return extent;
}

// Returns true if `count` control points coincide within the tolerance. The first has the index `first`, and
// they are `step` elements apart.
template <class Real>
bool coincide(const NetView<Real>& net, int first, int step, int count, Real tolerance) {
  for (const Real* values : {net.x, net.y, net.z}) {
    for (int i = 1; i < count; ++i) {
      if (!(std::abs(values[first + i * step] - values[first]) <= tolerance)) return false;
    }
  }
  return true;
}

// Returns a bound of the rounding error of a computed derivative. `magnitude` is the sum of the magnitudes of
// the basis functions' derivatives.
template <class Real>
double noise(double largest_coordinate, double magnitude) {
  return 8.0 * std::numeric_limits<Real>::epsilon() * largest_coordinate * magnitude;
}
template <class Real>
Real noise_squared(double largest_coordinate, double magnitude) {
  const double derivative_noise = noise<Real>(largest_coordinate, magnitude);
  return static_cast<Real>(derivative_noise * derivative_noise);
}

template <class Real>
EvaluateOutput<Real> sample_row(GridSamples<Real>& samples, int row, int columns) {
  const std::size_t first = static_cast<std::size_t>(row) * columns;
  return {samples.x.data() + first,  samples.y.data() + first,  samples.z.data() + first,
          samples.nx.data() + first, samples.ny.data() + first, samples.nz.data() + first};
}

template <class Real>
EvaluateOutput<Real> spare_row(AlignedVector<Real>& spare) {
  const std::size_t size = spare.size() / 6;
  Real* const data = spare.data();
  return {data, data + size, data + 2 * size, data + 3 * size, data + 4 * size, data + 5 * size};
}

template <class Real>
bool has_normal(const EvaluateOutput<Real>& row, int j) {
  return row.nx[j] != 0 || row.ny[j] != 0 || row.nz[j] != 0;
}

template <class Real>
void copy_normals(const EvaluateOutput<Real>& from, int j, int count, const EvaluateOutput<Real>& to, int k) {
  std::copy_n(from.nx + j, count, to.nx + k);
  std::copy_n(from.ny + j, count, to.ny + k);
  std::copy_n(from.nz + j, count, to.nz + k);
}

template <class Real>
void copy_points(const EvaluateOutput<Real>& from, int j, int count, const EvaluateOutput<Real>& to, int k) {
  std::copy_n(from.x + j, count, to.x + k);
  std::copy_n(from.y + j, count, to.y + k);
  std::copy_n(from.z + j, count, to.z + k);
}

}  // namespace

template <class Real>
GridEvaluator<Real>::GridEvaluator(const Grid& grid, InstructionSet set)
    : grid_(&grid),
      kernels_(&kernels_for<Real>(set)),
      u_bound_(grid.u.knots),
      v_bound_(grid.v.knots),
      blocks_(count_blocks(grid.columns() + 2)) {
  SPOONBILL_ASSERT(grid.rows() >= 2 && grid.columns() >= 2);
  set_up_rows(grid.u);
  set_up_columns(grid.v);
  const std::size_t blocks = static_cast<std::size_t>(blocks_);
  blended_.resize(static_cast<std::size_t>(grid.u.knots.control_point_count()) * blocks *
                  evaluate_block_size);
  dv_noise_squared_.resize(blocks * evaluate_block);
  spare_.resize(6 * blocks * evaluate_block);
}

template <class Real>
void GridEvaluator<Real>::set_up_rows(const GridDirection& u) {
  const double length = u.knots.domain_length();
  for (const double value : u.values.values) u_values_.push_back(static_cast<Real>(value));
  for (const double value : u.first_derivatives.values) {
    u_derivatives_.push_back(static_cast<Real>(value * length));
  }
  u_magnitude_ = row_magnitudes(u.first_derivatives, length);
}

// Stores the blending matrix A_v as dense blocks, so that loads are contiguous however few samples a span
// has. The last block is padded with copies of the last sample column. The padding then lacks a normal only
// if that column does.
template <class Real>
void GridEvaluator<Real>::set_up_columns(const GridDirection& v) {
  const double length = v.knots.domain_length();
  v_magnitude_ = row_magnitudes(v.first_derivatives, length);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(blocks_ * evaluate_block, v.values.columns);
  Eigen::MatrixXd derivatives = values;
  values.topRows(v.values.rows) = v.values.dense();
  derivatives.topRows(v.values.rows) = v.first_derivatives.dense() * length;
  for (int j = v.values.rows; j < count_blocks(v.values.rows) * evaluate_block; ++j) {
    values.row(j) = values.row(v.values.rows - 1);
    derivatives.row(j) = derivatives.row(v.values.rows - 1);
  }
  for (int control = 0; control < v.values.columns; ++control) {
    for (int block = 0; block < blocks_; ++block) {
      const auto block_values = values.col(control).segment<evaluate_block>(block * evaluate_block);
      const auto block_derivatives = derivatives.col(control).segment<evaluate_block>(block * evaluate_block);
      if (block_values.isZero(0.0) && block_derivatives.isZero(0.0)) continue;
      reaches_.push_back({control, block});
      for (const double value : block_values) v_values_.push_back(static_cast<Real>(value));
      for (const double value : block_derivatives) v_derivatives_.push_back(static_cast<Real>(value));
    }
  }
}

template <class Real>
void GridEvaluator<Real>::points_and_normals(const Real* x, const Real* y, const Real* z,
                                             GridSamples<Real>& samples) {
  SPOONBILL_ASSERT(samples.x.size() >= static_cast<std::size_t>(grid_->rows()) * grid_->columns());
  SPOONBILL_ASSERT(samples.nz.size() == samples.x.size());
  const NetView<Real> net{x, y, z, grid_->v.knots.control_point_count()};
  const NetExtent<Real> extent = measure_extent(net, grid_->u.knots.control_point_count() * net.columns);
  const CollapsedEdges edges = collapsed_edges(net, extent.reach);
  blend_control_rows(net);
  for (std::size_t j = 0; j < v_magnitude_.size(); ++j) {
    dv_noise_squared_[j] = noise_squared<Real>(extent.largest_coordinate, v_magnitude_[j]);
  }
  set_up_limit_columns(edges);
  const Real regular_above = regularity_bound(net, extent.largest_coordinate);

  int allowed = extent.reach > 0 ? 4 * (grid_->rows() + grid_->columns()) : 0;
  for (int row = 0; row < grid_->rows(); ++row) {
    EvaluateRow<Real> task = row_task(row);
    task.surely_regular = regular_above;
    task.du_noise_squared = noise_squared<Real>(extent.largest_coordinate, u_magnitude_[row]);
    const int degenerate = compute_row(task, row, edges, samples);
    if (row == 0) compute_limit_row(task, row, edges.first_row, samples);
    if (row == grid_->rows() - 1) compute_limit_row(task, row, edges.last_row, samples);
    if (degenerate > 0) fill_missing_normals(net, row, allowed, samples);
  }
}

template <class Real>
void GridEvaluator<Real>::points(const Real* x, const Real* y, const Real* z, GridSamples<Real>& samples) {
  SPOONBILL_ASSERT(samples.z.size() >= static_cast<std::size_t>(grid_->rows()) * grid_->columns());
  blend_control_rows({x, y, z, grid_->v.knots.control_point_count()});
  const int columns = grid_->columns(), whole = columns / evaluate_block;
  const EvaluateOutput<Real> spare = spare_row(spare_);
  for (int row = 0; row < grid_->rows(); ++row) {
    const EvaluateRow<Real> task = row_task(row);
    const EvaluateOutput<Real> out = sample_row(samples, row, columns);
    kernels_->points(task, 0, whole, out);
    const int left = columns - whole * evaluate_block;
    if (left == 0) continue;
    kernels_->points(task, whole, 1, spare);
    copy_points(spare, 0, left, out, whole * evaluate_block);
  }
}

template <class Real>
auto GridEvaluator<Real>::collapsed_edges(const NetView<Real>& net, Real reach) const -> CollapsedEdges {
  const int rows = grid_->u.knots.control_point_count(), columns = net.columns;
  const Real tolerance = Real(1e-6) * reach;
  const auto collapsed = [&](int first, int step, int count) {
    return coincide(net, first, step, count, tolerance);
  };
  CollapsedEdges edges;
  if (starts_on_edge(grid_->u) && collapsed(0, 1, columns)) edges.first_row = 1;
  if (ends_on_edge(grid_->u) && collapsed((rows - 1) * columns, 1, columns)) edges.last_row = -1;
  if (starts_on_edge(grid_->v) && collapsed(0, columns, rows)) edges.first_column = 1;
  if (ends_on_edge(grid_->v) && collapsed(columns - 1, columns, rows)) edges.last_column = -1;
  return edges;
}

// Returns a value of |du x dv|^2 above which every sample has a normal according to the kernels. The kernels
// test whether |du x dv|^2 exceeds noise(du)^2 |dv|^2 + noise(dv)^2 |du|^2. The returned value is at least
// the smallest normal number, because smaller numbers may be rounding errors of underflow.
template <class Real>
Real GridEvaluator<Real>::regularity_bound(const NetView<Real>& net, double largest_coordinate) const {
  const int rows = grid_->u.knots.control_point_count(), columns = net.columns;
  const double du = u_bound_.longest(ControlLines<Real>{net.x, net.y, net.z, columns, columns, 1});
  const double dv = v_bound_.longest(ControlLines<Real>{net.x, net.y, net.z, 1, rows, columns});
  const double du_noise = noise<Real>(largest_coordinate, max_value(u_magnitude_));
  const double dv_noise = noise<Real>(largest_coordinate, max_value(v_magnitude_));
  const double u_part = du_noise * (dv + dv_noise), v_part = dv_noise * (du + du_noise);
  constexpr double above_rounding = 1.01;
  return static_cast<Real>(std::max<double>(above_rounding * (u_part * u_part + v_part * v_part),
                                            std::numeric_limits<Real>::min()));
}

template <class Real>
void GridEvaluator<Real>::blend_control_rows(const NetView<Real>& net) {
  const EvaluateBand<Real> band{reaches_.data(), v_values_.data(), v_derivatives_.data(),
                                static_cast<long>(reaches_.size()), blocks_};
  const std::size_t row_size = static_cast<std::size_t>(blocks_) * evaluate_block_size;
  for (int row = 0; row < grid_->u.knots.control_point_count(); ++row) {
    const int first = row * net.columns;
    kernels_->blend(band, net.x + first, net.y + first, net.z + first, blended_.data() + row * row_size);
  }
}

// Fills the two limit columns, in which the normals of the first and the last column are computed if these
// columns are collapsed. At a collapsed column du vanishes; at a small distance h inside the surface, du is
// about h duv. The normal's limit is therefore computed with derivatives along v in place of values.
template <class Real>
void GridEvaluator<Real>::set_up_limit_columns(const CollapsedEdges& edges) {
  const int columns = grid_->columns();
  const int edge_columns[] = {0, columns - 1};
  const int inward[] = {edges.first_column, edges.last_column};
  const auto offset_of_column = [](int column) {
    return column / evaluate_block * evaluate_block_size + column % evaluate_block;
  };
  const std::size_t row_size = static_cast<std::size_t>(blocks_) * evaluate_block_size;
  for (int edge = 0; edge < 2; ++edge) {
    if (inward[edge] == 0) continue;
    dv_noise_squared_[columns + edge] = dv_noise_squared_[edge_columns[edge]];
    for (Real* row = blended_.data(); row != blended_.data() + blended_.size(); row += row_size) {
      const Real* derivatives = row + offset_of_column(edge_columns[edge]) + 3 * evaluate_block;
      Real* const limit = row + offset_of_column(columns + edge);
      for (int k = 0; k < 3 * evaluate_block; k += evaluate_block) {
        limit[k] = static_cast<Real>(inward[edge]) * derivatives[k];
        limit[k + 3 * evaluate_block] = derivatives[k];
      }
    }
  }
}

template <class Real>
EvaluateRow<Real> GridEvaluator<Real>::row_task(int row) const {
  const BlendingMatrix& matrix = grid_->u.values;
  const std::size_t first_value = static_cast<std::size_t>(row) * matrix.bandwidth;
  return {blended_.data(),
          static_cast<long>(blocks_) * evaluate_block_size,
          matrix.columns,
          matrix.first[row],
          matrix.bandwidth,
          u_values_.data() + first_value,
          u_derivatives_.data() + first_value,
          Real(0),
          dv_noise_squared_.data(),
          Real(0)};
}

// Computes a row and returns the number of its samples without a normal. If all samples have normals for
// certain, the row is written directly, and its padding overwrites the start of the next row, which is
// computed later. Otherwise only whole blocks are written directly. The columns after the last whole block
// and the limit columns (see set_up_limit_columns()) are computed in the spare row and copied.
template <class Real>
int GridEvaluator<Real>::compute_row(const EvaluateRow<Real>& task, int row, const CollapsedEdges& edges,
                                     GridSamples<Real>& samples) {
  const int columns = grid_->columns(), whole = columns / evaluate_block;
  const int limits = edges.first_column != 0 || edges.last_column != 0 ? 2 : 0;
  const int blocks = count_blocks(columns + limits) - whole, left = columns - whole * evaluate_block;
  const EvaluateOutput<Real> out = sample_row(samples, row, columns), spare = spare_row(spare_);
  const int padded = count_blocks(columns);
  const bool has_room = (grid_->rows() - row) * columns >= padded * evaluate_block;
  if (limits == 0 && has_room && kernels_->points_and_normals_if_regular(task, 0, padded, out)) return 0;

  int degenerate = kernels_->points_and_normals(task, 0, whole, out);
  if (blocks == 0) return degenerate;

  kernels_->points_and_normals(task, whole, blocks, spare);
  for (int j = 0; j < left; ++j) degenerate += has_normal(spare, j) ? 0 : 1;
  copy_points(spare, 0, left, out, whole * evaluate_block);
  copy_normals(spare, 0, left, out, whole * evaluate_block);
  const int edge_columns[] = {0, columns - 1}, inward[] = {edges.first_column, edges.last_column};
  for (int edge = 0; edge < 2; ++edge) {
    if (inward[edge] == 0 || !has_normal(spare, left + edge)) continue;
    degenerate -= has_normal(out, edge_columns[edge]) ? 0 : 1;
    copy_normals(spare, left + edge, 1, out, edge_columns[edge]);
  }
  return degenerate;
}

// Computes the normals of a collapsed row. At such a row dv vanishes; at a small distance h inside the
// surface, dv is about h duv. The normal's limit is therefore computed with derivatives along u in place of
// values.
template <class Real>
void GridEvaluator<Real>::compute_limit_row(EvaluateRow<Real> task, int row, int inward,
                                            GridSamples<Real>& samples) {
  if (inward == 0) return;
  Real values[max_degree + 1];
  for (int k = 0; k < task.bandwidth; ++k) values[k] = static_cast<Real>(inward) * task.derivatives[k];
  task.values = values;
  const EvaluateOutput<Real> out = sample_row(samples, row, grid_->columns()), spare = spare_row(spare_);
  kernels_->points_and_normals(task, 0, blocks_, spare);
  for (int j = 0; j < grid_->columns(); ++j) {
    if (has_normal(spare, j)) copy_normals(spare, j, 1, out, j);
  }
}

template <class Real>
void GridEvaluator<Real>::fill_missing_normals(const NetView<Real>& net, int row, int& allowed,
                                               GridSamples<Real>& samples) const {
  const EvaluateOutput<Real> out = sample_row(samples, row, grid_->columns());
  for (int j = 0; j < grid_->columns() && allowed > 0; ++j) {
    if (has_normal(out, j)) continue;
    --allowed;
    const Vector3 normal =
        unit_normal(grid_->u.knots, grid_->v.knots, net, grid_->u.parameters[row], grid_->v.parameters[j]);
    out.nx[j] = static_cast<Real>(normal.x());
    out.ny[j] = static_cast<Real>(normal.y());
    out.nz[j] = static_cast<Real>(normal.z());
  }
}

template class GridEvaluator<float>;
template class GridEvaluator<double>;

}  // namespace spoonbill
