#include "engine/bspline/grid.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/refit_kernels.h"

namespace spoonbill {

int GridDirection::find_cell(double parameter) const {
  const auto next = std::upper_bound(parameters.begin(), parameters.end(), parameter) - parameters.begin();
  return std::clamp(static_cast<int>(next) - 1, 0, cell_count() - 1);
}

int GridDirection::wrap_cell(int i) const {
  const int cells = cell_count();
  if (i >= 0 && i < cells) return i;
  return knots.is_periodic() ? (i + cells) % cells : -1;
}

namespace {

Status check_parameters(const KnotVector& knots, const std::vector<double>& parameters) {
  if (parameters.size() < 2) {
    return Error{ErrorCode::too_few,
                 std::to_string(parameters.size()) + " parameters are too few; give at least 2"};
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string here = "parameter " + std::to_string(i) + " (" + number_text(parameters[i]) + ")";
    if (!(parameters[i] >= knots.domain_start() && parameters[i] <= knots.domain_end())) {
      return Error{ErrorCode::out_of_range, here + " is outside the domain " +
                                                number_text(knots.domain_start()) + " to " +
                                                number_text(knots.domain_end()) + "; keep parameters inside"};
    }
    if (i > 0 && !(parameters[i] > parameters[i - 1])) {
      return Error{ErrorCode::malformed, here + " is not greater than parameter " + std::to_string(i - 1) +
                                             " (" + number_text(parameters[i - 1]) +
                                             "); parameters must increase"};
    }
  }
  return {};
}

GridDirection make_direction(const KnotVector& knots, std::vector<double> parameters) {
  BlendingMatrix values = blending_matrix(knots, parameters, 0);
  BlendingMatrix first = blending_matrix(knots, parameters, 1);
  BlendingMatrix second = blending_matrix(knots, parameters, 2);
  return {knots, std::move(parameters), std::move(values), std::move(first), std::move(second)};
}

// Interpolates between `start` (i = 0) and `end` (i = count). At i = count it returns exactly `end`, which
// the formula may miss by rounding.
double between(double start, double end, int i, int count) {
  return i >= count ? end : start + (end - start) * i / count;
}

}  // namespace

Result<Grid> make_grid(const KnotVector& u, const KnotVector& v, std::vector<double> u_parameters,
                       std::vector<double> v_parameters) {
  if (const Status status = check_parameters(u, u_parameters); !status) {
    return status.error().in("direction u");
  }
  if (const Status status = check_parameters(v, v_parameters); !status) {
    return status.error().in("direction v");
  }
  return Grid{make_direction(u, std::move(u_parameters)), make_direction(v, std::move(v_parameters))};
}

std::vector<double> uniform_parameters(const KnotVector& knots, int count) {
  SPOONBILL_ASSERT(count >= 0);
  std::vector<double> parameters;
  parameters.reserve(static_cast<std::size_t>(std::max(count, 0)));
  for (int i = 0; i < count; ++i) {
    parameters.push_back(between(knots.domain_start(), knots.domain_end(), i, count - 1));
  }
  return parameters;
}

std::vector<double> uniform_parameters_without_seam(const KnotVector& knots, int count) {
  SPOONBILL_ASSERT(count >= 0);
  std::vector<double> parameters;
  parameters.reserve(static_cast<std::size_t>(std::max(count, 0)));
  for (int i = 0; i < count; ++i) {
    parameters.push_back(between(knots.domain_start(), knots.domain_end(), i, count));
  }
  return parameters;
}

NestedParameters nested_parameters(const KnotVector& knots, int pieces_per_span, int levels) {
  SPOONBILL_ASSERT(pieces_per_span >= 1);
  SPOONBILL_ASSERT(levels >= 0 && levels < 31);
  NestedParameters nested;
  nested.levels = levels;
  const std::vector<double> breaks = knots.breakpoints();
  const int pieces = pieces_per_span * (1 << levels);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    for (int i = 0; i < pieces; ++i) {
      nested.parameters.push_back(between(breaks[k], breaks[k + 1], i, pieces));
    }
  }
  nested.parameters.push_back(breaks.back());
  return nested;
}

namespace {

// A matrix of points. Each row is a line of points, with three columns for the coordinates of each point.
using Lines = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Returns matrix times lines. Terms are summed in the order of the rows of `lines`, so that the same points
// give the same bits on every machine. Eigen's product does not guarantee this.
Lines product_in_order(const Eigen::MatrixXd& matrix, const Lines& lines) {
  Lines product = Lines::Zero(matrix.rows(), lines.cols());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) product.row(i) += matrix(i, k) * lines.row(k);
  }
  return product;
}

Lines banded_product(const BlendingMatrix& matrix, const Lines& lines) {
  Lines product = Lines::Zero(matrix.rows, lines.cols());
  for (int i = 0; i < matrix.rows; ++i) {
    for (int k = 0; k < matrix.bandwidth; ++k) {
      product.row(i) +=
          matrix.values[static_cast<std::size_t>(i) * matrix.bandwidth + k] * lines.row(matrix.column(i, k));
    }
  }
  return product;
}

// Transposes the matrix of points. The three coordinates of a point stay together.
Lines transpose_points(const Lines& lines) {
  Lines result(lines.cols() / 3, lines.rows() * 3);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    for (Eigen::Index j = 0; j < lines.rows(); ++j) {
      result.block(i, 3 * j, 1, 3) = lines.block(j, 3 * i, 1, 3);
    }
  }
  return result;
}

Lines to_lines(const PointGrid& points) {
  const Eigen::Index rows = static_cast<Eigen::Index>(points.u.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(points.v.size());
  Lines lines(rows, 3 * columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      lines.block(i, 3 * j, 1, 3) = points.points_m[static_cast<std::size_t>(i * columns + j)].transpose();
    }
  }
  return lines;
}

ControlNet to_net(const Lines& lines) {
  ControlNet net(static_cast<int>(lines.rows()), static_cast<int>(lines.cols() / 3));
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, lines.block(i, 3 * j, 1, 3).transpose());
  }
  return net;
}

Lines to_lines(const ControlNet& net) {
  Lines lines(net.rows, 3 * net.columns);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) lines.block(i, 3 * j, 1, 3) = net.point(i, j).transpose();
  }
  return lines;
}

Lines sample_lines(const Surface& surface, const std::vector<double>& u, const std::vector<double>& v) {
  const Lines along_u = banded_product(blending_matrix(surface.u, u, 0), to_lines(surface.net));
  return transpose_points(banded_product(blending_matrix(surface.v, v, 0), transpose_points(along_u)));
}

}  // namespace

Result<Surface> fit_grid(const KnotVector& u, const KnotVector& v, const PointGrid& points,
                         const InterpolatedEnds& interpolated) {
  if (points.points_m.size() != points.u.size() * points.v.size()) {
    return Error{ErrorCode::mismatch, std::to_string(points.points_m.size()) + " points for a grid of " +
                                          std::to_string(points.u.size()) + " x " +
                                          std::to_string(points.v.size()) +
                                          "; give one for each pair of parameters"};
  }
  const auto u_inverse = constrained_inverse(u, points.u, {{}, interpolated.u_first, interpolated.u_last});
  if (!u_inverse) return u_inverse.error().in("direction u");
  const auto v_inverse = constrained_inverse(v, points.v, {{}, interpolated.v_first, interpolated.v_last});
  if (!v_inverse) return v_inverse.error().in("direction v");
  const Lines along_u = product_in_order(u_inverse.value(), to_lines(points));
  const Lines control = transpose_points(product_in_order(v_inverse.value(), transpose_points(along_u)));
  return make_surface(u, v, to_net(control));
}

PointGrid sample_grid_points(const Surface& surface, std::vector<double> u, std::vector<double> v) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const Lines samples = sample_lines(surface, u, v);
  PointGrid grid{std::move(u), std::move(v), {}};
  grid.points_m.reserve(grid.u.size() * grid.v.size());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    for (Eigen::Index j = 0; j < samples.cols() / 3; ++j) {
      grid.points_m.emplace_back(samples.block(i, 3 * j, 1, 3).transpose());
    }
  }
  return grid;
}

double largest_deviation_m(const Surface& surface, const PointGrid& points) {
  SPOONBILL_ASSERT(points.points_m.size() == points.u.size() * points.v.size());
  const Lines difference = sample_lines(surface, points.u, points.v) - to_lines(points);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < difference.rows(); ++i) {
    for (Eigen::Index j = 0; j < difference.cols() / 3; ++j) {
      largest = std::max(largest, difference.block(i, 3 * j, 1, 3).norm());
    }
  }
  return largest;
}

namespace {

MultiplyInOrder multiply_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return kernels_avx512::multiply_in_order;
    case InstructionSet::avx2:
      return kernels_avx2::multiply_in_order;
    case InstructionSet::baseline:
      break;
  }
  return kernels_baseline::multiply_in_order;
}

int round_up_to_lanes(int count) {
  return (count + product_lanes - 1) / product_lanes * product_lanes;
}

}  // namespace

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, InstructionSet set) {
  return make(grid, RefitConstraints{}, set);
}

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, const RefitConstraints& constraints,
                                                  InstructionSet set) {
  const auto u_inverse = pseudo_inverse(grid.u.knots, grid.u.parameters);
  if (!u_inverse) return u_inverse.error().in("direction u");
  const auto v_inverse = constrained_inverse(grid.v.knots, grid.v.parameters, constraints);
  if (!v_inverse) return v_inverse.error().in("direction v");

  DisplacementRefit refit;
  refit.set_ = set;
  refit.sample_rows_ = grid.rows();
  refit.sample_columns_ = grid.columns();
  refit.sample_stride_ = round_up_to_lanes(refit.sample_columns_);
  refit.control_rows_ = grid.u.knots.control_point_count();
  refit.control_columns_ = grid.v.knots.control_point_count();
  refit.control_stride_ = round_up_to_lanes(refit.control_columns_);
  for (int i = 0; i < refit.control_rows_; ++i) {
    for (int k = 0; k < refit.sample_rows_; ++k) {
      refit.u_inverse_.push_back(static_cast<float>(u_inverse.value()(i, k)));
    }
  }
  const auto size = [](int rows, int columns) {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  };
  refit.v_inverse_transposed_.assign(size(refit.sample_stride_, refit.control_stride_), 0.0f);
  for (int k = 0; k < refit.sample_columns_; ++k) {
    for (int j = 0; j < refit.control_columns_; ++j) {
      refit.v_inverse_transposed_[size(k, refit.control_stride_) + static_cast<std::size_t>(j)] =
          static_cast<float>(v_inverse.value()(j, k));
    }
  }
  refit.half_.resize(size(refit.control_rows_, refit.sample_stride_));
  refit.padded_control_.resize(size(refit.control_rows_, refit.control_stride_));
  return refit;
}

void DisplacementRefit::control_displacement(const float* sample, float* control) {
  SPOONBILL_ASSERT(sample != nullptr && control != nullptr);
  SPOONBILL_ASSERT(reinterpret_cast<std::uintptr_t>(sample) % cache_line_bytes == 0);
  const MultiplyInOrder multiply = multiply_for(set_);
  multiply(u_inverse_.data(), sample, half_.data(), control_rows_, sample_rows_, sample_stride_);
  multiply(half_.data(), v_inverse_transposed_.data(), padded_control_.data(), control_rows_, sample_stride_,
           control_stride_);
  for (int i = 0; i < control_rows_; ++i) {
    const float* const from = padded_control_.data() + static_cast<std::ptrdiff_t>(i) * control_stride_;
    std::copy_n(from, control_columns_, control + static_cast<std::ptrdiff_t>(i) * control_columns_);
  }
}

}  // namespace spoonbill
