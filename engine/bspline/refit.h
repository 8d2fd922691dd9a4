// Refit: moves control points by the displacement of grid samples, dP = A_u^+ dM (A_v^+)^T. Carrying the
// displacement, not the position, leaves an untouched surface untouched to the last bit, where refitting
// positions by Eq. 5 of Pungotra et al. 2013 would smooth it.
#pragma once

#include <vector>

#include "engine/base/aligned_vector.h"
#include "engine/base/instruction_set.h"
#include "engine/base/result.h"
#include "engine/bspline/constrained_inverse.h"
#include "engine/bspline/grid.h"

namespace spoonbill {

// Holds both pseudo-inverses in single precision and the working memory; no allocation after make(). One
// owner, one thread.
class DisplacementRefit {
 public:
  // Refused when the grid's samples do not determine the control points (see pseudo_inverse).
  static Result<DisplacementRefit> make(const Grid& grid, InstructionSet set);

  // The same with constraints: the free columns fit in the sense of least squares what the kept ends leave
  // over.
  static Result<DisplacementRefit> make(const Grid& grid, const RefitConstraints& constraints,
                                        InstructionSet set);

  int sample_rows() const { return sample_rows_; }
  int sample_columns() const { return sample_columns_; }

  // A row of samples takes so many numbers: those past grid.columns() count for nothing.
  int sample_stride() const { return sample_stride_; }

  // sample: grid.rows() x sample_stride() displacements of one coordinate in metres, on an address that is a
  // multiple of 64 bytes; control: r x s displacements of the control points, written. Exactly zero in gives
  // exactly zero out.
  void control_displacement(const float* sample, float* control);

 private:
  DisplacementRefit() = default;

  InstructionSet set_{};
  int sample_rows_ = 0, sample_columns_ = 0, sample_stride_ = 0;
  int control_rows_ = 0, control_columns_ = 0, control_stride_ = 0;
  std::vector<float> u_inverse_;               // control_rows x sample_rows
  AlignedVector<float> v_inverse_transposed_;  // sample_stride x control_stride, zero past the inverse
  AlignedVector<float> half_;                  // control_rows x sample_stride
  AlignedVector<float> padded_control_;        // control_rows x control_stride
};

}  // namespace spoonbill
