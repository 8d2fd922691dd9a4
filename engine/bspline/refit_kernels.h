// Matrix product for DisplacementRefit, compiled once for each instruction set. This header and its source
// use no standard library and no Eigen; evaluate_kernels.h explains why.
#pragma once

namespace spoonbill {

inline constexpr int product_lanes = 16;  // number of floats in one vector

// Computes out (rows x columns) = a (rows x depth) b (depth x columns). The matrices are row-major without
// gaps. `columns` must be a multiple of product_lanes, b and out must be aligned to 64 bytes, and out must
// overlap neither a nor b. The terms of each entry are summed in the order of depth, whatever the vector
// width.
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
