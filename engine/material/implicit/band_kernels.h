// Cholesky factors of a band matrix, in double, compiled once for each instruction set: the same bits with
// every one. Uses no standard library, as engine/bspline/evaluate_kernels.h explains.
#pragma once

namespace spoonbill {

// Column j holds rows j to j + half_band from columns + j * stride on, then zeros. Factored, its first entry
// is one over the pivot. Vectors have `stride` zeros after their last entry.
struct BandView {
  int size = 0;
  int half_band = 0;
  int stride = 0;  // a multiple of band_block, at least band_block beyond half_band
  double* columns = nullptr;
};

inline constexpr int band_block = 8;

struct BandKernels {
  // Columns [from, to) of the lower factor in place, those before being factored: L L^T = A. A pivot below
  // `least` counts as that, so that what rounding made indefinite still has factors.
  void (*factor)(const BandView&, int from, int to, double least);
  // x <- L^-1 x, where x is zero before `from`.
  void (*forward)(const BandView&, int from, double* x);
  // x <- L^-T x.
  void (*backward)(const BandView&, double* x);
  // In lanes, so that the order of the sum is the same on every processor. Whole blocks.
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
