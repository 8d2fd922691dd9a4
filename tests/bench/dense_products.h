// What a good programmer writes first with a matrix library: dense products in single precision. Compiled for
// each instruction set with the flags of our own kernels, and chosen as they are.
#pragma once

#include <memory>

#include "engine/base/processor.h"

namespace spoonbill {

// Tables hold one row a sample and one column a control point, row by row.
struct DenseSheet {
  int samples = 0;   // in each direction
  int controls = 0;  // in each direction
  const float* values = nullptr;
  const float* derivatives = nullptr;
};

// M = A_u P A_v^T for points and both tangents, then the normalised cross product. Holds its working memory.
class DenseEvaluation {
 public:
  virtual ~DenseEvaluation() = default;
  // in: the control points' x, y, z; out: the samples' x, y, z and normals, all planar.
  virtual void points_and_normals(const float* const in[3], float* const out[6]) = 0;
};

// dP = A_u^+ dM (A_v^+)^T of one coordinate. Holds both pseudo-inverses and its working memory.
class DenseRefit {
 public:
  virtual ~DenseRefit() = default;
  virtual void control_displacement(const float* samples, float* controls) = 0;
};

std::unique_ptr<DenseEvaluation> make_dense_evaluation(const DenseSheet& sheet, InstructionSet set);
// `inverse` holds controls x samples numbers, row by row, for both directions.
std::unique_ptr<DenseRefit> make_dense_refit(int samples, int controls, const float* inverse,
                                             InstructionSet set);

// The makers of one instruction set.
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
