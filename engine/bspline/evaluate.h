// Evaluation of surfaces on whole grids: M = A_u P A_v^T (Eq. 4 of Pungotra et al. 2013), points and unit
// normals into structure-of-arrays buffers.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/evaluate_kernels.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Samples of a grid, rows x columns each, in the grid's order.
template <class Real>
struct GridSamples {
  std::vector<Real> x, y, z;     // points in metres
  std::vector<Real> nx, ny, nz;  // unit normals, see unit_normal() for poles and collapsed edges

  void resize(std::size_t count) {
    for (auto* values : {&x, &y, &z, &nx, &ny, &nz}) values->resize(count);
  }
};

// Evaluates surfaces of one grid's knot structure. Owns its working memory: one evaluator for each thread, no
// allocation after construction. The grid must outlive it.
//
// A clamped edge whose control points coincide to a millionth of the net's extent counts as collapsed: its
// samples get the limit of the normal from inside. Other samples at which du x dv is only rounding noise get
// unit_normal(), but only a limited number of them in each pass, to bound its time; the rest get zero
// normals.
template <class Real>
class GridEvaluator {
 public:
  GridEvaluator(const Grid& grid, InstructionSet set);

  // Computes points and normals from the control points x, y, z in metres, ordered as in ControlNet.
  // `samples` must have been resized to grid.rows() * grid.columns().
  void points_and_normals(const Real* x, const Real* y, const Real* z, GridSamples<Real>& samples);

  // Computes only samples.x, y and z, with the same bits as points_and_normals().
  void points(const Real* x, const Real* y, const Real* z, GridSamples<Real>& samples);

 private:
  // Inward direction, +1 or -1, of each outermost grid line that is on a collapsed edge; 0 for the others.
  struct CollapsedEdges {
    int first_row = 0, last_row = 0, first_column = 0, last_column = 0;
  };

  void set_up_rows(const GridDirection& u);
  void set_up_columns(const GridDirection& v);
  CollapsedEdges collapsed_edges(const NetView<Real>& net, Real reach) const;
  void blend_control_rows(const NetView<Real>& net);
  void set_up_limit_columns(const CollapsedEdges& edges);
  EvaluateRow<Real> row_task(int row) const;
  Real regularity_bound(const NetView<Real>& net, double largest_coordinate) const;
  int compute_row(const EvaluateRow<Real>& task, int row, const CollapsedEdges& edges,
                  GridSamples<Real>& samples);
  void compute_limit_row(EvaluateRow<Real> task, int row, int inward, GridSamples<Real>& samples);
  void fill_missing_normals(const NetView<Real>& net, int row, int& allowed,
                            GridSamples<Real>& samples) const;

  const Grid* grid_;
  const EvaluateKernels<Real>* kernels_;
  // Values and derivatives of the basis functions: rows x bandwidth, derivatives scaled by the domain length.
  std::vector<Real> u_values_, u_derivatives_;
  // For each row (column) of samples, sum of the magnitudes of the basis functions' derivatives.
  std::vector<double> u_magnitude_, v_magnitude_;
  DerivativeBound u_bound_, v_bound_;
  int blocks_ = 0;  // number of blocks of columns, including the two limit columns
  std::vector<EvaluateReach> reaches_;
  AlignedVector<Real> v_values_, v_derivatives_;
  AlignedVector<Real> blended_;           // control rows x blocks, blended along v
  AlignedVector<Real> dv_noise_squared_;  // squared rounding error of dv, one for each column of all blocks
  AlignedVector<Real> spare_;             // samples of one row
};

extern template class GridEvaluator<float>;
extern template class GridEvaluator<double>;

}  // namespace spoonbill
