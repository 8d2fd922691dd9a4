// Grids of samples on surfaces, and least-squares fits of surfaces to points and displacements on grids. A
// grid holds the blending matrices for its knots and parameters; all surfaces with these knots share it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/containers.h"
#include "engine/base/geometry.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// One direction of a grid. Immutable once made, so that any thread may read it. Its construction is too slow
// for a tick.
struct GridDirection {
  KnotVector knots;
  std::vector<double> parameters;  // parameters of the samples: strictly increasing, in the domain
  BlendingMatrix values;
  BlendingMatrix first_derivatives;
  BlendingMatrix second_derivatives;

  // Returns the number of cells; each cell is between two neighbouring parameters.
  int cell_count() const { return static_cast<int>(parameters.size()) - 1; }
  // Returns the index of the cell that contains the parameter. For a parameter outside the sampled range,
  // returns the index of the nearest cell.
  int find_cell(double parameter) const;
  // Returns the index of a cell, wrapped across the seam of a periodic direction; returns -1 beyond an open
  // end.
  int wrap_cell(int i) const;
};

// A grid of samples: u runs over rows, v over columns, and sample (i, j) has the index i *
// v.parameters.size() + j.
struct Grid {
  GridDirection u;
  GridDirection v;

  int rows() const { return static_cast<int>(u.parameters.size()); }
  int columns() const { return static_cast<int>(v.parameters.size()); }
};

// Makes a grid from strictly increasing parameters in the domain. Refuses fewer than two parameters, and
// parameters that do not increase or are outside the domain.
Result<Grid> make_grid(const KnotVector& u, const KnotVector& v, std::vector<double> u_parameters,
                       std::vector<double> v_parameters);

// Returns `count` parameters evenly spaced over the domain, both ends included; in a periodic direction the
// seam occurs twice.
std::vector<double> uniform_parameters(const KnotVector& knots, int count);

// Returns `count` parameters evenly spaced over one period, with the seam only once.
std::vector<double> uniform_parameters_without_seam(const KnotVector& knots, int count);

// Parameters of a grid with nested levels. They divide each polynomial piece into pieces_per_span * 2^levels
// equal parts and include both ends of the domain. Level l (0 = coarsest) has every 2^(levels - l)-th
// parameter. No cell of any level has a knot inside. The blending matrices of a coarse level consist of rows
// of the finest level's matrices.
struct NestedParameters {
  int levels = 0;
  std::vector<double> parameters;

  int stride(int level) const { return 1 << (levels - level); }
  int count(int level) const { return (static_cast<int>(parameters.size()) - 1) / stride(level) + 1; }
};
NestedParameters nested_parameters(const KnotVector& knots, int pieces_per_span, int levels);

// Points at the parameters u[i], v[j], with the index i * v.size() + j. The parameters must increase strictly
// within the domain. A fit to the points (fit_grid()) is well conditioned if there are at least twice as many
// parameters as control points in each direction.
struct PointGrid {
  std::vector<double> u, v;
  std::vector<Vector3> points_m;
};

// Ends of the domain at which a surface interpolates the points instead of fitting them. Such an end must be
// clamped, and the first or last parameter must be exactly there.
struct InterpolatedEnds {
  bool u_first = false, u_last = false, v_first = false, v_last = false;
};

// Returns the surface with the least sum of squared distances from the points at their parameters: P = A_u^+
// M (A_v^+)^T for the points M (Eq. 5 of Pungotra et al. 2013, but without inverting A^T A, which squares the
// condition number). Refuses a number of points that differs from the number of parameter pairs, non-finite
// points, and parameters that do not determine the control points.
Result<Surface> fit_grid(const KnotVector& u, const KnotVector& v, const PointGrid& points,
                         const InterpolatedEnds& interpolated = {});

// Returns the surface's points at all pairs of the parameters u and v.
PointGrid sample_grid_points(const Surface& surface, std::vector<double> u, std::vector<double> v);

// Returns the largest distance in metres between a point of the grid and the surface at its parameters.
double largest_deviation_m(const Surface& surface, const PointGrid& points);

// Searches for the largest value of a function of two parameters near the sample (u, v). Returns this value,
// which is never less than the value at the sample. `step_u` and `step_v` are the distances between samples.
// The search starts with steps of half these distances and halves them repeatedly. `value` must accept
// parameters up to these distances outside the sampled range.
template <class Value>
double find_peak(const Value& value, double u, double v, double step_u, double step_v) {
  SPOONBILL_ASSERT(step_u >= 0.0 && step_v >= 0.0);
  constexpr int halvings = 10;
  constexpr std::array<std::array<int, 2>, 4> directions{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  double largest = value(u, v);
  for (int k = 0; k < halvings; ++k) {
    step_u *= 0.5;
    step_v *= 0.5;
    for (const auto& [along_u, along_v] : directions) {
      const double at_u = u + along_u * step_u, at_v = v + along_v * step_v;
      const double there = value(at_u, at_v);
      if (there <= largest) continue;
      largest = there;
      u = at_u;
      v = at_v;
    }
  }
  return largest;
}

// Computes the displacements dP of control points from the displacements dM of grid samples: dP = A_u^+ dM
// (A_v^+)^T. A surface whose samples do not move stays unchanged to the last bit, whereas a fit of the
// positions (Eq. 5 of Pungotra et al. 2013) would smooth it. Owns both pseudo-inverses in single precision
// and the working memory; does not allocate after make(). For use by one thread.
class DisplacementRefit {
 public:
  // Makes a refit without constraints. Refuses a grid whose samples do not determine the control points (see
  // pseudo_inverse()).
  static Result<DisplacementRefit> make(const Grid& grid, InstructionSet set);

  // Makes a refit under constraints on the columns of control points. The columns that are neither fixed nor
  // interpolated fit the samples by least squares.
  static Result<DisplacementRefit> make(const Grid& grid, const RefitConstraints& constraints,
                                        InstructionSet set);

  int sample_rows() const { return sample_rows_; }
  int sample_columns() const { return sample_columns_; }

  // Returns the number of values in memory for a row of samples; values past grid.columns() have no effect.
  int sample_stride() const { return sample_stride_; }

  // Computes the displacements of the control points (rows x columns) from those of the samples. `sample`
  // holds grid.rows() x sample_stride() displacements of one coordinate in metres and must be aligned to 64
  // bytes. Exactly zero input gives exactly zero output.
  void control_displacement(const float* sample, float* control);

 private:
  DisplacementRefit() = default;

  InstructionSet set_{};
  int sample_rows_ = 0, sample_columns_ = 0, sample_stride_ = 0;
  int control_rows_ = 0, control_columns_ = 0, control_stride_ = 0;
  std::vector<float> u_inverse_;  // pseudo-inverse along u: control_rows x sample_rows
  // Transposed pseudo-inverse along v: sample_stride x control_stride, zero-padded.
  AlignedVector<float> v_inverse_transposed_;
  AlignedVector<float> half_;  // u_inverse_ times samples: control_rows x sample_stride
  // Result before its padding is removed: control_rows x control_stride.
  AlignedVector<float> padded_control_;
};

}  // namespace spoonbill
