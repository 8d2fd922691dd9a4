#include "engine/collision/surfaces/pair_polish.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/base/assert.h"
#include "engine/bspline/collapsed_edges.h"

namespace spoonbill {

namespace {

using Matrix2 = Eigen::Matrix2d;

constexpr int max_polish_steps = 40;
constexpr int max_tries = 12;
constexpr double least_damping = 1e-9;
// A smaller decrease of the distance, in metres, counts as rounding error.
constexpr double least_polish_gain_m = 1e-15;
// A step is tried only if the quadratic model predicts that the distance decreases by at least this, in
// metres.
constexpr double least_promise_m = 1e-17;

// Returns true if the parameter is at an end of an open domain and the step would leave the domain.
bool leaves_domain(const KnotVector& knots, double parameter, double step) {
  if (knots.is_periodic()) return false;
  return (step < 0.0 && parameter <= knots.domain_start()) || (step > 0.0 && parameter >= knots.domain_end());
}

// Solves h x = g in place by a Cholesky factorisation in the lower half of h; x replaces g. Returns false if
// h is not positive definite.
template <int size>
bool solve_positive(Eigen::Matrix<double, size, size>& h, Eigen::Matrix<double, size, 1>& g) {
  for (int j = 0; j < size; ++j) {
    for (int k = 0; k < j; ++k) h(j, j) -= h(j, k) * h(j, k);
    if (!(h(j, j) > 0.0)) return false;
    h(j, j) = std::sqrt(h(j, j));
    const double scale = 1.0 / h(j, j);
    for (int i = j + 1; i < size; ++i) {
      for (int k = 0; k < j; ++k) h(i, j) -= h(i, k) * h(j, k);
      h(i, j) *= scale;
    }
    for (int k = 0; k < j; ++k) g[j] -= h(j, k) * g[k];
    g[j] *= scale;
  }
  for (int j = size - 1; j >= 0; --j) {
    for (int k = j + 1; k < size; ++k) g[j] -= h(k, j) * g[k];
    g[j] /= h(j, j);
  }
  return true;
}

// Quadratic model of a minimisation over parameters. Steps are scaled to metres, because the parameters may
// have very different speeds.
template <int size>
struct Problem {
  Eigen::Matrix<double, size, 1> gradient;  // gradient with respect to the parameters
  Eigen::Matrix<double, size, size> curvature;
  Eigen::Matrix<double, size, 1> speed;  // metres on the surface per unit of each parameter
  std::array<const KnotVector*, size> knots;
  Eigen::Matrix<double, size, 1> parameters;
  double least_promise = 0.0;  // smallest decrease that the model must predict, in the unit of the objective

  // Returns the step to the minimum of the quadratic model; NaN if the model is not convex. `damping` has the
  // unit of the curvature.
  Eigen::Matrix<double, size, 1> step(double damping) const {
    auto g = gradient;
    auto h = curvature;
    const double floor = std::max(1e-12 * speed.maxCoeff(), 1e-300);
    const Eigen::Matrix<double, size, 1> scale = speed.cwiseMax(floor).cwiseInverse();
    g = scale.cwiseProduct(g);
    h = scale.asDiagonal() * h * scale.asDiagonal();
    for (int k = 0; k < size; ++k) {
      if (!leaves_domain(*knots[k], parameters[k], -g[k])) continue;
      h.row(k).setZero();
      h.col(k).setZero();
      h(k, k) = 1.0;
      g[k] = 0.0;
    }
    h.diagonal().array() += damping;
    if (!solve_positive(h, g)) return Eigen::Matrix<double, size, 1>::Constant(NAN);
    return -scale.cwiseProduct(g);
  }
};

bool is_spent(const PolishBudget* budget) {
  return budget != nullptr && budget->is_spent();
}

// Makes one Levenberg-Marquardt step that decreases the objective. offer(parameters) returns true if the
// objective decreases there. Returns false if no such step is found.
template <int size, class Offer>
bool descend(const Problem<size>& problem, double& damping, const Offer& offer,
             const PolishBudget* budget = nullptr) {
  for (int tries = 0; tries < max_tries && !is_spent(budget); ++tries) {
    const auto step = problem.step(damping);
    if (step.allFinite()) {
      if (!(-0.5 * problem.gradient.dot(step) > problem.least_promise)) return false;
      Eigen::Matrix<double, size, 1> next = problem.parameters + step;
      for (int k = 0; k < size; ++k) next[k] = problem.knots[k]->into_domain(next[k]);
      if (offer(next)) {
        damping = std::max(least_damping, 0.1 * damping);
        return true;
      }
    }
    damping = std::max(10.0 * damping, 1e-4);
  }
  return false;
}

Matrix2 first_form(const SurfacePoint& at) {
  Matrix2 form;
  form << at.du.squaredNorm(), at.du.dot(at.dv), at.du.dot(at.dv), at.dv.squaredNorm();
  return form;
}

Matrix2 along(const SurfacePoint& at, const Vector3& direction) {
  Matrix2 form;
  form << at.duu.dot(direction), at.duv.dot(direction), at.duv.dot(direction), at.dvv.dot(direction);
  return form;
}

}  // namespace

SurfacePair nearest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from) {
  Problem<4> problem;
  problem.knots = {&first.u->knots(), &first.v->knots(), &second.u->knots(), &second.v->knots()};
  problem.parameters = {problem.knots[0]->into_domain(from.u), problem.knots[1]->into_domain(from.v),
                        problem.knots[2]->into_domain(from.s), problem.knots[3]->into_domain(from.t)};
  const auto evaluate_at = [&](const Eigen::Vector4d& at, SurfacePoint& a, SurfacePoint& b) {
    a = evaluate(first, at[0], at[1]);
    b = evaluate(second, at[2], at[3]);
    return (a.position_m - b.position_m).norm();
  };
  SurfacePoint a, b;
  double distance = evaluate_at(problem.parameters, a, b);
  double damping = least_damping;
  for (int steps = 0; steps < max_polish_steps && distance > least_polish_gain_m; ++steps) {
    const Vector3 difference = a.position_m - b.position_m;
    problem.least_promise = least_promise_m * distance;
    problem.gradient << difference.dot(a.du), difference.dot(a.dv), -difference.dot(b.du),
        -difference.dot(b.dv);
    problem.curvature.topLeftCorner<2, 2>() = first_form(a) + along(a, difference);
    problem.curvature.bottomRightCorner<2, 2>() = first_form(b) - along(b, difference);
    Matrix2 mixed;
    mixed << a.du.dot(b.du), a.du.dot(b.dv), a.dv.dot(b.du), a.dv.dot(b.dv);
    problem.curvature.topRightCorner<2, 2>() = -mixed;
    problem.curvature.bottomLeftCorner<2, 2>() = -mixed.transpose();
    problem.speed << a.du.norm(), a.dv.norm(), b.du.norm(), b.dv.norm();
    const double before = distance;
    const bool moved = descend(problem, damping, [&](const Eigen::Vector4d& next) {
      SurfacePoint next_a, next_b;
      const double next_distance = evaluate_at(next, next_a, next_b);
      if (!(next_distance < distance)) return false;
      problem.parameters = next;
      distance = next_distance;
      a = next_a;
      b = next_b;
      return true;
    });
    if (!moved || !(distance < before - least_polish_gain_m)) break;
  }
  const Eigen::Vector4d& at = problem.parameters;
  return {{at[0], at[1], at[2], at[3]}, a.position_m, b.position_m};
}

namespace {

SurfacePoint evaluate_within(PolishBudget* budget, const PiecewiseSurface& surface, double u, double v) {
  if (budget != nullptr) --budget->evaluations_left;
  return evaluate(surface, u, v);
}

// Searches for the nearest point downhill from u, v. Ends at a pole or beside it if the nearest point is
// beyond.
NearestPoint descend_to_nearest(const PiecewiseSurface& surface, const Vector3& point, double u, double v,
                                PolishBudget* budget) {
  Problem<2> problem;
  problem.knots = {&surface.u->knots(), &surface.v->knots()};
  problem.parameters = {problem.knots[0]->into_domain(u), problem.knots[1]->into_domain(v)};
  SurfacePoint at = evaluate_within(budget, surface, problem.parameters[0], problem.parameters[1]);
  double distance = (at.position_m - point).norm(), damping = least_damping;
  const double least_promise = budget != nullptr ? budget->least_gain_m : least_promise_m;
  for (int steps = 0; steps < max_polish_steps && distance > least_polish_gain_m; ++steps) {
    const Vector3 difference = at.position_m - point;
    problem.least_promise = least_promise * distance;
    problem.gradient << difference.dot(at.du), difference.dot(at.dv);
    problem.curvature = first_form(at) + along(at, difference);
    problem.speed << at.du.norm(), at.dv.norm();
    const double before = distance;
    const auto offer = [&](const Vector2& next) {
      const SurfacePoint there = evaluate_within(budget, surface, next[0], next[1]);
      const double next_distance = (there.position_m - point).norm();
      if (!(next_distance < distance)) return false;
      problem.parameters = next;
      distance = next_distance;
      at = there;
      return true;
    };
    const bool moved = descend(problem, damping, offer, budget);
    if (!moved || !(distance < before - least_polish_gain_m)) break;
  }
  return {problem.parameters[0], problem.parameters[1], at};
}

// Sine of an angle that is far above the error of a search that has converged, and the error of positions.
constexpr double oblique_sine = 1e-3, position_error_m = 1e-9;

// Returns true if the vector from the point found to `point` is not perpendicular to the surface. The search
// has then ended early, at a crease, or on the border of the surface.
bool is_oblique(const PiecewiseSurface& surface, const NearestPoint& found, const Vector3& point) {
  const Vector3 difference = found.at.position_m - point;
  const double most_m = oblique_sine * difference.norm() + position_error_m;
  // On an edge that is a pole, one of the tangents is only a rounding error.
  if (is_on_edge(surface, found.u, found.v)) {
    return difference.cross(unit_normal(surface, found.at, found.u, found.v)).norm() > most_m;
  }
  return std::abs(difference.dot(found.at.du)) > most_m * found.at.du.norm() ||
         std::abs(difference.dot(found.at.dv)) > most_m * found.at.dv.norm();
}

// An end of a direction of a surface.
struct SurfaceEnd {
  bool of_u, at_end;
};

// Returns the point at an end of one direction, at a fraction of the domain of the other.
SurfacePoint evaluate_end(const PiecewiseSurface& surface, const SurfaceEnd& side, double fraction,
                          PolishBudget* budget) {
  const KnotVector &u = surface.u->knots(), &v = surface.v->knots();
  const double end = side.at_end ? 1.0 : 0.0;
  return evaluate_within(budget, surface, u.parameter_at(side.of_u ? end : fraction),
                         v.parameter_at(side.of_u ? fraction : end));
}

double domain_length(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

// Returns the end whose edge is the pole nearest to `from_m`; nothing if the surface has no pole.
std::optional<SurfaceEnd> find_nearest_pole(const PiecewiseSurface& surface, const Vector3& from_m) {
  const ControlNet& net = surface.surface->net;
  std::optional<SurfaceEnd> nearest;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const SurfaceEnd& side : {SurfaceEnd{false, false}, {false, true}, {true, false}, {true, true}}) {
    const NetEdge edge = find_edge(net, side.of_u, side.at_end);
    const Vector3 corner_m(net.x[edge.first], net.y[edge.first], net.z[edge.first]);
    const double distance_m = (corner_m - from_m).norm();
    const KnotVector& knots = side.of_u ? surface.surface->u : surface.surface->v;
    if (!(distance_m < nearest_m) || !knots.is_clamped(side.at_end) || !is_collapsed(net, edge)) continue;
    nearest = side;
    nearest_m = distance_m;
  }
  return nearest;
}

// Number of directions from a pole that are tried.
constexpr int pole_directions = 8;
// Largest distance of a start from a pole, in domain lengths.
constexpr double largest_pole_distance = 0.25;

// Sets u and v to a start of a search beside the pole at this end, in the direction from the pole to `point`.
// Returns false if no direction leads nearer to `point`.
bool start_beside_pole(const PiecewiseSurface& surface, const Vector3& point, const SurfaceEnd& side,
                       PolishBudget* budget, double& u, double& v) {
  double best_m = 0.0, best_fraction = 0.0, best_step = 0.0;
  for (int k = 0; k < pole_directions && !is_spent(budget); ++k) {
    const double fraction = (k + 0.5) / pole_directions;
    const SurfacePoint pole = evaluate_end(surface, side, fraction, budget);
    const Vector3 leaving = (side.at_end ? -1.0 : 1.0) * (side.of_u ? pole.du : pole.dv);
    const double speed = leaving.norm(),
                 reached_m = speed > 0.0 ? (point - pole.position_m).dot(leaving) / speed : 0.0;
    if (!(reached_m > best_m)) continue;
    best_m = reached_m;
    best_fraction = fraction;
    best_step = reached_m / speed;
  }
  if (!(best_m > 0.0)) return false;
  const KnotVector &u_knots = surface.u->knots(), &v_knots = surface.v->knots();
  const double most = largest_pole_distance * domain_length(side.of_u ? u_knots : v_knots);
  const double step = (side.at_end ? -1.0 : 1.0) * std::min(best_step, most), end = side.at_end ? 1.0 : 0.0;
  u = side.of_u ? u_knots.parameter_at(end) + step : u_knots.parameter_at(best_fraction);
  v = side.of_u ? v_knots.parameter_at(best_fraction) : v_knots.parameter_at(end) + step;
  return true;
}

}  // namespace

NearestPoint nearest_point(const PiecewiseSurface& surface, const Vector3& point, double u, double v,
                           PolishBudget* budget) {
  const NearestPoint found = descend_to_nearest(surface, point, u, v, budget);
  if (is_spent(budget) || !is_oblique(surface, found, point)) return found;
  const std::optional<SurfaceEnd> pole = find_nearest_pole(surface, found.at.position_m);
  if (!pole || !start_beside_pole(surface, point, *pole, budget, u, v)) return found;
  const NearestPoint beyond = descend_to_nearest(surface, point, u, v, budget);
  const bool is_nearer =
      (beyond.at.position_m - point).squaredNorm() < (found.at.position_m - point).squaredNorm();
  return is_nearer ? beyond : found;
}

namespace {

// A point of the first surface, the point of the second surface nearest to it, and the depth of the first
// point behind the second surface.
struct DepthPoint {
  PairParameters at;
  SurfacePoint a, b;
  Vector3 normal;
  double depth;
};

DepthPoint evaluate_depth(const PiecewiseSurface& first, const PiecewiseSurface& second,
                          const PairParameters& from, double outside, PolishBudget* budget = nullptr) {
  DepthPoint result;
  result.a = evaluate(first, from.u, from.v);
  const NearestPoint nearest = nearest_point(second, result.a.position_m, from.s, from.t, budget);
  result.at = {from.u, from.v, nearest.u, nearest.v};
  result.b = nearest.at;
  result.normal = outside * unit_normal(second, nearest.at, nearest.u, nearest.v);
  const Vector3 difference = result.a.position_m - nearest.at.position_m;
  const double height = difference.dot(result.normal);
  // Beyond an edge of the second surface the difference is oblique, and the point is not behind the surface.
  const bool is_beyond =
      is_on_edge(second, nearest.u, nearest.v) && is_oblique(second, nearest, result.a.position_m);
  // If the search for the nearest point has ended early, the distance could be far more than the depth.
  result.depth = height < 0.0 && !is_beyond ? -height : -difference.norm();
  return result;
}

// Returns the Hessian of the signed distance, see deepest_pair().
Matrix2 distance_curvature(const DepthPoint& at) {
  const Matrix2 first = first_form(at.b), second = along(at.b, at.normal);
  Matrix2 motion;  // one column for du and one for dv of the first surface
  motion << at.a.du.dot(at.b.du), at.a.dv.dot(at.b.du), at.a.du.dot(at.b.dv), at.a.dv.dot(at.b.dv);
  const double distance = -at.depth;
  const Matrix2 follows = (first - distance * second).inverse() * motion;
  return -motion.transpose() * first.inverse() * second * follows;
}

}  // namespace

double depth_behind(const PiecewiseSurface& first, const PiecewiseSurface& second, const PairParameters& from,
                    double outside) {
  SPOONBILL_ASSERT_DEBUG(std::abs(outside) == 1.0);
  return evaluate_depth(first, second, from, outside).depth;
}

DeepestPair deepest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from,
                         double outside, double enough_m, PolishBudget* budget) {
  SPOONBILL_ASSERT_DEBUG(std::abs(outside) == 1.0);
  DepthPoint best = evaluate_depth(first, second, from, outside, budget);
  Problem<2> problem;
  problem.knots = {&first.u->knots(), &first.v->knots()};
  problem.least_promise = budget != nullptr ? budget->least_gain_m : least_promise_m;
  double damping = least_damping;
  for (int steps = 0; steps < max_polish_steps && !(best.depth > enough_m); ++steps) {
    problem.parameters = {best.at.u, best.at.v};
    problem.gradient << best.a.du.dot(best.normal), best.a.dv.dot(best.normal);
    problem.curvature = along(best.a, best.normal) + distance_curvature(best);
    problem.speed << best.a.du.norm(), best.a.dv.norm();
    const double before = best.depth;
    const auto offer = [&](const Vector2& next) {
      const DepthPoint there =
          evaluate_depth(first, second, {next[0], next[1], best.at.s, best.at.t}, outside, budget);
      if (!(there.depth > best.depth)) return false;
      best = there;
      return true;
    };
    const bool moved = descend(problem, damping, offer, budget);
    if (!moved || !(best.depth > before + least_polish_gain_m)) break;
  }
  return {{best.at, best.a.position_m, best.b.position_m}, best.normal, best.depth};
}

}  // namespace spoonbill
