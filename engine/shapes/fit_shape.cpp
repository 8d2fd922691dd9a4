#include "engine/shapes/fit_shape.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

namespace {

// Largest ratio of the lengths of neighbouring spans. The limit keeps the control net even and the
// least-squares problem well conditioned.
constexpr double largest_step = 3.0;
// A cell is not refined if its error is at most this fraction of the largest error of any cell. Its error may
// be only ringing from neighbouring cells; if it remains, the cell is refined in a later round.
constexpr double ringing_fraction = 0.1;
// Largest factor by which one round increases the number of spans in a cell. Far too many spans would
// otherwise result if the error does not yet decrease with the asymptotic order of convergence.
constexpr int max_subdivision = 3;

}  // namespace

ShapeKnots::ShapeKnots(const ShapeDirection& direction, int degree)
    : periodic_(direction.periodic),
      degree_(degree),
      ends_(direction.breaks),
      jumps_(ends_.size(), degree > 2),
      spans_(ends_.size() - 1, 1) {
  SPOONBILL_ASSERT(direction.breaks.size() >= 2);
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(direction.breaks.begin(), direction.breaks.end()));
  SPOONBILL_ASSERT(degree >= 1 && degree <= max_degree);
  jumps_.front() = jumps_.back() = false;
}

ShapeKnots::ShapeKnots(const ShapeDirection& direction, int degree, int min_spans)
    : ShapeKnots(direction, degree) {
  SPOONBILL_ASSERT(min_spans >= 1);
  const double longest = (direction.end() - direction.start()) / min_spans;
  for (std::size_t k = spans_.size(); k-- > 0;) {
    const double length = ends_[k + 1] - ends_[k];
    const int cells = std::max(1, static_cast<int>(std::ceil(length / longest - 1e-9)));
    for (int cell = cells - 1; cell > 0; --cell) split(k, length * cell / cells, true);
  }
  grade();
}

void ShapeKnots::split(std::size_t cell, double length, bool from_start) {
  const double end = from_start ? ends_[cell] + length : ends_[cell + 1] - length;
  const auto after = static_cast<std::ptrdiff_t>(cell) + 1;
  ends_.insert(ends_.begin() + after, end);
  jumps_.insert(jumps_.begin() + after, false);
  spans_.insert(spans_.begin() + after, 1);
}

void ShapeKnots::grade() {
  const auto length = [&](std::size_t k) { return ends_[k + 1] - ends_[k]; };
  const auto split_beside = [&](std::size_t k, std::size_t beside, bool from_start) {
    const double most = largest_step * length(beside);
    if (!(length(k) > most * (1.0 + 1e-6))) return false;
    split(k, std::min(most, 0.5 * length(k)), from_start);
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 0; k < spans_.size(); ++k) {
      const std::size_t last = spans_.size() - 1;
      if (k > 0 || periodic_) changed |= split_beside(k, k > 0 ? k - 1 : last, true);
    }
    for (std::size_t k = spans_.size(); k-- > 0;) {
      const std::size_t last = spans_.size() - 1;
      if (k < last || periodic_) changed |= split_beside(k, k < last ? k + 1 : 0, false);
    }
  }
}

Result<ShapeKnots> ShapeKnots::with_control_count(const ShapeDirection& direction, int degree,
                                                  int control_count) {
  if (control_count < degree + 1) {
    return Error{ErrorCode::too_few, std::to_string(control_count) +
                                         " control points are too few for degree " + std::to_string(degree) +
                                         ", which needs " + std::to_string(degree + 1)};
  }
  ShapeKnots knots(direction, degree);
  const int cells = static_cast<int>(knots.spans_.size());
  const int spare = control_count - knots.control_count();
  // The breaks are ignored if they leave too few spare control points, that is, fewer than half the number of
  // cells.
  if (cells > 1 && spare < cells / 2) {
    knots.ends_ = {direction.start(), direction.end()};
    knots.jumps_ = {false, false};
    knots.spans_ = {direction.periodic ? control_count : control_count - degree};
    return knots;
  }
  // The longest spans are divided first. If there are breaks, a third of the spare control points is left for
  // refine_worst().
  for (int left = spare - (cells > 1 ? spare / 3 : 0); left > 0; --left) {
    std::size_t longest = 0;
    for (std::size_t k = 1; k < knots.spans_.size(); ++k) {
      const auto length = [&](std::size_t c) {
        return (knots.ends_[c + 1] - knots.ends_[c]) / knots.spans_[c];
      };
      if (length(k) > length(longest) * (1.0 + 1e-9)) longest = k;
    }
    ++knots.spans_[longest];
  }
  return knots;
}

int ShapeKnots::control_count() const {
  const int spans = std::accumulate(spans_.begin(), spans_.end(), 0);
  const int repeated = (degree_ - 2) * static_cast<int>(std::count(jumps_.begin(), jumps_.end(), true));
  return spans + repeated + (periodic_ ? 0 : degree_);
}

std::vector<double> ShapeKnots::breakpoints() const {
  std::vector<double> points;
  for (std::size_t k = 0; k < spans_.size(); ++k) {
    for (int s = 0; s < spans_[k]; ++s) {
      points.push_back(ends_[k] + (ends_[k + 1] - ends_[k]) * s / spans_[k]);
    }
  }
  points.push_back(ends_.back());
  return points;
}

KnotVector ShapeKnots::knots() const {
  std::vector<double> knots = breakpoints();
  for (std::size_t k = 0; k < ends_.size(); ++k) {
    if (!jumps_[k]) continue;
    const auto position = std::lower_bound(knots.begin(), knots.end(), ends_[k]);
    knots.insert(position, static_cast<std::size_t>(degree_ - 2), ends_[k]);
  }
  if (periodic_) return KnotVector::periodic(degree_, std::move(knots)).value();
  knots.insert(knots.begin(), static_cast<std::size_t>(degree_), ends_.front());
  knots.insert(knots.end(), static_cast<std::size_t>(degree_), ends_.back());
  return KnotVector::open(degree_, std::move(knots)).value();
}

std::vector<double> ShapeKnots::parameters(int in_each_span) const {
  SPOONBILL_ASSERT(in_each_span >= 1);
  const std::vector<double> points = breakpoints();
  std::vector<double> parameters;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    for (int s = 0; s < in_each_span; ++s) {
      parameters.push_back(points[k] + (points[k + 1] - points[k]) * s / in_each_span);
    }
  }
  if (!periodic_) parameters.push_back(points.back());
  return parameters;
}

std::vector<double> ShapeKnots::largest_in_cells(const std::vector<double>& at,
                                                 const std::vector<double>& error_m) const {
  std::vector<double> largest(spans_.size(), 0.0);
  for (std::size_t p = 0; p < at.size(); ++p) {
    // An error at the border of two cells counts for both cells.
    for (std::size_t k = 0; k < spans_.size(); ++k) {
      if (at[p] >= ends_[k] && at[p] <= ends_[k + 1]) largest[k] = std::max(largest[k], error_m[p]);
    }
  }
  return largest;
}

bool ShapeKnots::refine(const std::vector<double>& at, const std::vector<double>& error_m, double allowed_m) {
  SPOONBILL_ASSERT(at.size() == error_m.size());
  SPOONBILL_ASSERT(allowed_m > 0.0);
  const std::vector<double> largest = largest_in_cells(at, error_m);
  const double least = ringing_fraction * *std::max_element(largest.begin(), largest.end());
  bool refined = false;
  for (std::size_t k = 0; k < spans_.size(); ++k) {
    if (!(largest[k] > allowed_m && largest[k] > least)) continue;
    const double cut = std::ceil(spans_[k] * std::pow(largest[k] / allowed_m, 1.0 / (degree_ + 1)));
    spans_[k] = std::clamp(static_cast<int>(std::min(cut, 1e6)), spans_[k] + 1, max_subdivision * spans_[k]);
    refined = true;
  }
  even_out();
  return refined;
}

void ShapeKnots::refine_worst(const std::vector<double>& at, const std::vector<double>& error_m) {
  SPOONBILL_ASSERT(at.size() == error_m.size() && !at.empty());
  const std::vector<double> largest = largest_in_cells(at, error_m);
  ++spans_[static_cast<std::size_t>(std::max_element(largest.begin(), largest.end()) - largest.begin())];
}

void ShapeKnots::even_out() {
  const std::size_t count = spans_.size();
  const auto cut_beside = [&](std::size_t k, std::size_t beside) {
    const double most = largest_step * (ends_[beside + 1] - ends_[beside]) / spans_[beside];
    const double length = ends_[k + 1] - ends_[k];
    if (!(length / spans_[k] > most * (1.0 + 1e-6))) return false;
    ++spans_[k];
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 0; k < count; ++k) {
      if (k > 0 || periodic_) changed |= cut_beside(k, (k + count - 1) % count);
      if (k + 1 < count || periodic_) changed |= cut_beside(k, (k + 1) % count);
    }
  }
}

namespace {

constexpr int max_control_points = 200;
// Number of samples in each span. A span usually adds one control point, so the fit has about six samples for
// each unknown, and no error remains hidden between samples.
constexpr int samples_in_span = 6;
constexpr int lines_in_cell = 3;
constexpr int checks_in_span = 5;
// Fraction of the tolerance that the error of a fit in one direction may use.
constexpr double direction_fraction = 0.5;
constexpr int max_rounds = 12;

using Lines = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Progress of a fit whose number of rounds is unknown.
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

// Fits splines to lines of samples by least squares and returns the splines' values at the parameters of the
// samples. The order of summation is fixed, so that the resulting knots are the same on every machine.
Lines evaluate_fit(const Eigen::MatrixXd& inverse, const BlendingMatrix& blending, const Lines& samples) {
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

std::vector<double> midpoints(const std::vector<double>& parameters, const ShapeDirection& direction) {
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < parameters.size(); ++k) {
    result.push_back(0.5 * (parameters[k] + parameters[k + 1]));
  }
  if (direction.periodic) result.push_back(0.5 * (parameters.back() + direction.end()));
  return result;
}

// Fits the shape in u alone (`along_u`) or in v alone, on the lines of the other parameter given by `lines`.
// Returns the largest error at each parameter of the fitted direction. Only the component of the error along
// the normal counts, unless `keeps_parameters` is true.
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
  if (!samples.allFinite())
    return Error{ErrorCode::out_of_range, "the shape is not finite everywhere; use finite sizes"};
  const Lines residual =
      evaluate_fit(inverse.value(), blending_matrix(vector, result.at, 0), samples) - samples;
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

// Returns the number of rings of control points around a pole that must be in the pole's tangent plane. If
// the shape has a flat end at the pole (ExactShape::flat_to), the number is that of all rings that affect the
// flat end, except the outermost one, which bends the surface beyond the flat end. Otherwise it is 1.
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

// Moves the control points at the edge to the pole, and the next rings into the pole's tangent plane.
void flatten_pole(const ExactShape& shape, bool at_start, const KnotVector& knots, ControlNet& net) {
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
  InterpolatedEnds ends;
  ends.v_first = shape.pole_at_start;
  ends.v_last = shape.pole_at_end;
  auto surface = fit_grid(u.knots(), v.knots(), grid, ends);
  if (!surface) return surface;
  if (shape.pole_at_start) flatten_pole(shape, true, surface->v, surface->net);
  if (shape.pole_at_end) flatten_pole(shape, false, surface->v, surface->net);
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
  for (const double at_u : midpoints(u.parameters(checks_in_span), shape.u)) {
    if (!rounds.report()) return Progress::stopped();
    for (const double at_v : midpoints(v.parameters(checks_in_span), shape.v)) {
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

// Measures the deviation at equal parameters, more densely than measure(), and also on the edges and near the
// worst sample.
Result<Measure> measure_closely(const ExactShape& shape, const Surface& surface, const ShapeKnots& u,
                                const ShapeKnots& v, FitRounds& rounds) {
  auto result = measure(shape, surface, u, v, true, rounds);
  if (!result) return result;
  const auto with_ends = [](const ShapeKnots& knots, const ShapeDirection& direction) {
    std::vector<double> all = midpoints(knots.parameters(2 * checks_in_span), direction);
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
               find_peak(apart_m, worst_u, worst_v, spacing(shape.u, along_u), spacing(shape.v, along_v)));
  return result;
}

Result<Measure> measure_fit(const ExactShape& shape, const Surface& surface, const ShapeKnots& u,
                            const ShapeKnots& v, bool keeps_parameters, FitRounds& rounds) {
  return keeps_parameters ? measure_closely(shape, surface, u, v, rounds)
                          : measure(shape, surface, u, v, false, rounds);
}

Result<FittedShape> fit_counted(const ExactShape& shape, const ShapeFit& fit) {
  FitRounds rounds(fit);
  const auto [u_count, v_count] = *fit.control_counts;
  auto u = ShapeKnots::with_control_count(shape.u, fit.degree, u_count);
  auto v = ShapeKnots::with_control_count(shape.v, fit.degree, v_count);
  if (!u) return u.error().in("along u");
  if (!v) return v.error().in("along v");
  const std::vector<double> u_lines = midpoints(u->parameters(lines_in_cell), shape.u);
  const std::vector<double> v_lines = midpoints(v->parameters(lines_in_cell), shape.v);
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
  const auto found = measure_fit(shape, surface.value(), u.value(), v.value(), fit.keeps_parameters, rounds);
  if (!found) return found.error();
  if (found->folds) {
    return Error{ErrorCode::self_intersecting, "with " + std::to_string(u_count) + " x " +
                                                   std::to_string(v_count) +
                                                   " control points the surface folds over; allow more"};
  }
  return FittedShape{std::move(surface).value(), found->deviation_m};
}

Error too_fine(const ShapeFit& fit, const std::string& direction) {
  return Error{ErrorCode::not_converged,
               "a tolerance of " + length_text(fit.tolerance_m) + " needs more than " +
                   std::to_string(max_control_points) + " control points along " + direction +
                   "; choose a larger tolerance, or make the roundings and bends of the shape wider",
               "tolerance"};
}

Status refine_until(const ExactShape& shape, bool along_u, double allowed_m, const ShapeFit& fit,
                    const std::vector<double>& lines, ShapeKnots& knots, FitRounds& rounds) {
  for (;;) {
    if (knots.control_count() > max_control_points) return too_fine(fit, along_u ? "u" : "v");
    const auto error = error_along(shape, along_u, knots, lines, fit.keeps_parameters, rounds);
    if (!error) return error.error();
    if (!knots.refine(error->at, error->error_m, allowed_m)) return {};
  }
}

}  // namespace

Result<FittedShape> fit_shape(const ExactShape& shape, const ShapeFit& fit) {
  SPOONBILL_ASSERT(shape.at && shape.u.breaks.size() >= 2 && shape.v.breaks.size() >= 2);
  SPOONBILL_ASSERT(fit.tolerance_m > 0.0 && fit.min_spans >= 1);
  SPOONBILL_ASSERT(fit.degree >= 1 && fit.degree <= max_degree);
  if (fit.control_counts) return fit_counted(shape, fit);
  ShapeKnots u(shape.u, fit.degree, fit.min_spans), v(shape.v, fit.degree, fit.min_spans);
  if (u.control_count() > max_control_points) return too_fine(fit, "u");
  if (v.control_count() > max_control_points) return too_fine(fit, "v");
  const std::vector<double> u_lines = midpoints(u.parameters(lines_in_cell), shape.u);
  const std::vector<double> v_lines = midpoints(v.parameters(lines_in_cell), shape.v);
  double allowed_m = direction_fraction * fit.tolerance_m;
  FitRounds rounds(fit);
  for (int round = 0; round < max_rounds; ++round) {
    for (const bool along_u : {true, false}) {
      const Status done =
          refine_until(shape, along_u, allowed_m, fit, along_u ? v_lines : u_lines, along_u ? u : v, rounds);
      if (!done) return done.error();
    }
    auto surface = fit_with(shape, u, v, rounds);
    if (!surface) return surface.error();
    const auto found = measure_fit(shape, surface.value(), u, v, fit.keeps_parameters, rounds);
    if (!found) return found.error();
    if (!found->folds && found->deviation_m <= fit.tolerance_m) {
      return FittedShape{std::move(surface).value(), found->deviation_m};
    }
    allowed_m *= found->folds ? 0.25 : std::clamp(fit.tolerance_m / found->deviation_m, 0.1, 0.8);
  }
  return too_fine(fit, "u or v");
}

}  // namespace spoonbill
