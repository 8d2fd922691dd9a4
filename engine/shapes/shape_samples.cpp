#include "engine/shapes/shape_samples.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Of the domain: far above the rounding of a difference, far below a knot span.
constexpr double difference_step = 1e-6;
constexpr int newton_steps = 4;
// Cosines: how far the directions at a pole may lie out of one plane.
constexpr double flat_tolerance = 1e-4;

double brought_into(const ShapeDirection& direction, double parameter) {
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
    return shape.at(brought_into(shape.u, a), brought_into(shape.v, b));
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
    const Vector3 residual = point_m - shape.at(brought_into(shape.u, u), brought_into(shape.v, v));
    Eigen::Matrix2d normal_matrix;
    normal_matrix << at.du.dot(at.du), at.du.dot(at.dv), at.du.dot(at.dv), at.dv.dot(at.dv);
    const double determinant = normal_matrix.determinant();
    if (!(determinant > 1e-12 * normal_matrix(0, 0) * normal_matrix(1, 1))) break;
    const Eigen::Vector2d move =
        normal_matrix.inverse() * Eigen::Vector2d(at.du.dot(residual), at.dv.dot(residual));
    u = brought_into(shape.u, u + move.x());
    v = brought_into(shape.v, v + move.y());
    const double distance = (shape.at(u, v) - point_m).norm();
    if (!(distance < nearest)) break;
    nearest = distance;
  }
  return nearest;
}

std::optional<Vector3> pole_normal(const ExactShape& shape, bool at_start) {
  SPOONBILL_ASSERT(at_start ? shape.pole_at_start : shape.pole_at_end);
  constexpr int directions = 16;
  std::array<Vector3, directions> ways;
  const double v = at_start ? shape.v.start() : shape.v.end();
  Vector3 normal = Vector3::Zero();
  for (int k = 0; k < directions; ++k) {
    const double u = shape.u.start() + (shape.u.end() - shape.u.start()) * k / directions;
    ways[static_cast<std::size_t>(k)] = tangents(shape, u, v).dv.normalized();
  }
  for (std::size_t k = 0; k < directions; ++k) normal += ways[k].cross(ways[(k + 1) % directions]);
  normal.normalize();
  for (const Vector3& way : ways) {
    if (!(std::abs(way.dot(normal)) < flat_tolerance)) return std::nullopt;
  }
  return normal;
}

}  // namespace spoonbill
