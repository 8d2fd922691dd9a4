#include "engine/collision/surfaces/pair_polish.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/assert.h"

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

// Searches for the nearest point downhill from u, v. Ends at a pole if the nearest point is beyond it.
NearestPoint descend_to_nearest(const PiecewiseSurface& surface, const Vector3& point, double u, double v,
                                PolishBudget* budget) {
  Problem<2> problem;
  problem.knots = {&surface.u->knots(), &surface.v->knots()};
  problem.parameters = {problem.knots[0]->into_domain(u), problem.knots[1]->into_domain(v)};
  SurfacePoint at = evaluate_within(budget, surface, problem.parameters[0], problem.parameters[1]);
  double distance = (at.position_m - point).norm(), damping = least_damping;
  for (int steps = 0; steps < max_polish_steps && distance > least_polish_gain_m; ++steps) {
    const Vector3 difference = at.position_m - point;
    problem.least_promise = least_promise_m * distance;
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

// Returns true if the vector from `point` to the surface is not perpendicular to the surface, so that another
// point of the surface is nearer, unless the point found is on the border.
bool is_oblique(const PiecewiseSurface& surface, const NearestPoint& found, const Vector3& point) {
  const Vector3 difference = found.at.position_m - point;
  const double most = oblique_sine * difference.norm() + position_error_m;
  if (!is_on_edge(surface, found.u, found.v)) {
    return std::abs(difference.dot(found.at.du)) > most * found.at.du.norm() ||
           std::abs(difference.dot(found.at.dv)) > most * found.at.dv.norm();
  }
  return difference.cross(unit_normal(surface, found.at, found.u, found.v)).norm() > most;
}

// Number of directions from a pole that are tried.
constexpr int pole_directions = 8;
// Largest distance of a start from a pole, in domain lengths.
constexpr double largest_pole_distance = 0.25;
// An edge is a pole if its length is below this fraction of the distance to the opposite edge, both estimated
// from the tangents at a point of the edge. Rounding to single precision makes the fraction about 1e-6.
constexpr double pole_fraction = 1e-4;

// Sets u and v to a start of a search: beside the pole at one end of u (if `of_u`) or of v, in the direction
// from the pole to `point`. Returns false if this end is no pole or no direction leads nearer to `point`.
bool start_beside_pole(const PiecewiseSurface& surface, const Vector3& point, bool of_u, bool at_end,
                       PolishBudget* budget, double& u, double& v) {
  const KnotVector &outward = of_u ? surface.u->knots() : surface.v->knots(),
                   &around = of_u ? surface.v->knots() : surface.u->knots();
  if (outward.is_periodic()) return false;
  const double end = at_end ? outward.domain_end() : outward.domain_start(), inward = at_end ? -1.0 : 1.0;
  const double length = outward.domain_end() - outward.domain_start(),
               around_length = around.domain_end() - around.domain_start();
  double best = 0.0, best_around = 0.0, best_step = 0.0;
  for (int k = 0; k < pole_directions; ++k) {
    const double angle = around.parameter_at((k + 0.5) / pole_directions);
    const SurfacePoint pole = evaluate_within(budget, surface, of_u ? end : angle, of_u ? angle : end);
    const Vector3 leaving = inward * (of_u ? pole.du : pole.dv), wanted = point - pole.position_m;
    const double speed = leaving.norm(), edge_m = around_length * (of_u ? pole.dv : pole.du).norm();
    if (!(edge_m < pole_fraction * length * speed)) return false;
    const double reached = wanted.dot(leaving) / speed;
    if (!(reached > best)) continue;
    best = reached;
    best_around = angle;
    best_step = reached / speed;
  }
  if (!(best > 0.0)) return false;
  const double start = end + inward * std::min(best_step, largest_pole_distance * length);
  u = of_u ? start : best_around;
  v = of_u ? best_around : start;
  return true;
}

}  // namespace

NearestPoint nearest_point(const PiecewiseSurface& surface, const Vector3& point, double u, double v,
                           PolishBudget* budget) {
  NearestPoint found = descend_to_nearest(surface, point, u, v, budget);
  if (!is_oblique(surface, found, point)) return found;
  for (const bool of_u : {true, false}) {
    for (const bool at_end : {false, true}) {
      if (is_spent(budget) || !start_beside_pole(surface, point, of_u, at_end, budget, u, v)) continue;
      const NearestPoint beyond = descend_to_nearest(surface, point, u, v, budget);
      const bool is_nearer =
          (beyond.at.position_m - point).squaredNorm() < (found.at.position_m - point).squaredNorm();
      if (is_nearer) found = beyond;
    }
  }
  return found;
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
  // If the search for the nearest point has stopped early, the distance could be far more than the depth.
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
  problem.least_promise = least_promise_m;
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
