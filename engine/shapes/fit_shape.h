// Fits of B-spline surfaces to exact shapes within a tolerance. First each direction is fitted alone, and its
// knots are refined where the error is too large. Then both directions are fitted together (fit_grid()), and
// the deviation is measured between the samples. A fit may run on any thread and is too slow for a tick.
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

// The knots of one direction while a fit refines them. The intervals between the shape's breaks
// (ShapeDirection) are divided into cells, and each cell evenly into knot spans. At a break inside the domain
// the fitted surface has a continuous tangent, but its curvature may jump, because the curvature of the shape
// may jump too. One owner.
class ShapeKnots {
 public:
  // Makes cells no longer than the domain divided by `min_spans`. The lengths of the cells grow gradually
  // with the distance from a short cell.
  ShapeKnots(const ShapeDirection& direction, int degree, int min_spans);

  // Makes knots for at most `control_count` control points. Some control points may be reserved for
  // refine_worst(), which adds them. If the breaks would need too many control points, ignores the breaks and
  // spaces the knots evenly.
  static Result<ShapeKnots> with_control_count(const ShapeDirection& direction, int degree,
                                               int control_count);

  int control_count() const;
  KnotVector knots() const;
  // Returns parameters, of which `in_each_span` are evenly spaced in each span. They include both ends of an
  // open domain; the seam of a periodic domain occurs once.
  std::vector<double> parameters(int in_each_span) const;

  // Divides the cells whose error is above `allowed_m` into more spans. The number of spans follows from the
  // order of convergence, degree + 1. Cells with a much smaller error than the worst cell must wait for a
  // later call. `at` are the parameters of the errors. Returns true if an error is above `allowed_m`.
  bool refine(const std::vector<double>& at, const std::vector<double>& error_m, double allowed_m);
  // Adds a span to the cell with the largest error.
  void refine_worst(const std::vector<double>& at, const std::vector<double>& error_m);

 private:
  // Makes one cell between each pair of successive breaks.
  ShapeKnots(const ShapeDirection& direction, int degree);
  // Splits a cell at the distance `length` from its start (`from_start`) or from its end.
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
  // Smallest number of knot spans in each direction. The default gives enough control points to sculpt
  // everywhere.
  int min_spans = 12;
  // True if the surface must match the shape at equal parameters, so that a displacement along the shape also
  // counts as an error. Needed for shapes whose edges must stay where they are.
  bool keeps_parameters = false;
  // Numbers of control points along u and v, which are placed where the shape needs them. If given,
  // `tolerance_m` and `min_spans` are ignored.
  std::optional<std::array<int, 2>> control_counts = {};
  Progress progress = {};  // can cancel the fit
};

struct FittedShape {
  Surface surface;
  double deviation_m = 0.0;  // largest distance found between a point of the surface and the shape
};

// Fits a surface to a shape. Poles are interpolated, and the surface is smooth at a pole if the shape has a
// tangent plane there. Refuses a tolerance that needs more than 200 control points in a direction, a number
// of control points that is too small for the degree or for a surface without folds, and a shape that is not
// finite.
Result<FittedShape> fit_shape(const ExactShape& shape, const ShapeFit& fit = {});

}  // namespace spoonbill
