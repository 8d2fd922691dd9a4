#include "engine/bspline/refit.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "engine/base/assert.h"
#include "engine/bspline/constrained_inverse.h"
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

}  // namespace

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, InstructionSet set) {
  return make(grid, RefitConstraints{}, set);
}

Result<DisplacementRefit> DisplacementRefit::make(const Grid& grid, const RefitConstraints& constraints,
                                                  InstructionSet set) {
  const auto u_inverse = pseudo_inverse(grid.u.knots, grid.u.parameters);
  if (!u_inverse) return Error{"direction u: " + u_inverse.error().message};
  const auto v_inverse = constrained_inverse(grid.v.knots, grid.v.parameters, constraints);
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
