// A grid: the blending matrices of one knot structure and one sampling, shared by every surface that has that
// structure. Built once, outside the tick; immutable afterwards, so that any thread may read it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// One direction of a grid.
struct GridDirection {
  KnotVector knots;
  std::vector<double> parameters;  // strictly increasing, in the domain
  BlendingMatrix values;
  BlendingMatrix first_derivatives;
  BlendingMatrix second_derivatives;
};

// u runs over rows, v over columns: sample (i, j) lies at index i * v.parameters.size() + j.
struct Grid {
  GridDirection u;
  GridDirection v;

  int rows() const { return static_cast<int>(u.parameters.size()); }
  int columns() const { return static_cast<int>(v.parameters.size()); }
};

// Any strictly increasing parameters in the domain. Refused: fewer than two, decreasing or non-finite ones.
Result<Grid> make_grid(const KnotVector& u, const KnotVector& v, std::vector<double> u_parameters,
                       std::vector<double> v_parameters);

// `count` parameters evenly spaced over the domain, both ends included, the seam of a periodic direction
// therefore twice.
std::vector<double> uniform_parameters(const KnotVector& knots, int count);

// `count` parameters evenly spaced over one period without repeating the seam.
std::vector<double> uniform_parameters_without_seam(const KnotVector& knots, int count);

// Parameters for a grid with nested levels: each polynomial piece is cut into pieces_per_span * 2^levels
// equal parts, both domain ends included. Level l (0 = coarsest) is every 2^(levels - l)-th of them, so that
// the blending matrices of a coarse level are rows of the finest, and no cell holds a knot inside.
struct NestedParameters {
  int levels = 0;
  std::vector<double> parameters;

  int stride(int level) const { return 1 << (levels - level); }
  int count(int level) const { return (static_cast<int>(parameters.size()) - 1) / stride(level) + 1; }
};
NestedParameters nested_parameters(const KnotVector& knots, int pieces_per_span, int levels);

}  // namespace spoonbill
