#include "engine/simulation/skin_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Elements are cut into 2 to the power of it.
constexpr int height_levels = 2;
constexpr double infinite = std::numeric_limits<double>::infinity();

// How much lower than its middle a parabola through three points is between them.
double dip(double before, double middle, double after, double step_before, double step_after) {
  const double rise_before = (middle - before) / step_before, rise_after = (after - middle) / step_after;
  const double steps = step_before + step_after;
  const double slope = (step_after * rise_before + step_before * rise_after) / steps;
  const double curvature = 2.0 * (rise_after - rise_before) / steps;
  if (!(curvature > 0.0) || !std::isfinite(curvature)) return 0.0;
  const double way = -slope / curvature;
  if (way < -step_before || way > step_after) return 0.0;
  return 0.5 * slope * slope / curvature;
}

}  // namespace

Result<SkinHeights> SkinHeights::make(const KnotVector& u, const KnotVector& v) {
  Result<NestedGrid> nested = make_nested_grid(u, v, height_levels);
  if (!nested.ok()) return nested.error();
  return SkinHeights(std::move(nested).value());
}

SkinHeights::SkinHeights(NestedGrid nested) : nested_(std::move(nested)) {
  const auto along_u = static_cast<std::size_t>(nested_.grid.u.values.columns);
  const auto along_v = static_cast<std::size_t>(nested_.grid.v.values.columns);
  control_.assign(along_u * along_v, 0.0);
  blended_.assign(along_v, 0.0);
  height_.assign(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(columns()), infinite);
}

bool SkinHeights::take(const Surface& surface, const Vector3& point_m, const Vector3& normal,
                       double reach_m) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  const ControlNet& net = surface.net;
  double lowest = infinite;
  for (std::size_t p = 0; p < control_.size(); ++p) {
    control_[p] = normal.dot(Vector3(net.x[p], net.y[p], net.z[p]) - point_m);
    lowest = std::min(lowest, control_[p]);
  }
  // The skin lies within the hull of its control points.
  if (lowest > reach_m) return false;
  bool any = false;
  for (int row = 0; row < rows(); ++row) any |= take_row(row, reach_m);
  return any;
}

bool SkinHeights::take_row(int row, double reach_m) {
  const BlendingMatrix &along_u = nested_.grid.u.values, &along_v = nested_.grid.v.values;
  const auto blend = [](const BlendingMatrix& matrix, int at, const auto& of) {
    double sum = 0.0;
    for (int k = 0; k < matrix.bandwidth; ++k) {
      sum += matrix.values[static_cast<std::size_t>(at * matrix.bandwidth + k)] * of(matrix.column(at, k));
    }
    return sum;
  };
  double lowest = infinite;
  for (int c = 0; c < along_v.columns; ++c) {
    double& here = blended_[static_cast<std::size_t>(c)];
    here = blend(along_u, row,
                 [&](int r) { return control_[static_cast<std::size_t>(r * along_v.columns + c)]; });
    lowest = std::min(lowest, here);
  }
  double* const heights = height_.data() + static_cast<std::ptrdiff_t>(row) * columns();
  if (lowest > reach_m) {
    std::fill_n(heights, columns(), infinite);
    return false;
  }
  for (int j = 0; j < columns(); ++j) {
    heights[j] = blend(along_v, j, [&](int c) { return blended_[static_cast<std::size_t>(c)]; });
  }
  return true;
}

double SkinHeights::dip_along_u(int row, int column) const {
  const GridDirection& along = nested_.grid.u;
  const int last = rows() - 1;
  const bool closed = along.knots.is_periodic();
  if (!closed && (row == 0 || row == last)) return 0.0;
  // Over a seam, where the first and the last row are one.
  const int before = row == 0 ? last - 1 : row - 1, after = row == last ? 1 : row + 1;
  const int end = row == 0 ? last : row, start = row == last ? 0 : row;
  return dip(height(before, column), height(row, column), height(after, column), u(end) - u(before),
             u(after) - u(start));
}

double SkinHeights::dip_along_v(int row, int column) const {
  const GridDirection& along = nested_.grid.v;
  const int last = columns() - 1;
  const bool closed = along.knots.is_periodic();
  if (!closed && (column == 0 || column == last)) return 0.0;
  const int before = column == 0 ? last - 1 : column - 1, after = column == last ? 1 : column + 1;
  const int end = column == 0 ? last : column, start = column == last ? 0 : column;
  return dip(height(row, before), height(row, column), height(row, after), v(end) - v(before),
             v(after) - v(start));
}

double SkinHeights::lowest_m(int row, int column) const {
  SPOONBILL_ASSERT_DEBUG(row >= 0 && row < rows() && column >= 0 && column < columns());
  const double here = height(row, column);
  if (here == infinite) return here;
  return here - dip_along_u(row, column) - dip_along_v(row, column);
}

}  // namespace spoonbill
