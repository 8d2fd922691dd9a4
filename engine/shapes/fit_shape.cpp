#include "engine/shapes/fit_shape.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid_fit.h"
#include "engine/bspline/peak_search.h"
#include "engine/shapes/shape_knots.h"
#include "engine/shapes/shape_samples.h"

namespace spoonbill {

namespace {

constexpr int most_control_points = 200;
// Twice the unknowns of a span and more, so that an error does not hide between samples.
constexpr int samples_in_span = 6;
constexpr int lines_in_cell = 3;
constexpr int checks_in_span = 5;
// Of the tolerance, what either direction may leave by itself.
constexpr double direction_share = 0.5;
constexpr int most_rounds = 12;

using Lines = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The progress of a fit whose number of rounds shows only at the last.
class FitRounds {
 public:
  explicit FitRounds(const ShapeFit& fit) : progress_(&fit.progress) {}

  void step() { done_.step(); }
  bool report() const { return progress_->report(done_.fraction()); }

 private:
  const Progress* progress_;
  RoundsDone done_{0.1};
};

struct DirectionError {
  std::vector<double> at, error_m;
};

// Summed in the order of the rows, for the same knots on every machine.
Lines fitted(const Eigen::MatrixXd& inverse, const BlendingMatrix& blending, const Lines& samples) {
  Lines control = Lines::Zero(inverse.rows(), samples.cols());
  for (Eigen::Index i = 0; i < inverse.rows(); ++i) {
    for (Eigen::Index k = 0; k < inverse.cols(); ++k) control.row(i) += inverse(i, k) * samples.row(k);
  }
  Lines result = Lines::Zero(samples.rows(), samples.cols());
  for (int i = 0; i < blending.rows; ++i) {
    for (int k = 0; k < blending.bandwidth; ++k) {
      result.row(i) += blending.values[static_cast<std::size_t>(i) * blending.bandwidth + k] *
                       control.row(blending.column(i, k));
    }
  }
  return result;
}

std::vector<double> between(const std::vector<double>& parameters, const ShapeDirection& direction) {
  std::vector<double> middles;
  for (std::size_t k = 0; k + 1 < parameters.size(); ++k) {
    middles.push_back(0.5 * (parameters[k] + parameters[k + 1]));
  }
  if (direction.periodic) middles.push_back(0.5 * (parameters.back() + direction.end()));
  return middles;
}

// What a fit along one direction alone leaves across the shape: how far it slides along the shape is no
// error, unless parameters are to be kept.
Result<DirectionError> error_along(const ExactShape& shape, bool along_u, const ShapeKnots& knots,
                                   const std::vector<double>& lines, bool keeps_parameters,
                                   FitRounds& rounds) {
  rounds.step();
  DirectionError result;
  result.at = knots.parameters(samples_in_span);
  const KnotVector vector = knots.knots();
  const auto inverse = pseudo_inverse(vector, result.at);
  if (!inverse) return inverse.error();
  const auto point = [&](double t, double line) { return along_u ? shape.at(t, line) : shape.at(line, t); };
  Lines samples(static_cast<Eigen::Index>(result.at.size()), static_cast<Eigen::Index>(3 * lines.size()));
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    if (!rounds.report()) return Progress::stopped();
    for (std::size_t l = 0; l < lines.size(); ++l) {
      samples.block<1, 3>(i, static_cast<Eigen::Index>(3 * l)) =
          point(result.at[static_cast<std::size_t>(i)], lines[l]).transpose();
    }
  }
  if (!samples.allFinite()) return Error{"shape: not finite everywhere; its sizes must be"};
  const Lines residual = fitted(inverse.value(), blending_matrix(vector, result.at, 0), samples) - samples;
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    if (!rounds.report()) return Progress::stopped();
    const double t = result.at[static_cast<std::size_t>(i)];
    double largest = 0.0;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      const Vector3 miss = residual.block<1, 3>(i, static_cast<Eigen::Index>(3 * l)).transpose();
      if (miss.norm() <= largest) continue;
      if (keeps_parameters) {
        largest = miss.norm();
        continue;
      }
      const Vector3 normal =
          along_u ? tangents(shape, t, lines[l]).normal : tangents(shape, lines[l], t).normal;
      largest = std::max(largest, normal.isZero() ? 0.0 : std::abs(miss.dot(normal)));
    }
    result.error_m.push_back(largest);
  }
  return result;
}

// How many rings reach into what is flat about a pole and, as there is a knot at its border, bend no more
// beyond it than its tangent goes on; of a shape that is nowhere flat, that of its tangent plane.
int flat_rings(const ExactShape& shape, bool at_start, const KnotVector& v) {
  const std::vector<double>& knots = v.knots();
  const std::optional<double> border = at_start ? shape.flat_to : shape.flat_from;
  if (!border || std::count(knots.begin(), knots.end(), *border) < v.degree() - 1) return 1;
  int rings = 0;
  for (int c = 0; c < v.control_point_count(); ++c) {
    const auto first = static_cast<std::size_t>(c), last = first + static_cast<std::size_t>(v.degree()) + 1;
    rings += (at_start ? knots[first] < *border : knots[last] > *border) ? 1 : 0;
  }
  return std::max(1, rings - 1);
}

// Every control point of the edge in the pole, the next rings in its tangent plane.
void settle_pole(const ExactShape& shape, bool at_start, const KnotVector& knots, ControlNet& net) {
  const double v = at_start ? shape.v.start() : shape.v.end();
  const Vector3 pole = shape.at(shape.u.start(), v);
  const int edge = at_start ? 0 : net.columns - 1, inwards = at_start ? 1 : -1;
  const int rings = flat_rings(shape, at_start, knots);
  const std::optional<Vector3> normal = pole_normal(shape, at_start);
  for (int i = 0; i < net.rows; ++i) {
    net.set_point(i, edge, pole);
    if (!normal) continue;
    for (int ring = 1; ring <= rings; ++ring) {
      const int column = edge + ring * inwards;
      const Vector3 point = net.point(i, column);
      net.set_point(i, column, point - normal->dot(point - pole) * *normal);
    }
  }
}

Result<Surface> fit_with(const ExactShape& shape, const ShapeKnots& u, const ShapeKnots& v,
                         FitRounds& rounds) {
  rounds.step();
  if (!rounds.report()) return Progress::stopped();
  PointGrid grid{u.parameters(samples_in_span), v.parameters(samples_in_span), {}};
  for (const double at_u : grid.u) {
    for (const double at_v : grid.v) grid.points_m.push_back(shape.at(at_u, at_v));
  }
  MetEnds met;
  met.v_first = shape.pole_at_start;
  met.v_last = shape.pole_at_end;
  auto surface = fit_grid(u.knots(), v.knots(), grid, met);
  if (!surface) return surface;
  if (shape.pole_at_start) settle_pole(shape, true, surface->v, surface->net);
  if (shape.pole_at_end) settle_pole(shape, false, surface->v, surface->net);
  return surface;
}

struct Measure {
  double deviation_m = 0.0;
  bool folds = false;
};

Result<Measure> measure(const ExactShape& shape, const Surface& surface, const ShapeKnots& u,
                        const ShapeKnots& v, bool keeps_parameters, FitRounds& rounds) {
  rounds.step();
  Measure result;
  for (const double at_u : between(u.parameters(checks_in_span), shape.u)) {
    if (!rounds.report()) return Progress::stopped();
    for (const double at_v : between(v.parameters(checks_in_span), shape.v)) {
      const SurfacePoint point = evaluate(surface, at_u, at_v);
      if (!(point.du.cross(point.dv).dot(tangents(shape, at_u, at_v).normal) >= 0.0)) result.folds = true;
      const double apart_m = (point.position_m - shape.at(at_u, at_v)).norm();
      if (apart_m <= result.deviation_m) continue;
      result.deviation_m =
          std::max(result.deviation_m,
                   keeps_parameters ? apart_m : distance_near(shape, point.position_m, at_u, at_v));
    }
  }
  return result;
}

// Where parameters are kept: more densely, on the edges too, and about the worst sample.
Result<Measure> measure_closely(const ExactShape& shape, const Surface& surface, const ShapeKnots& u,
                                const ShapeKnots& v, FitRounds& rounds) {
  auto result = measure(shape, surface, u, v, true, rounds);
  if (!result) return result;
  const auto with_ends = [](const ShapeKnots& knots, const ShapeDirection& direction) {
    std::vector<double> all = between(knots.parameters(2 * checks_in_span), direction);
    all.insert(all.begin(), direction.start());
    if (!direction.periodic) all.push_back(direction.end());
    return all;
  };
  const std::vector<double> along_u = with_ends(u, shape.u), along_v = with_ends(v, shape.v);
  const auto within = [](const ShapeDirection& direction, double t) {
    return std::clamp(t, direction.start(), direction.end());
  };
  const auto apart_m = [&](double at_u, double at_v) {
    const double u_within = within(shape.u, at_u), v_within = within(shape.v, at_v);
    return (position(surface, u_within, v_within) - shape.at(u_within, v_within)).norm();
  };
  double worst_u = shape.u.start(), worst_v = shape.v.start(), worst_m = 0.0;
  for (const double at_u : along_u) {
    if (!rounds.report()) return Progress::stopped();
    for (const double at_v : along_v) {
      const double here_m = apart_m(at_u, at_v);
      if (here_m <= worst_m) continue;
      worst_m = here_m;
      worst_u = at_u;
      worst_v = at_v;
    }
  }
  const auto spacing = [](const ShapeDirection& direction, const std::vector<double>& all) {
    return (direction.end() - direction.start()) / static_cast<double>(all.size());
  };
  result->deviation_m =
      std::max(result->deviation_m,
               peak_near(apart_m, worst_u, worst_v, spacing(shape.u, along_u), spacing(shape.v, along_v)));
  return result;
}

Result<Measure> measured(const ExactShape& shape, const Surface& surface, const ShapeKnots& u,
                         const ShapeKnots& v, bool keeps_parameters, FitRounds& rounds) {
  return keeps_parameters ? measure_closely(shape, surface, u, v, rounds)
                          : measure(shape, surface, u, v, false, rounds);
}

Result<FittedShape> fit_counted(const ExactShape& shape, const ShapeFit& fit) {
  FitRounds rounds(fit);
  const auto [u_count, v_count] = *fit.control_counts;
  auto u = ShapeKnots::counted(shape.u, fit.degree, u_count);
  auto v = ShapeKnots::counted(shape.v, fit.degree, v_count);
  if (!u) return Error{"along u: " + u.error().message};
  if (!v) return Error{"along v: " + v.error().message};
  const std::vector<double> u_lines = between(u->parameters(lines_in_cell), shape.u);
  const std::vector<double> v_lines = between(v->parameters(lines_in_cell), shape.v);
  for (const bool along_u : {true, false}) {
    ShapeKnots& knots = along_u ? u.value() : v.value();
    while (knots.control_count() < (along_u ? u_count : v_count)) {
      const auto error =
          error_along(shape, along_u, knots, along_u ? v_lines : u_lines, fit.keeps_parameters, rounds);
      if (!error) return error.error();
      knots.refine_worst(error->at, error->error_m);
    }
  }
  auto surface = fit_with(shape, u.value(), v.value(), rounds);
  if (!surface) return surface.error();
  const auto found = measured(shape, surface.value(), u.value(), v.value(), fit.keeps_parameters, rounds);
  if (!found) return found.error();
  if (found->folds) {
    return Error{"with " + std::to_string(u_count) + " x " + std::to_string(v_count) +
                 " control points the surface folds over; give it more"};
  }
  return FittedShape{std::move(surface).value(), found->deviation_m};
}

Error too_fine(const ShapeFit& fit, const std::string& direction) {
  return Error{"a tolerance of " + length_text(fit.tolerance_m) + " needs more than " +
               std::to_string(most_control_points) + " control points along " + direction +
               "; make it larger, or the shape's roundings and bends gentler"};
}

Status refine_until(const ExactShape& shape, bool along_u, double allowed_m, const ShapeFit& fit,
                    const std::vector<double>& lines, ShapeKnots& knots, FitRounds& rounds) {
  for (;;) {
    if (knots.control_count() > most_control_points) return too_fine(fit, along_u ? "u" : "v");
    const auto error = error_along(shape, along_u, knots, lines, fit.keeps_parameters, rounds);
    if (!error) return error.error();
    if (!knots.refine(error->at, error->error_m, allowed_m)) return {};
  }
}

}  // namespace

Result<FittedShape> fit_shape(const ExactShape& shape, const ShapeFit& fit) {
  SPOONBILL_ASSERT(shape.at && shape.u.breaks.size() >= 2 && shape.v.breaks.size() >= 2);
  SPOONBILL_ASSERT(fit.tolerance_m > 0.0 && fit.least_spans >= 1);
  SPOONBILL_ASSERT(fit.degree >= 1 && fit.degree <= max_degree);
  if (fit.control_counts) return fit_counted(shape, fit);
  ShapeKnots u(shape.u, fit.degree, fit.least_spans), v(shape.v, fit.degree, fit.least_spans);
  if (u.control_count() > most_control_points) return too_fine(fit, "u");
  if (v.control_count() > most_control_points) return too_fine(fit, "v");
  const std::vector<double> u_lines = between(u.parameters(lines_in_cell), shape.u);
  const std::vector<double> v_lines = between(v.parameters(lines_in_cell), shape.v);
  double allowed_m = direction_share * fit.tolerance_m;
  FitRounds rounds(fit);
  for (int round = 0; round < most_rounds; ++round) {
    for (const bool along_u : {true, false}) {
      const Status done =
          refine_until(shape, along_u, allowed_m, fit, along_u ? v_lines : u_lines, along_u ? u : v, rounds);
      if (!done) return done.error();
    }
    auto surface = fit_with(shape, u, v, rounds);
    if (!surface) return surface.error();
    const auto found = measured(shape, surface.value(), u, v, fit.keeps_parameters, rounds);
    if (!found) return found.error();
    if (!found->folds && found->deviation_m <= fit.tolerance_m) {
      return FittedShape{std::move(surface).value(), found->deviation_m};
    }
    allowed_m *= found->folds ? 0.25 : std::clamp(fit.tolerance_m / found->deviation_m, 0.1, 0.8);
  }
  return too_fine(fit, "u or v");
}

}  // namespace spoonbill
