// The straightforward evaluation and refit of a sheet with a matrix library: dense products in single
// precision, compiled for each instruction set with the flags of our own kernels and selected in the same
// way.
#pragma once

#include <memory>

#include "engine/base/processor.h"

namespace spoonbill {

// Sizes of a sheet and tables of its basis functions. Each table has one row per sample and one column per
// control point, in row-major order.
struct DenseSheet {
  int samples = 0;   // number of samples in each direction
  int controls = 0;  // number of control points in each direction
  const float* values = nullptr;
  const float* derivatives = nullptr;
};

// Computes M = A_u P A_v^T for points and both tangents, then the normalised cross product of the tangents. P
// are the control points, A_u and A_v the blending matrices, M the samples. Owns its working memory.
class DenseEvaluation {
 public:
  virtual ~DenseEvaluation() = default;
  // `in`: x, y, z of the control points; `out`: x, y, z of the samples and of their normals. Each coordinate
  // is a separate array.
  virtual void points_and_normals(const float* const in[3], float* const out[6]) = 0;
};

// Computes the change dP = A_u^+ dM (A_v^+)^T of the control points from the change dM of the samples, for
// one coordinate. Owns the pseudo-inverses A_u^+ and A_v^+ of the blending matrices, and its working memory.
class DenseRefit {
 public:
  virtual ~DenseRefit() = default;
  virtual void control_displacement(const float* samples, float* controls) = 0;
};

std::unique_ptr<DenseEvaluation> make_dense_evaluation(const DenseSheet& sheet, InstructionSet set);
// `inverse` is the pseudo-inverse for both directions: controls x samples numbers in row-major order.
std::unique_ptr<DenseRefit> make_dense_refit(int samples, int controls, const float* inverse,
                                             InstructionSet set);

// The factory functions for one instruction set.
struct DenseProducts {
  DenseEvaluation* (*make_evaluation)(const DenseSheet& sheet);
  DenseRefit* (*make_refit)(int samples, int controls, const float* inverse);
};
namespace kernels_baseline {
extern const DenseProducts dense_products;
}
namespace kernels_avx2 {
extern const DenseProducts dense_products;
}
namespace kernels_avx512 {
extern const DenseProducts dense_products;
}

}  // namespace spoonbill
