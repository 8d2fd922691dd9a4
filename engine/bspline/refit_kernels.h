// The matrix product of the refit, compiled once for each instruction set. No standard library and no Eigen
// in here, for the reason that evaluate_kernels.h gives.
#pragma once

namespace spoonbill {

inline constexpr int product_lanes = 16;  // a whole number of them makes a row of b and out

// out (rows x columns) = a (rows x depth) b (depth x columns), all row-major without gaps, b and out on
// addresses that are multiples of 64 bytes; out must not overlap a or b. Each entry is summed in order of
// depth, whatever the vector width.
using MultiplyInOrder = void (*)(const float* a, const float* b, float* out, int rows, int depth,
                                 int columns);

namespace kernels_baseline {
extern const MultiplyInOrder multiply_in_order;
}
namespace kernels_avx2 {
extern const MultiplyInOrder multiply_in_order;
}
namespace kernels_avx512 {
extern const MultiplyInOrder multiply_in_order;
}

}  // namespace spoonbill
