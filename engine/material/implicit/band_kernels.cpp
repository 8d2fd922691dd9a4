#include "engine/material/implicit/band_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = band_block;

inline void subtract_scaled(double* __restrict c, const double* a, double by, int count) {
  for (int i = 0; i < count; ++i) c[i] -= by * a[i];
}

// Subtracts four scaled columns from c. Four at once take a quarter of the reads and writes of c.
inline void subtract_scaled(double* __restrict c, const double* a0, const double* a1, const double* a2,
                            const double* a3, int count) {
  const double b0 = a0[0], b1 = a1[0], b2 = a2[0], b3 = a3[0];
  for (int i = 0; i < count; ++i) c[i] -= (b0 * a0[i] + b1 * a1[i]) + (b2 * a2[i] + b3 * a3[i]);
}

void factor(const BandView& band, int from, int to, double least) {
  const int half = band.half_band;
  for (int j = from; j < to; ++j) {
    double* const c = band.columns + static_cast<long>(j) * band.stride;
    const auto row_j = [&](int k) { return band.columns + static_cast<long>(k) * band.stride + (j - k); };
    int k = j < half ? 0 : j - half;
    // The last of the four columns reaches furthest down; the others are zero there.
    for (; k + 3 < j; k += 4) {
      subtract_scaled(c, row_j(k), row_j(k + 1), row_j(k + 2), row_j(k + 3), half - (j - k) + 4);
    }
    for (; k < j; ++k) subtract_scaled(c, row_j(k), row_j(k)[0], half - (j - k) + 1);
    const double pivot = c[0] > least ? c[0] : least;
    const double inverse = 1.0 / __builtin_sqrt(pivot);
    for (int i = 1; i <= half; ++i) c[i] *= inverse;
    c[0] = inverse;
  }
}

void forward(const BandView& band, int from, double* x) {
  for (int j = from; j < band.size; ++j) {
    const double* const c = band.columns + static_cast<long>(j) * band.stride;
    const double here = x[j] * c[0];
    x[j] = here;
    subtract_scaled(x + j + 1, c + 1, here, band.stride - block);
  }
}

inline double sum_lanes(const double* lanes) {
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

void backward(const BandView& band, double* x) {
  for (int j = band.size - 1; j >= 0; --j) {
    const double* const c = band.columns + static_cast<long>(j) * band.stride;
    alignas(64) double lanes[block] = {};
    for (int start = 1; start <= band.half_band; start += block) {
      for (int l = 0; l < block; ++l) lanes[l] += c[start + l] * x[j + start + l];
    }
    x[j] = (x[j] - sum_lanes(lanes)) * c[0];
  }
}

double dot(const double* a, const double* b, int size) {
  alignas(64) double lanes[block] = {};
  for (int start = 0; start < size; start += block) {
    for (int l = 0; l < block; ++l) lanes[l] += a[start + l] * b[start + l];
  }
  return sum_lanes(lanes);
}

}  // namespace

const BandKernels band_kernels = {factor, forward, backward, dot};

}  // namespace spoonbill::SPOONBILL_KERNELS
