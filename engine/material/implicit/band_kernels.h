// Cholesky factorisation of a band matrix in double precision. The kernels are compiled once for each
// instruction set and give the same bits on each. This header uses no standard library;
// engine/bspline/evaluate_kernels.h explains why.
#pragma once

namespace spoonbill {

// A symmetric band matrix or its factor. Column j is stored at columns + j * stride: its rows j to j +
// half_band, then zeros. In a factor, the first entry of a column is the inverse of the pivot. Vectors have
// `stride` zeros after their last entry.
struct BandView {
  int size = 0;
  int half_band = 0;
  int stride = 0;  // a multiple of band_block, at least band_block more than half_band
  double* columns = nullptr;
};

inline constexpr int band_block = 8;

struct BandKernels {
  // Factorises columns [from, to) in place: L L^T = A. The columns before `from` must be factorised. A pivot
  // below `least` is raised to `least`, so that a matrix that rounding made indefinite still has a factor.
  void (*factor)(const BandView&, int from, int to, double least);
  // Sets x to L^-1 x, where x is zero before `from`.
  void (*forward)(const BandView&, int from, double* x);
  // Sets x to L^-T x.
  void (*backward)(const BandView&, double* x);
  // Returns the dot product of two vectors, summed in lanes so that the order is the same on every processor.
  // `size` must be a multiple of band_block.
  double (*dot)(const double* a, const double* b, int size);
};

namespace kernels_baseline {
extern const BandKernels band_kernels;
}
namespace kernels_avx2 {
extern const BandKernels band_kernels;
}
namespace kernels_avx512 {
extern const BandKernels band_kernels;
}

}  // namespace spoonbill
