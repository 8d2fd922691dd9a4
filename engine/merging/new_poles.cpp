#include "engine/merging/new_poles.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/merging/line_crossing.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {

namespace {

double farthest_m(const Surface& body, const Vector3& middle) {
  double farthest = 0.0;
  for (int i = 0; i < body.net.rows; ++i) {
    for (int j = 0; j < body.net.columns; ++j) {
      farthest = std::max(farthest, (body.net.point(i, j) - middle).norm());
    }
  }
  return farthest;
}

// Unit vectors across a unit one, right-handed with it.
std::pair<Vector3, Vector3> across_of(const Vector3& along) {
  Eigen::Index least = 0;
  along.cwiseAbs().minCoeff(&least);
  const Vector3 first = along.cross(Vector3::Unit(static_cast<int>(least))).normalized();
  return {first, along.cross(first)};
}

}  // namespace

Vector3 middle_of(const Surface& body) {
  const bool along_v = body.u.is_periodic();
  const KnotVector &around = along_v ? body.u : body.v, &along = along_v ? body.v : body.u;
  constexpr int rings = 33, samples = 32;
  Vector3 sum = Vector3::Zero();
  for (const double t : uniform_parameters(along, rings)) {
    for (const double s : uniform_parameters_without_seam(around, samples)) {
      sum += along_v ? position(body, s, t) : position(body, t, s);
    }
  }
  return sum / (rings * samples);
}

Result<FittedShape> with_pole_towards(const Surface& body, const Vector3& direction, double tolerance_m) {
  if (!is_tube(body)) return Error{"a body that is not closed has no poles to place elsewhere"};
  const auto [first, last] = tube_sides(body);
  if (!is_pole(body, first) || !is_pole(body, last)) {
    return Error{"a body with an open end has no pole there to place elsewhere; close it"};
  }
  const Vector3 middle = middle_of(body);
  const double length_m = 1.5 * farthest_m(body, middle);
  const CrossingFinder finder(body);
  const auto [e1, e2] = across_of(direction);
  auto missed = std::make_shared<bool>(false);
  ExactShape shape;
  shape.u = {true, {0.0, 1.0}};
  shape.v = {false, {0.0, 1.0}};
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [=, &finder, e1 = e1, e2 = e2](double u, double v) -> Vector3 {
    const double turn = -2.0 * std::numbers::pi * u, fall = std::numbers::pi * v;
    const Vector3 level = std::cos(turn) * e1 + std::sin(turn) * e2;
    const Vector3 ray = v <= 0.0   ? direction
                        : v >= 1.0 ? Vector3(-direction)
                                   : Vector3(std::cos(fall) * direction + std::sin(fall) * level);
    const auto hits = finder.of_ray(middle, ray, length_m);
    if (hits.size() != 1) *missed = true;
    return hits.empty() ? middle : hits.back().point_m;
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  auto fitted = fit_shape(shape, fit);
  if (*missed) {
    return Error{
        "the body is not seen as a whole from its middle, so that its poles cannot be placed anew; let "
        "the other enter it at a pole"};
  }
  return fitted;
}

}  // namespace spoonbill
