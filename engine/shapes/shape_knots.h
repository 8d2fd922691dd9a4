// The knots of one direction of a shape's fit: cells between the shape's breaks, each cut evenly. At a break
// inside the domain, knots are such that the fit is as smooth as the shape: its tangents go on, its curvature
// may jump.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// One owner.
class ShapeKnots {
 public:
  // Every cell is at most a `least_spans`-th of the domain, and they grow step by step away from short ones.
  ShapeKnots(const ShapeDirection& direction, int degree, int least_spans);

  // So many control points in all; even knots where the breaks alone would ask for more.
  static Result<ShapeKnots> counted(const ShapeDirection& direction, int degree, int control_count);

  int control_count() const;
  KnotVector knots() const;
  // So many parameters in each span, the ends of the domain among them, the seam once.
  std::vector<double> parameters(int in_each_span) const;

  // Cuts the cells finer in which the error at a parameter is more than allowed, by the degree's order of
  // convergence. Whether any was.
  bool refine(const std::vector<double>& at, const std::vector<double>& error_m, double allowed_m);
  // Cuts the cell with the largest error once more.
  void refine_worst(const std::vector<double>& at, const std::vector<double>& error_m);

 private:
  // A cell from each break to the next.
  ShapeKnots(const ShapeDirection& direction, int degree);
  // One more end within a cell, which begins it or ends it by so much.
  void split(std::size_t cell, double length, bool from_start);
  void grade();
  std::vector<double> breakpoints() const;
  std::vector<double> largest_in_cells(const std::vector<double>& at,
                                       const std::vector<double>& error_m) const;
  void even_out();

  bool periodic_;
  int degree_;
  std::vector<double> ends_;  // of the cells
  std::vector<bool> jumps_;   // whether the curvature may jump at an end
  std::vector<int> spans_;    // in each cell
};

}  // namespace spoonbill
