#include "engine/bspline/refit.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "engine/bspline/least_squares.h"
#include "engine/bspline/refit_kernels.h"

namespace spoonbill {

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

int whole_lanes(int count) {
  return (count + product_lanes - 1) / product_lanes * product_lanes;
}

// Control points (rows) from samples (columns): held rows are zero, kept ends copy their sample, and the free
// rows are A_free^+ (1 - A_ends S), S picking the end samples.
Result<Eigen::MatrixXd> constrained_inverse(const GridDirection& direction,
                                            const RefitConstraints& constraints) {
  const Eigen::MatrixXd a = direction.values.dense();
  const Eigen::Index samples = a.rows(), controls = a.cols();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(controls, samples);
  Eigen::MatrixXd left_over = Eigen::MatrixXd::Identity(samples, samples);
  std::vector<Eigen::Index> free;
  for (Eigen::Index c = 0; c < controls; ++c) {
    const bool held =
        !constraints.held_columns.empty() && constraints.held_columns[static_cast<std::size_t>(c)] != 0;
    if (held) continue;
    if ((constraints.keep_first && c == 0) || (constraints.keep_last && c == controls - 1)) {
      const Eigen::Index sample = c == 0 ? 0 : samples - 1;
      inverse(c, sample) = 1.0;
      left_over.col(sample) -= a.col(c);
    } else {
      free.push_back(c);
    }
  }
  if (free.empty()) return inverse;
  Eigen::MatrixXd free_columns(samples, static_cast<Eigen::Index>(free.size()));
  for (std::size_t f = 0; f < free.size(); ++f) {
    free_columns.col(static_cast<Eigen::Index>(f)) = a.col(free[f]);
  }
  const std::optional<Eigen::MatrixXd> fit = least_squares_inverse(free_columns);
  if (!fit) return Error{"the samples do not determine the free control points; take more samples"};
  for (std::size_t f = 0; f < free.size(); ++f) {
    for (Eigen::Index sample = 0; sample < samples; ++sample) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < samples; ++k) {
        sum += (*fit)(static_cast<Eigen::Index>(f), k) * left_over(k, sample);
      }
      inverse(free[f], sample) = sum;
    }
  }
  return inverse;
}

}  // namespace

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, InstructionSet set) {
  return make(grid, RefitConstraints{}, set);
}

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, const RefitConstraints& constraints,
                                                  InstructionSet set) {
  const auto u_inverse = pseudo_inverse(grid.u.knots, grid.u.parameters);
  if (!u_inverse) return Error{"direction u: " + u_inverse.error().message};
  const bool constrained =
      constraints.keep_first || constraints.keep_last || !constraints.held_columns.empty();
  const auto v_inverse = constrained ? constrained_inverse(grid.v, constraints)
                                     : pseudo_inverse(grid.v.knots, grid.v.parameters);
  if (!v_inverse) return Error{"direction v: " + v_inverse.error().message};

  DisplacementRefit refit;
  refit.set_ = set;
  refit.sample_rows_ = grid.rows();
  refit.sample_columns_ = grid.columns();
  refit.sample_stride_ = whole_lanes(refit.sample_columns_);
  refit.control_rows_ = grid.u.knots.control_point_count();
  refit.control_columns_ = grid.v.knots.control_point_count();
  refit.control_stride_ = whole_lanes(refit.control_columns_);
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
