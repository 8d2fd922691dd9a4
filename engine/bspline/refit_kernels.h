// Matrix product of the refit, compiled once for each instruction set. This header and its source use no
// standard library and no Eigen; evaluate_kernels.h explains why.
#pragma once

namespace spoonbill {

inline constexpr int product_lanes = 16;  // the row lengths of b and out are multiples of this

// Computes out (rows x columns) = a (rows x depth) b (depth x columns). The matrices are row-major without
// gaps; b and out are at addresses that are multiples of 64 bytes, and out overlaps neither a nor b. Each
// entry is summed in order of depth, whatever the vector width.
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
