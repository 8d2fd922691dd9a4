#include "engine/bspline/refit_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

namespace {

// Number of products added to a sum while the sum stays in a register. It is also the number of rows of b
// that stay in the cache while they are used for all rows of a.
constexpr int unrolled = 8;

using Lanes = float __attribute__((vector_size(4 * product_lanes)));

template <int count>
inline void add_products(const float* scale, const Lanes* factors, Lanes* sums, long columns) {
  for (long j = 0; j < columns; ++j) {
    Lanes sum = sums[j];
#pragma GCC unroll 8
    for (int n = 0; n < count; ++n) sum += scale[n] * factors[n * columns + j];
    sums[j] = sum;
  }
}

void multiply(const float* a, const float* b, float* out, int rows, int depth, int columns) {
  const long stride = columns / product_lanes;
  const auto* const factors = reinterpret_cast<const Lanes*>(b);
  auto* const sums = reinterpret_cast<Lanes*>(out);
  for (long j = 0; j < rows * stride; ++j) sums[j] = Lanes{};
  long k = 0;
  for (; k + unrolled <= depth; k += unrolled) {
    for (long row = 0; row < rows; ++row) {
      add_products<unrolled>(a + row * depth + k, factors + k * stride, sums + row * stride, stride);
    }
  }
  for (; k < depth; ++k) {
    for (long row = 0; row < rows; ++row) {
      add_products<1>(a + row * depth + k, factors + k * stride, sums + row * stride, stride);
    }
  }
}

}  // namespace

const MultiplyInOrder multiply_in_order = multiply;

}  // namespace spoonbill::SPOONBILL_KERNELS
