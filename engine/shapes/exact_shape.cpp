#include "engine/shapes/exact_shape.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {

namespace {

// Step of finite differences, as a fraction of the domain. It is far larger than rounding errors and far
// shorter than a knot span.
constexpr double difference_step = 1e-6;
constexpr int newton_steps = 4;
// Largest cosine of the angle between the mean normal at a pole and a tangent at the pole. If a cosine is
// larger, the shape has no tangent plane there.
constexpr double flat_tolerance = 1e-4;

double into_domain(const ShapeDirection& direction, double parameter) {
  if (!direction.periodic) return std::clamp(parameter, direction.start(), direction.end());
  const double period = direction.end() - direction.start();
  const double turns = (parameter - direction.start()) / period;
  return direction.start() + (turns - std::floor(turns)) * period;
}

struct Step {
  double low, high;
};

Step step_about(const ShapeDirection& direction, double parameter) {
  const double step = difference_step * (direction.end() - direction.start());
  if (direction.periodic) return {parameter - step, parameter + step};
  return {std::max(parameter - step, direction.start()), std::min(parameter + step, direction.end())};
}

}  // namespace

ShapeTangents tangents(const ExactShape& shape, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(static_cast<bool>(shape.at));
  const auto at = [&](double a, double b) {
    return shape.at(into_domain(shape.u, a), into_domain(shape.v, b));
  };
  const Step in_u = step_about(shape.u, u), in_v = step_about(shape.v, v);
  ShapeTangents result;
  result.du = (at(in_u.high, v) - at(in_u.low, v)) / (in_u.high - in_u.low);
  result.dv = (at(u, in_v.high) - at(u, in_v.low)) / (in_v.high - in_v.low);
  const Vector3 normal = result.du.cross(result.dv);
  const double length = normal.norm();
  if (length > 1e-6 * result.du.norm() * result.dv.norm()) result.normal = normal / length;
  return result;
}

double distance_near(const ExactShape& shape, const Vector3& point_m, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(static_cast<bool>(shape.at));
  double nearest = (shape.at(u, v) - point_m).norm();
  for (int step = 0; step < newton_steps; ++step) {
    const ShapeTangents at = tangents(shape, u, v);
    const Vector3 residual = point_m - shape.at(into_domain(shape.u, u), into_domain(shape.v, v));
    Eigen::Matrix2d normal_matrix;
    normal_matrix << at.du.dot(at.du), at.du.dot(at.dv), at.du.dot(at.dv), at.dv.dot(at.dv);
    const double determinant = normal_matrix.determinant();
    if (!(determinant > 1e-12 * normal_matrix(0, 0) * normal_matrix(1, 1))) break;
    const Eigen::Vector2d move =
        normal_matrix.inverse() * Eigen::Vector2d(at.du.dot(residual), at.dv.dot(residual));
    u = into_domain(shape.u, u + move.x());
    v = into_domain(shape.v, v + move.y());
    const double distance = (shape.at(u, v) - point_m).norm();
    if (!(distance < nearest)) break;
    nearest = distance;
  }
  return nearest;
}

std::optional<Vector3> pole_normal(const ExactShape& shape, bool at_start) {
  SPOONBILL_ASSERT(at_start ? shape.pole_at_start : shape.pole_at_end);
  constexpr int count = 16;
  std::array<Vector3, count> directions;
  const double v = at_start ? shape.v.start() : shape.v.end();
  Vector3 normal = Vector3::Zero();
  for (int k = 0; k < count; ++k) {
    const double u = shape.u.start() + (shape.u.end() - shape.u.start()) * k / count;
    directions[static_cast<std::size_t>(k)] = tangents(shape, u, v).dv.normalized();
  }
  for (std::size_t k = 0; k < count; ++k) normal += directions[k].cross(directions[(k + 1) % count]);
  normal.normalize();
  for (const Vector3& direction : directions) {
    if (!(std::abs(direction.dot(normal)) < flat_tolerance)) return std::nullopt;
  }
  return normal;
}

namespace {

// Relative tolerance of size checks, because a size converted from millimetres to metres may differ in its
// last digit.
constexpr double slack = 1e-9;

}  // namespace

Status check_length(std::string_view name, double length_m, Range<double> range_m) {
  const Range<double> with_slack{range_m.low * (1.0 - slack), range_m.high * (1.0 + slack)};
  if (with_slack.contains(length_m)) return {};
  return Error{ErrorCode::out_of_range,
               std::string(name) + " is " + length_text(length_m) + ", must be from " +
                   length_text(range_m.low) + " to " + length_text(range_m.high),
               std::string(name)};
}

Status check_size(std::string_view name, double size_m) {
  return check_length(name, size_m, shape_size_range_m);
}

Status check_rounding(std::string_view name, double rounding_m, double side_m, double max_m) {
  return check_length(name, rounding_m, {min_rounding_fraction * side_m, max_m});
}

}  // namespace spoonbill
