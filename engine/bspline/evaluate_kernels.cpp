#include "engine/bspline/evaluate_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

namespace {

template <class Real>
void blend(const EvaluateBand<Real>& band, const Real* x, const Real* y, const Real* z,
           Real* __restrict blended) {
  for (long k = 0; k < static_cast<long>(band.blocks) * evaluate_block_size; ++k) blended[k] = Real(0);
  for (long r = 0; r < band.count; ++r) {
    const EvaluateReach reach = band.reaches[r];
    const Real px = x[reach.control], py = y[reach.control], pz = z[reach.control];
    const Real* const values = band.values + r * evaluate_block;
    const Real* const derivatives = band.derivatives + r * evaluate_block;
    Real* const out = blended + static_cast<long>(reach.block) * evaluate_block_size;
#pragma GCC ivdep
    for (int j = 0; j < evaluate_block; ++j) {
      out[j] += px * values[j];
      out[j + evaluate_block] += py * values[j];
      out[j + 2 * evaluate_block] += pz * values[j];
      out[j + 3 * evaluate_block] += px * derivatives[j];
      out[j + 4 * evaluate_block] += py * derivatives[j];
      out[j + 5 * evaluate_block] += pz * derivatives[j];
    }
  }
}

inline float square_root(float x) {
  return __builtin_sqrtf(x);
}
inline double square_root(double x) {
  return __builtin_sqrt(x);
}

template <class Real, int bandwidth>
struct Weights {
  Real values[bandwidth];
  Real derivatives[bandwidth];
  const Real* rows[bandwidth];
};

template <class Real, int bandwidth>
inline __attribute__((always_inline)) Weights<Real, bandwidth> load_weights(const EvaluateRow<Real>& row,
                                                                            int first_block) {
  Weights<Real, bandwidth> weights;
  int control_row = row.first;
#pragma GCC unroll 10
  for (int k = 0; k < bandwidth; ++k) {
    weights.values[k] = row.values[k];
    weights.derivatives[k] = row.derivatives[k];
    weights.rows[k] = row.blended + control_row * row.blended_row_size +
                      static_cast<long>(first_block) * evaluate_block_size;
    if (++control_row == row.control_rows) control_row = 0;
  }
  return weights;
}

template <class Real, int bandwidth>
inline __attribute__((always_inline)) Real combine(const Real (&weights)[bandwidth],
                                                   const Real* const (&rows)[bandwidth], long offset) {
  Real sum = weights[0] * rows[0][offset];
#pragma GCC unroll 10
  for (int k = 1; k < bandwidth; ++k) sum += weights[k] * rows[k][offset];
  return sum;
}

template <class Real, int bandwidth>
void points_row(const EvaluateRow<Real>& row, int first_block, int blocks, const EvaluateOutput<Real>& out) {
  const Weights<Real, bandwidth> w = load_weights<Real, bandwidth>(row, first_block);
  Real* __restrict const x = out.x;
  Real* __restrict const y = out.y;
  Real* __restrict const z = out.z;
  for (long b = 0; b < blocks; ++b) {
    const long in = b * evaluate_block_size, to = b * evaluate_block;
#pragma GCC ivdep
    for (long j = 0; j < evaluate_block; ++j) {
      x[to + j] = combine(w.values, w.rows, in + j);
      y[to + j] = combine(w.values, w.rows, in + j + evaluate_block);
      z[to + j] = combine(w.values, w.rows, in + j + 2 * evaluate_block);
    }
  }
}

// Treatment of irregular samples. `full` sets their normals to zero; a sample is then irregular if its du x
// dv does not exceed the rounding error. `if_regular` leaves their normals undefined; a sample is then
// irregular if its |du x dv|^2 does not exceed EvaluateRow::surely_regular.
enum class Care { full, if_regular };

// Computes points and normals of a row. Returns the number of irregular samples (see Care).
template <class Real, int bandwidth, Care care>
int points_and_normals_row(const EvaluateRow<Real>& row, int first_block, int blocks,
                           const EvaluateOutput<Real>& out) {
  const Weights<Real, bandwidth> w = load_weights<Real, bandwidth>(row, first_block);
  const Real du_noise = row.du_noise_squared, surely_regular = row.surely_regular;
  const Real* __restrict const dv_noise = row.dv_noise_squared + first_block * evaluate_block;
  Real* __restrict const x = out.x;
  Real* __restrict const y = out.y;
  Real* __restrict const z = out.z;
  Real* __restrict const nx = out.nx;
  Real* __restrict const ny = out.ny;
  Real* __restrict const nz = out.nz;
  int irregular[evaluate_block] = {};
  for (long b = 0; b < blocks; ++b) {
    const long in = b * evaluate_block_size, to = b * evaluate_block;
#pragma GCC ivdep
    for (long j = 0; j < evaluate_block; ++j) {
      x[to + j] = combine(w.values, w.rows, in + j);
      y[to + j] = combine(w.values, w.rows, in + j + evaluate_block);
      z[to + j] = combine(w.values, w.rows, in + j + 2 * evaluate_block);
      const Real ux = combine(w.derivatives, w.rows, in + j);
      const Real uy = combine(w.derivatives, w.rows, in + j + evaluate_block);
      const Real uz = combine(w.derivatives, w.rows, in + j + 2 * evaluate_block);
      const Real vx = combine(w.values, w.rows, in + j + 3 * evaluate_block);
      const Real vy = combine(w.values, w.rows, in + j + 4 * evaluate_block);
      const Real vz = combine(w.values, w.rows, in + j + 5 * evaluate_block);
      const Real cx = uy * vz - uz * vy;
      const Real cy = uz * vx - ux * vz;
      const Real cz = ux * vy - uy * vx;
      const Real squared = cx * cx + cy * cy + cz * cz;
      Real scale = 0;
      if constexpr (care == Care::full) {
        const Real noise =
            du_noise * (vx * vx + vy * vy + vz * vz) + dv_noise[to + j] * (ux * ux + uy * uy + uz * uz);
        const bool regular = squared > noise;
        scale = (regular ? Real(1) : Real(0)) / square_root(regular ? squared : Real(1));
        irregular[j] += regular ? 0 : 1;
      } else {
        scale = Real(1) / square_root(squared);
        irregular[j] += squared > surely_regular ? 0 : 1;
      }
      nx[to + j] = cx * scale;
      ny[to + j] = cy * scale;
      nz[to + j] = cz * scale;
    }
  }
  int sum = 0;
  for (int j = 0; j < evaluate_block; ++j) sum += irregular[j];
  return sum;
}

template <class Real>
void points(const EvaluateRow<Real>& row, int first_block, int blocks, const EvaluateOutput<Real>& out) {
  switch (row.bandwidth) {
    case 2:
      return points_row<Real, 2>(row, first_block, blocks, out);
    case 3:
      return points_row<Real, 3>(row, first_block, blocks, out);
    case 4:
      return points_row<Real, 4>(row, first_block, blocks, out);
    case 5:
      return points_row<Real, 5>(row, first_block, blocks, out);
    case 6:
      return points_row<Real, 6>(row, first_block, blocks, out);
    case 7:
      return points_row<Real, 7>(row, first_block, blocks, out);
    case 8:
      return points_row<Real, 8>(row, first_block, blocks, out);
    case 9:
      return points_row<Real, 9>(row, first_block, blocks, out);
    default:
      return points_row<Real, 10>(row, first_block, blocks, out);
  }
}

template <class Real, Care care>
int irregular_points_and_normals(const EvaluateRow<Real>& row, int first_block, int blocks,
                                 const EvaluateOutput<Real>& out) {
  switch (row.bandwidth) {
    case 2:
      return points_and_normals_row<Real, 2, care>(row, first_block, blocks, out);
    case 3:
      return points_and_normals_row<Real, 3, care>(row, first_block, blocks, out);
    case 4:
      return points_and_normals_row<Real, 4, care>(row, first_block, blocks, out);
    case 5:
      return points_and_normals_row<Real, 5, care>(row, first_block, blocks, out);
    case 6:
      return points_and_normals_row<Real, 6, care>(row, first_block, blocks, out);
    case 7:
      return points_and_normals_row<Real, 7, care>(row, first_block, blocks, out);
    case 8:
      return points_and_normals_row<Real, 8, care>(row, first_block, blocks, out);
    case 9:
      return points_and_normals_row<Real, 9, care>(row, first_block, blocks, out);
    default:
      return points_and_normals_row<Real, 10, care>(row, first_block, blocks, out);
  }
}

template <class Real>
int points_and_normals(const EvaluateRow<Real>& row, int first_block, int blocks,
                       const EvaluateOutput<Real>& out) {
  return irregular_points_and_normals<Real, Care::full>(row, first_block, blocks, out);
}

template <class Real>
bool points_and_normals_if_regular(const EvaluateRow<Real>& row, int first_block, int blocks,
                                   const EvaluateOutput<Real>& out) {
  return irregular_points_and_normals<Real, Care::if_regular>(row, first_block, blocks, out) == 0;
}

template <class Real>
constexpr EvaluateKernels<Real> kernels{blend<Real>, points<Real>, points_and_normals<Real>,
                                        points_and_normals_if_regular<Real>};

}  // namespace

const EvaluateKernels<float> evaluate_kernels_float = kernels<float>;
const EvaluateKernels<double> evaluate_kernels_double = kernels<double>;

}  // namespace spoonbill::SPOONBILL_KERNELS
