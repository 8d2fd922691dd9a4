// This file is built once for each instruction set, as a shared library that exports only its factory
// functions: Eigen's inline functions must not mix with those compiled for another processor.
#include "tests/bench/dense_products.h"

#include <Eigen/Core>

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Reading = Eigen::Map<const Matrix>;
using Writing = Eigen::Map<Matrix>;

class Evaluation : public DenseEvaluation {
 public:
  explicit Evaluation(const DenseSheet& sheet)
      : samples_(sheet.samples),
        controls_(sheet.controls),
        values_(Reading(sheet.values, samples_, controls_)),
        derivatives_(Reading(sheet.derivatives, samples_, controls_)),
        values_across_(values_.transpose()),
        derivatives_across_(derivatives_.transpose()) {}

  void points_and_normals(const float* const in[3], float* const out[6]) override {
    for (int axis = 0; axis < 3; ++axis) {
      const Reading net(in[axis], controls_, controls_);
      Writing point(out[axis], samples_, samples_);
      blended_.noalias() = net * values_across_;
      point.noalias() = values_ * blended_;
      du_[axis].noalias() = derivatives_ * blended_;
      blended_.noalias() = net * derivatives_across_;
      dv_[axis].noalias() = values_ * blended_;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      Writing normal(out[3 + axis], samples_, samples_);
      normal.array() = du_[b].array() * dv_[c].array() - du_[c].array() * dv_[b].array();
    }
    Writing nx(out[3], samples_, samples_), ny(out[4], samples_, samples_), nz(out[5], samples_, samples_);
    inverse_length_.array() =
        (nx.array().square() + ny.array().square() + nz.array().square()).sqrt().inverse();
    nx.array() *= inverse_length_.array();
    ny.array() *= inverse_length_.array();
    nz.array() *= inverse_length_.array();
  }

 private:
  int samples_, controls_;
  Matrix values_, derivatives_, values_across_, derivatives_across_;
  Matrix blended_, du_[3], dv_[3], inverse_length_;
};

class Refit : public DenseRefit {
 public:
  Refit(int samples, int controls, const float* inverse)
      : samples_(samples),
        controls_(controls),
        inverse_(Reading(inverse, controls, samples)),
        inverse_across_(inverse_.transpose()) {}

  void control_displacement(const float* samples, float* controls) override {
    half_.noalias() = inverse_ * Reading(samples, samples_, samples_);
    Writing(controls, controls_, controls_).noalias() = half_ * inverse_across_;
  }

 private:
  int samples_, controls_;
  Matrix inverse_, inverse_across_, half_;
};

DenseEvaluation* make_evaluation(const DenseSheet& sheet) {
  return new Evaluation(sheet);
}
DenseRefit* make_refit(int samples, int controls, const float* inverse) {
  return new Refit(samples, controls, inverse);
}

}  // namespace

extern const DenseProducts dense_products
    __attribute__((visibility("default"))) = {make_evaluation, make_refit};

}  // namespace spoonbill::SPOONBILL_KERNELS
