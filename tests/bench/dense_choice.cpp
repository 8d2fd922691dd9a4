#include "tests/bench/dense_products.h"

namespace spoonbill {
namespace {

const DenseProducts& products(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return kernels_avx512::dense_products;
    case InstructionSet::avx2:
      return kernels_avx2::dense_products;
    default:
      return kernels_baseline::dense_products;
  }
}

}  // namespace

std::unique_ptr<DenseEvaluation> make_dense_evaluation(const DenseSheet& sheet, InstructionSet set) {
  return std::unique_ptr<DenseEvaluation>(products(set).make_evaluation(sheet));
}

std::unique_ptr<DenseRefit> make_dense_refit(int samples, int controls, const float* inverse,
                                             InstructionSet set) {
  return std::unique_ptr<DenseRefit>(products(set).make_refit(samples, controls, inverse));
}

}  // namespace spoonbill
