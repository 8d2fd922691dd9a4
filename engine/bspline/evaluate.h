// Evaluation of the points and unit normals of surfaces on whole grids: M = A_u P A_v^T (Eq. 4 of Pungotra et
// al. 2013) with the samples M, the control points P and the blending matrices A_u and A_v.
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

// Samples of a surface on a grid. Each array has rows x columns values, in the order of Grid.
template <class Real>
struct GridSamples {
  std::vector<Real> x, y, z;     // points in metres
  std::vector<Real> nx, ny, nz;  // unit normals; see GridEvaluator for collapsed edges

  void resize(std::size_t count) {
    for (auto* values : {&x, &y, &z, &nx, &ny, &nz}) values->resize(count);
  }
};

// Evaluates surfaces with the knots of one grid. An evaluator owns its working memory, so that each thread
// needs its own, and does not allocate after construction. The grid must outlive it.
//
// A clamped edge whose control points coincide within a millionth of the net's extent counts as collapsed.
// Its normals are the limits from inside the surface. Elsewhere, if du x dv is only rounding noise, the
// normal is computed by unit_normal(). To bound the time, this is done for a limited number of samples in
// each evaluation; further such samples get zero normals.
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
  // For each outermost grid line: the inward direction, +1 or -1, if the line is on a collapsed edge;
  // otherwise 0.
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
  // Values and derivatives of the basis functions along u: rows x bandwidth, the derivatives multiplied by
  // the length of the domain.
  std::vector<Real> u_values_, u_derivatives_;
  // Sum of the magnitudes of the basis functions' derivatives, for each row (u) or column (v) of samples.
  std::vector<double> u_magnitude_, v_magnitude_;
  DerivativeBound u_bound_, v_bound_;
  // Number of blocks of evaluate_block columns. The blocks contain the columns of the grid and two more, in
  // which the normals at collapsed edges are computed.
  int blocks_ = 0;
  std::vector<EvaluateReach> reaches_;
  AlignedVector<Real> v_values_, v_derivatives_;
  AlignedVector<Real> blended_;           // control points blended along v: control rows x blocks
  AlignedVector<Real> dv_noise_squared_;  // squared rounding error of dv in each column
  AlignedVector<Real> spare_;             // samples of one row
};

extern template class GridEvaluator<float>;
extern template class GridEvaluator<double>;

}  // namespace spoonbill
