// The loops of grid evaluation, compiled once for each instruction set. This header and its source use no
// standard library and no Eigen: an inline function compiled for AVX-512 here could be the copy that the
// linker keeps for everybody, and end the program on an older processor.
#pragma once

namespace spoonbill {

// Columns of samples are handled in whole blocks: no loop has a remainder, on any vector width.
inline constexpr int evaluate_block = 16;

// A blended block: the values x, y, z, then their derivatives by v, evaluate_block of each.
inline constexpr int evaluate_block_size = 6 * evaluate_block;

// A block of columns that a control point reaches.
struct EvaluateReach {
  int control;
  int block;
};

// A_v: for each reach, evaluate_block values and derivatives of the control point's basis function. Ordered
// by control points, so that sums into one block lie far apart in time and do not wait for each other.
template <class Real>
struct EvaluateBand {
  const EvaluateReach* reaches;
  const Real* values;
  const Real* derivatives;
  long count;
  int blocks;
};

// One row of A_u, and the blended control rows (those of P A_v^T) that it combines. Row k of the band is
// blended row first + k, wrapped around at `control_rows`.
template <class Real>
struct EvaluateRow {
  const Real* blended;
  long blended_row_size;
  int control_rows;
  int first;
  int bandwidth;  // 2 to 10
  const Real* values;
  const Real* derivatives;
  Real du_noise_squared;         // rounding error of du in this row
  const Real* dv_noise_squared;  // of dv in each column
  Real surely_regular;           // |du x dv|^2 above it is above the rounding error in every column
};

// Where blocks of a row of samples begin. Blocks need not be aligned there.
template <class Real>
struct EvaluateOutput {
  Real* x;
  Real* y;
  Real* z;
  Real* nx;
  Real* ny;
  Real* nz;
};

template <class Real>
struct EvaluateKernels {
  // Blends one control row along v, into band.blocks blocks.
  void (*blend)(const EvaluateBand<Real>& band, const Real* x, const Real* y, const Real* z, Real* blended);

  void (*points)(const EvaluateRow<Real>& row, int first_block, int blocks, const EvaluateOutput<Real>& out);

  // Returns the number of samples whose du x dv is no more than rounding error; their normals are zero.
  int (*points_and_normals)(const EvaluateRow<Real>& row, int first_block, int blocks,
                            const EvaluateOutput<Real>& out);

  // The same bits at a fraction of the cost where every sample is surely regular, which it returns. Where
  // not, the normals mean nothing.
  bool (*points_and_normals_if_regular)(const EvaluateRow<Real>& row, int first_block, int blocks,
                                        const EvaluateOutput<Real>& out);
};

namespace kernels_baseline {
extern const EvaluateKernels<float> evaluate_kernels_float;
extern const EvaluateKernels<double> evaluate_kernels_double;
}  // namespace kernels_baseline
namespace kernels_avx2 {
extern const EvaluateKernels<float> evaluate_kernels_float;
extern const EvaluateKernels<double> evaluate_kernels_double;
}  // namespace kernels_avx2
namespace kernels_avx512 {
extern const EvaluateKernels<float> evaluate_kernels_float;
extern const EvaluateKernels<double> evaluate_kernels_double;
}  // namespace kernels_avx512

}  // namespace spoonbill
