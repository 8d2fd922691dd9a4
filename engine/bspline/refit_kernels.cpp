#include "engine/bspline/refit_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

namespace {

// So many factors are added to a sum while it stays in a register, for all rows while they stay in the cache.
constexpr int unrolled = 8;

template <int count>
inline void add_products(const float* __restrict scale, const float* __restrict factors,
                         float* __restrict sums, long columns) {
#pragma GCC ivdep
  for (long j = 0; j < columns; ++j) {
    float sum = sums[j];
#pragma GCC unroll 8
    for (int n = 0; n < count; ++n) sum += scale[n] * factors[n * columns + j];
    sums[j] = sum;
  }
}

void multiply(const float* a, const float* b, float* out, int rows, int depth, int columns) {
  const long stride = columns;
  for (long j = 0; j < rows * stride; ++j) out[j] = 0.0f;
  long k = 0;
  for (; k + unrolled <= depth; k += unrolled) {
    for (long row = 0; row < rows; ++row) {
      add_products<unrolled>(a + row * depth + k, b + k * stride, out + row * stride, stride);
    }
  }
  for (; k < depth; ++k) {
    for (long row = 0; row < rows; ++row) {
      add_products<1>(a + row * depth + k, b + k * stride, out + row * stride, stride);
    }
  }
}

}  // namespace

const MultiplyInOrder multiply_in_order = multiply;

}  // namespace spoonbill::SPOONBILL_KERNELS
