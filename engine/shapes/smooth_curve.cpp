#include "engine/shapes/smooth_curve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Row k of a tridiagonal system for the unknowns x: before * x[k - 1] + here * x[k] + after * x[k + 1] =
// right.
struct TridiagonalRow {
  double before = 0.0, here = 1.0, after = 0.0, right = 0.0;
};

// Solves a tridiagonal system by Gaussian elimination. No pivoting is needed, because the rows of a spline
// are diagonally dominant.
std::vector<double> solve(std::vector<TridiagonalRow> rows) {
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double factor = rows[k].before / rows[k - 1].here;
    rows[k].here -= factor * rows[k - 1].after;
    rows[k].right -= factor * rows[k - 1].right;
  }
  std::vector<double> x(rows.size());
  for (std::size_t k = rows.size(); k-- > 0;) {
    const double beyond = k + 1 < rows.size() ? rows[k].after * x[k + 1] : 0.0;
    x[k] = (rows[k].right - beyond) / rows[k].here;
  }
  return x;
}

// Solves a cyclic tridiagonal system by the formula of Sherman and Morrison (1950). The first row's `before`
// belongs to the last unknown, the last row's `after` to the first.
std::vector<double> solve_cyclic(std::vector<TridiagonalRow> rows) {
  const std::size_t last = rows.size() - 1;
  const double corner = rows.front().before, other = rows[last].after, shift = -rows.front().here;
  rows.front().here -= shift;
  rows[last].here -= corner * other / shift;
  std::vector<TridiagonalRow> unit = rows;
  for (TridiagonalRow& row : unit) row.right = 0.0;
  unit.front().right = shift;
  unit[last].right = other;
  std::vector<double> x = solve(rows);
  const std::vector<double> z = solve(unit);
  const double factor = (x.front() + corner / shift * x[last]) / (1.0 + z.front() + corner / shift * z[last]);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] -= factor * z[k];
  return x;
}

bool is_level(const CurveEnds& ends, int axis) {
  return axis == 0 ? ends.level_x : axis == 1 ? ends.level_y : ends.level_z;
}

// One coordinate of a spline: its values at the points, and the parameter lengths of the pieces between them.
struct SplineLine {
  std::vector<double> values, lengths;

  double slope(std::size_t piece) const {
    return (values[(piece + 1) % values.size()] - values[piece]) / lengths[piece];
  }
  TridiagonalRow inner_row(std::size_t k) const {
    const std::size_t before = (k + lengths.size() - 1) % lengths.size();
    return {lengths[before], 2.0 * (lengths[before] + lengths[k]), lengths[k],
            6.0 * (slope(k) - slope(before))};
  }
};

std::vector<double> compute_second_derivatives(const SplineLine& line, bool closed, bool level_first,
                                               bool level_last) {
  const std::size_t count = line.values.size();
  std::vector<TridiagonalRow> rows(count);
  for (std::size_t k = closed ? 0 : 1; k + (closed ? 0 : 1) < count; ++k) rows[k] = line.inner_row(k);
  if (closed) return solve_cyclic(std::move(rows));
  const std::size_t last = count - 2;  // index of the last piece
  if (level_first) rows[0] = {0.0, 2.0 * line.lengths[0], line.lengths[0], 6.0 * line.slope(0)};
  if (level_last) {
    rows[count - 1] = {line.lengths[last], 2.0 * line.lengths[last], 0.0, -6.0 * line.slope(last)};
  }
  return solve(std::move(rows));
}

}  // namespace

Result<SmoothCurve> SmoothCurve::through(std::vector<Vector3> points_m, bool closed, const CurveEnds& first,
                                         const CurveEnds& last) {
  const std::size_t least = closed ? 3 : 2;
  if (points_m.size() < least) {
    return Error{ErrorCode::too_few, "a curve needs at least " + std::to_string(least) + " points but has " +
                                         std::to_string(points_m.size())};
  }
  double size = 0.0;
  for (const Vector3& point : points_m) size = std::max(size, (point - points_m[0]).norm());
  std::vector<double> parameters = {0.0};
  for (std::size_t k = 0; k + (closed ? 0 : 1) < points_m.size(); ++k) {
    const std::size_t next = (k + 1) % points_m.size();
    const double chord = (points_m[next] - points_m[k]).norm();
    if (!(chord > 1e-9 * size)) {
      return Error{ErrorCode::degenerate, "points " + std::to_string(k + 1) + " and " +
                                              std::to_string(next + 1) + " coincide; remove one of them"};
    }
    parameters.push_back(parameters.back() + chord);
  }
  return at_parameters(std::move(points_m), std::move(parameters), closed, first, last);
}

SmoothCurve SmoothCurve::at_parameters(std::vector<Vector3> points_m, std::vector<double> parameters,
                                       bool closed, const CurveEnds& first, const CurveEnds& last) {
  SPOONBILL_ASSERT(points_m.size() >= 2);
  SPOONBILL_ASSERT(parameters.size() == points_m.size() + (closed ? 1 : 0));
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(parameters.begin(), parameters.end()));
  SmoothCurve curve;
  curve.closed_ = closed;
  curve.second_derivatives_.resize(points_m.size());
  SplineLine line;
  for (std::size_t k = 0; k + 1 < parameters.size(); ++k) {
    line.lengths.push_back(parameters[k + 1] - parameters[k]);
  }
  line.values.resize(points_m.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < points_m.size(); ++k) line.values[k] = points_m[k][axis];
    const auto second = compute_second_derivatives(line, closed, is_level(first, axis), is_level(last, axis));
    for (std::size_t k = 0; k < points_m.size(); ++k) curve.second_derivatives_[k][axis] = second[k];
  }
  curve.points_ = std::move(points_m);
  curve.parameters_ = std::move(parameters);
  return curve;
}

SmoothCurve::Location SmoothCurve::find_piece(double t) const {
  if (closed_) t -= std::floor(t / end()) * end();
  const auto after = std::upper_bound(parameters_.begin() + 1, parameters_.end() - 1, t);
  const std::size_t piece = static_cast<std::size_t>(after - parameters_.begin()) - 1;
  const double length = parameters_[piece + 1] - parameters_[piece];
  return {piece, length, std::clamp((t - parameters_[piece]) / length, 0.0, 1.0)};
}

Vector3 SmoothCurve::at(double t) const {
  SPOONBILL_ASSERT_DEBUG(!parameters_.empty());
  const auto [k, length, b] = find_piece(t);
  const double a = 1.0 - b, scale = length * length / 6.0;
  return a * point(k) + b * point(k + 1) +
         scale * ((a * a * a - a) * second(k) + (b * b * b - b) * second(k + 1));
}

Vector3 SmoothCurve::first_derivative(double t) const {
  SPOONBILL_ASSERT_DEBUG(!parameters_.empty());
  const auto [k, length, b] = find_piece(t);
  const double a = 1.0 - b;
  return (point(k + 1) - point(k)) / length +
         length / 6.0 * ((1.0 - 3.0 * a * a) * second(k) + (3.0 * b * b - 1.0) * second(k + 1));
}

Vector3 SmoothCurve::second_derivative(double t) const {
  SPOONBILL_ASSERT_DEBUG(!parameters_.empty());
  const auto [k, length, b] = find_piece(t);
  return (1.0 - b) * second(k) + b * second(k + 1);
}

}  // namespace spoonbill
