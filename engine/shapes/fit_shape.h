// Fits of B-spline surfaces to exact shapes within a tolerance. The knots of each direction are refined where
// a fit in that direction alone has too large an error. Then both directions are fitted together
// (fit_grid()), and the deviation is measured between the samples. Runs outside the tick; any thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// The knots of one direction while a fit refines them. Cells between the shape's breaks are each divided
// evenly into spans. At a break inside the domain the fit has a continuous tangent, but its curvature may
// jump, as the shape's may. One owner.
class ShapeKnots {
 public:
  // Makes cells of at most 1 / min_spans of the domain. Their lengths grow gradually with the distance from
  // short cells.
  ShapeKnots(const ShapeDirection& direction, int degree, int min_spans);

  // Makes knots for about `control_count` control points, of which some remain for refine_worst(). Ignores
  // the breaks and spaces the knots evenly if the breaks would leave too few control points.
  static Result<ShapeKnots> with_control_count(const ShapeDirection& direction, int degree,
                                               int control_count);

  int control_count() const;
  KnotVector knots() const;
  // Returns evenly spaced parameters, `in_each_span` in each span. They include both ends of an open domain;
  // the seam of a periodic domain occurs once.
  std::vector<double> parameters(int in_each_span) const;

  // Subdivides the cells whose error is above `allowed_m` into as many spans as the degree's order of
  // convergence requires. Returns whether there were such cells.
  bool refine(const std::vector<double>& at, const std::vector<double>& error_m, double allowed_m);
  // Adds a span to the cell with the largest error.
  void refine_worst(const std::vector<double>& at, const std::vector<double>& error_m);

 private:
  // Makes one cell between each pair of successive breaks.
  ShapeKnots(const ShapeDirection& direction, int degree);
  // Splits a cell at a distance `length` from its start or its end.
  void split(std::size_t cell, double length, bool from_start);
  void grade();
  std::vector<double> breakpoints() const;
  std::vector<double> largest_in_cells(const std::vector<double>& at,
                                       const std::vector<double>& error_m) const;
  void even_out();

  bool periodic_;
  int degree_;
  std::vector<double> ends_;  // ends of the cells
  std::vector<bool> jumps_;   // for each end in ends_, true if the curvature may jump there
  std::vector<int> spans_;    // number of spans in each cell
};

struct ShapeFit {
  double tolerance_m = 1e-5;
  int degree = 3;
  // Smallest number of cells in each direction. The default leaves enough control points to sculpt
  // everywhere.
  int min_spans = 12;
  // True if a displacement within the shape also counts as an error. Needed for shapes whose edges must stay
  // where they are.
  bool keeps_parameters = false;
  // Numbers of control points along u and v, which are distributed to where the shape needs them. If given,
  // the tolerance is ignored.
  std::optional<std::array<int, 2>> control_counts = {};
  Progress progress = {};  // can cancel the fit
};

struct FittedShape {
  Surface surface;
  double deviation_m = 0.0;  // largest distance found between a point of the surface and the shape
};

// Fits a surface to a shape. Poles are interpolated, and the surface is smooth at a pole where the shape has
// a tangent plane. Refuses a tolerance that needs more than 200 control points in a direction, a number of
// control points that is too small for the degree, and a shape that is not finite.
Result<FittedShape> fit_shape(const ExactShape& shape, const ShapeFit& fit = {});

}  // namespace spoonbill
