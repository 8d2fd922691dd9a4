// Loops of grid evaluation, compiled once for each instruction set. This header and its source use no
// standard library and no Eigen: the linker could keep the AVX-512 copy of an inline function for the whole
// program, which would crash on an older processor.
#pragma once

namespace spoonbill {

// Number of sample columns in a block. Columns are processed in whole blocks, so that no loop has a
// remainder, on any vector width.
inline constexpr int evaluate_block = 16;

// Number of values in a blended block: x, y and z, then their derivatives with respect to v, evaluate_block
// values of each.
inline constexpr int evaluate_block_size = 6 * evaluate_block;

// Index of a control point along v, and a block of sample columns that this control point affects.
struct EvaluateReach {
  int control;
  int block;
};

// The blending matrix A_v in blocks. For each entry of `reaches`, `values` and `derivatives` contain
// evaluate_block numbers each: the control point's basis function and its derivative at the samples of the
// block. The entries are ordered by control point. Consecutive sums then go into different blocks and do not
// wait for each other.
template <class Real>
struct EvaluateBand {
  const EvaluateReach* reaches;
  const Real* values;
  const Real* derivatives;
  long count;
  int blocks;
};

// One row of the blending matrix A_u, and the rows of the product P A_v^T (the blended rows) that it
// combines. Entry k of the row applies to blended row first + k, modulo `control_rows`.
template <class Real>
struct EvaluateRow {
  const Real* blended;
  long blended_row_size;
  int control_rows;
  int first;
  int bandwidth;  // 2 to 10
  const Real* values;
  const Real* derivatives;
  Real du_noise_squared;         // squared rounding error of du in this row
  const Real* dv_noise_squared;  // squared rounding error of dv in each column
  Real surely_regular;           // if |du x dv|^2 is above this, it is not rounding error
};

// Destinations of a row of samples; no alignment is required.
template <class Real>
struct EvaluateOutput {
  Real* x;
  Real* y;
  Real* z;
  Real* nx;
  Real* ny;
  Real* nz;
};

// Function table of one instruction set and one precision.
template <class Real>
struct EvaluateKernels {
  // Blends one control row along v into band.blocks blocks.
  void (*blend)(const EvaluateBand<Real>& band, const Real* x, const Real* y, const Real* z, Real* blended);

  // Computes only the points of a row.
  void (*points)(const EvaluateRow<Real>& row, int first_block, int blocks, const EvaluateOutput<Real>& out);

  // Computes the points and unit normals of a row. Returns the number of samples whose du x dv does not
  // exceed the rounding error; their normals are zero.
  int (*points_and_normals)(const EvaluateRow<Real>& row, int first_block, int blocks,
                            const EvaluateOutput<Real>& out);

  // Computes the points and unit normals of a row at a fraction of the cost of points_and_normals(). Returns
  // true if |du x dv|^2 exceeds row.surely_regular at every sample; the results then equal those of
  // points_and_normals() bit for bit. Otherwise returns false, and the normals are undefined.
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
