#include "engine/fitting/fit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/fitting/fit_quality.h"
#include "engine/fitting/normals.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scattered_fit.h"
#include "engine/inspection/mass_properties.h"

namespace spoonbill {
namespace {

inline constexpr int projection_steps = 3;
// Smallest fairness (weight of the smoothing term), low enough for a surface to follow noise-free data
// closely.
inline constexpr double least_fairness = 3e-4;

// Data of one stage of the fit. The first stage fits the nodes of the graph, the second all points.
struct FittedData {
  std::span<const Vector3> points_m;
  std::span<const double> weights;
  std::span<const Vector3> normals;  // empty, or one normal for each point, which is zero where unknown
  std::vector<Vector2> uv;
  std::vector<double> distance_m;
  std::vector<double> trust;
};

// Returns the 95th percentile of the distances.
inline double percentile_95(std::span<const double> distances) {
  return quantile({distances.begin(), distances.end()}, 0.95);
}

// Returns a difference of parameters with period 1, wrapped into [-0.5, 0.5].
inline double wrapped(double difference) {
  return difference - std::round(difference);
}

// Quality of a fit, for comparison with other fits. Fits without folds are better; otherwise the error
// decides, with a surcharge for each fold and cusp.
struct FitQuality {
  std::size_t folds, cusps;
  double error_m;

  bool is_better_than(const FitQuality& other) const {
    return (folds > 0) != (other.folds > 0) ? folds == 0 : cost() < other.cost();
  }
  double cost() const {
    return error_m * (1.0 + 0.03 * static_cast<double>(folds) + 0.004 * static_cast<double>(cusps));
  }
};

class SurfaceFitter {
 public:
  // A point keeps its parameters if the cosine between its own normal and the surface normal at the closest
  // point is below `least_agreement`. On a thin wall the closest point may be on the other face.
  SurfaceFitter(const FitPoints& points, const Parameterisation& start, const FitSettings& settings,
                double least_agreement, double fairness_factor);
  Result<FittedSurface> run();

 private:
  // Copy of the state that unfold() changes and may restore.
  struct Folding {
    Surface surface;
    FoldCheck folds;
    std::vector<Vector2> uv;
    std::vector<double> fairness;
  };

  bool closed() const { return kind_ == ShapeKind::closed; }
  bool periodic() const { return kind_ != ShapeKind::sheet; }
  Status solve(FittedData& data);
  void add_poles();
  void project(FittedData& data, bool smooth);
  bool can_move_to(const FittedData& data, std::size_t point, const Vector2& uv) const;
  void update_trust(FittedData& data) const;
  double off_surface_distance(const FittedData& data, std::size_t point) const;
  void distrust_strays();
  void smooth_shifts(const std::vector<Vector2>& before, std::vector<Vector2>& uv) const;
  bool within_tolerance(const FittedData& data) const;
  bool add_control_points();
  bool has_inward_normals() const;
  Status orient_outwards();
  Status node_rounds();
  Status point_rounds();
  const std::vector<bool>& faulty_spans() const;
  void stiffen_faulty_spans();
  void relax_faulty_spans(int rounds);
  bool is_in_faulty_span(const Vector2& uv) const;
  Vector2 clamp_to_domain(Vector2 uv) const;
  double percentile_error() const;
  Status unfold();
  Status unfold(int relaxation);
  void restore(const Folding& folding);
  void set_fairness(double fairness, const FittedData& data);
  Status choose_fairness(const FittedData& data);
  bool report(double fraction) const { return settings_->progress.report(fraction); }
  FittedSurface result();

  const FitPoints* points_;
  const FitSettings* settings_;
  ShapeKind kind_;
  double least_agreement_, fairness_factor_, chosen_fairness_;
  SurfaceStructure structure_;
  // Fairness of each rectangle of (u, v) between successive knots; v varies fastest.
  std::vector<double> fairness_;
  std::vector<double> node_weights_, all_weights_;
  std::vector<Vector3> all_points_m_, all_normals_;
  FittedData nodes_, all_;
  std::vector<std::pair<Vector3, double>> poles_;  // position and parameter v of each pole
  Surface surface_;
  FoldCheck folds_;
  std::vector<double> u_breaks_, v_breaks_;  // breakpoints of the final knots
};

constexpr int degree = 3;
constexpr int first_controls = 10;
constexpr double growth = 1.35;
constexpr double first_fairness = 1e-2;
constexpr int point_round_count = 3;
// Weight of a node that spans a hole, relative to the mean weight. It is small, because the position of such
// a node is a guess.
constexpr double spanning_weight = 0.15;
// Weight of a pole, relative to the mean total weight of the points in a span.
constexpr double pole_weight = 0.5;

const ClosestPoint& nearer(const ClosestPoint& one, const ClosestPoint& other) {
  return other.distance_m < one.distance_m ? other : one;
}

// Returns the 95th percentile of the distances of the given points, without strays.
double percentile_error(const FittedSurface& fitted, const FitPoints& points) {
  std::vector<double> distances;
  for (const std::uint32_t point : points.representative) {
    if (point != no_point && fitted.trust[point] > 0.0) distances.push_back(fitted.distance_m[point]);
  }
  return percentile_95(distances);
}

KnotVector first_knots(bool is_periodic, int count) {
  return is_periodic ? KnotVector::periodic_uniform(degree, std::max(count, degree)).value()
                     : KnotVector::clamped_uniform(degree, std::max(count, degree + 1)).value();
}

// Rescales uniform knots to the domain [0, 1].
KnotVector over_unit(const KnotVector& knots) {
  std::vector<double> scaled = knots.knots();
  const double start = knots.domain_start(), length = knots.domain_end() - start;
  for (double& knot : scaled) knot = (knot - start) / length;
  return knots.is_periodic() ? KnotVector::periodic(degree, std::move(scaled)).value()
                             : KnotVector::open(degree, std::move(scaled)).value();
}

SurfaceFitter::SurfaceFitter(const FitPoints& points, const Parameterisation& start,
                             const FitSettings& settings, double least_agreement, double fairness_factor)
    : points_(&points),
      settings_(&settings),
      kind_(start.kind),
      least_agreement_(least_agreement),
      fairness_factor_(fairness_factor),
      chosen_fairness_(fairness_factor * least_fairness) {
  structure_.u = over_unit(first_knots(periodic(), std::min(settings.control_u, first_controls)));
  structure_.v = over_unit(first_knots(false, std::min(settings.control_v, first_controls)));
  structure_.pole_at_start = structure_.pole_at_end = closed();
  node_weights_.assign(points.graph.size(), 0.0);
  for (std::size_t p = 0; p < points.weights.size(); ++p) {
    node_weights_[points.node_index[p]] += points.weights[p];
  }
  double mean = 0.0;
  for (const double weight : node_weights_) mean += weight / static_cast<double>(node_weights_.size());
  for (std::size_t n = node_weights_.size() - points.spanning_nodes; n < node_weights_.size(); ++n) {
    node_weights_[n] = spanning_weight * mean;
  }
  nodes_ = {points.graph.points_m,
            node_weights_,
            points.node_normals,
            start.uv,
            std::vector<double>(points.graph.size(), 0.0),
            std::vector<double>(points.graph.size(), 1.0)};
  if (closed()) add_poles();
}

Status SurfaceFitter::solve(FittedData& data) {
  std::vector<double> weights(data.weights.begin(), data.weights.end());
  for (std::size_t p = 0; p < weights.size(); ++p) weights[p] *= data.trust[p];
  std::vector<Vector3> points(data.points_m.begin(), data.points_m.end());
  std::vector<Vector2> uv = data.uv;
  const double span_weight =
      std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(fairness_.size());
  for (const auto& [position, v] : poles_) {
    points.push_back(position);
    uv.emplace_back(0.0, v);
    weights.push_back(pole_weight * span_weight);
  }
  auto surface = fit_scattered(structure_, {points, uv, weights}, fairness_);
  if (!surface) return surface.error();
  surface_ = std::move(surface).value();
  return {};
}

// Stores the initial positions of the poles. Every later solution also fits these positions, so that the
// surface does not extend beyond the points.
void SurfaceFitter::add_poles() {
  constexpr double near = 0.02;
  for (const double v : {0.0, 1.0}) {
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    bool exact = false;
    for (std::size_t n = 0; n < nodes_.uv.size(); ++n) {
      const double away = std::abs(nodes_.uv[n].y() - v);
      if (exact || !(away < near)) continue;  // the condition is also true for NaN
      if (away == 0.0) {
        exact = true;
        sum.setZero();
        count = 0.0;
      }
      sum += nodes_.points_m[n];
      count += 1.0;
    }
    if (count > 0.0) poles_.emplace_back(sum / count, v);
  }
}

void SurfaceFitter::smooth_shifts(const std::vector<Vector2>& before, std::vector<Vector2>& uv) const {
  std::vector<Vector2> shift(uv.size(), Vector2::Zero());
  std::vector<bool> known(uv.size());
  for (std::size_t n = 0; n < uv.size(); ++n) {
    known[n] = !before[n].hasNaN();
    if (!known[n]) continue;
    shift[n] = uv[n] - before[n];
    if (periodic()) shift[n].x() = wrapped(shift[n].x());
  }
  for (std::uint32_t n = 0; n < uv.size(); ++n) {
    if (!known[n]) continue;
    Vector2 sum = shift[n];
    double count = 1.0;
    for (const std::uint32_t other : points_->graph.adjacent(n)) {
      if (!known[other]) continue;
      sum += shift[other];
      count += 1.0;
    }
    uv[n] = before[n] + 0.5 * (shift[n] + sum / count);
    uv[n].y() = std::clamp(uv[n].y(), 0.0, 1.0);
    if (periodic()) {
      uv[n].x() -= std::floor(uv[n].x());
    } else {
      uv[n].x() = std::clamp(uv[n].x(), 0.0, 1.0);
    }
  }
}

// Returns true if the point may get the parameters `uv`, because the surface normal there agrees with the
// point's own normal. Nodes that span holes may always move, because their normals are guesses.
bool SurfaceFitter::can_move_to(const FittedData& data, std::size_t point, const Vector2& uv) const {
  if (least_agreement_ <= -1.0 || point + points_->spanning_nodes >= data.normals.size()) return true;
  const SurfacePoint at = evaluate(surface_, uv.x(), uv.y());
  const double cosine = at.du.cross(at.dv).normalized().dot(data.normals[point]);
  return data.normals[point].isZero() || !(cosine < least_agreement_);
}

void SurfaceFitter::project(FittedData& data, bool smooth) {
  const ClosestParameters closest(surface_);
  const std::vector<Vector2> before = data.uv;
  for (std::size_t p = 0; p < data.uv.size(); ++p) {
    const ClosestPoint found = before[p].hasNaN()
                                   ? closest.project(data.points_m[p], projection_steps)
                                   : closest.project_from(data.points_m[p], before[p], projection_steps);
    if (before[p].hasNaN() || can_move_to(data, p, found.uv)) {
      data.uv[p] = found.uv;
      data.distance_m[p] = found.distance_m;
    } else {
      data.distance_m[p] = closest.project_from(data.points_m[p], before[p], 0).distance_m;
    }
  }
  if (smooth) smooth_shifts(before, data.uv);
}

bool SurfaceFitter::within_tolerance(const FittedData& data) const {
  if (settings_->tolerance_m <= 0.0) return false;
  for (std::size_t p = 0; p + points_->spanning_nodes < data.distance_m.size(); ++p) {
    if (data.distance_m[p] > settings_->tolerance_m && data.trust[p] > 0.25) return false;
  }
  return true;
}

// Inserts knots. Returns false, without a change, if both directions have their largest number of control
// points or if the fit is within the tolerance.
bool SurfaceFitter::add_control_points() {
  const int u = structure_.u.control_point_count(), v = structure_.v.control_point_count();
  if (u >= settings_->control_u && v >= settings_->control_v) return false;
  if (within_tolerance(nodes_)) return false;
  const auto next = [](int count, int most) {
    return std::min(most, std::max(count + 2, static_cast<int>(std::lround(growth * count))));
  };
  std::vector<double> squares(nodes_.uv.size());
  for (std::size_t n = 0; n < squares.size(); ++n) {
    squares[n] = nodes_.weights[n] * nodes_.trust[n] * nodes_.distance_m[n] * nodes_.distance_m[n];
  }
  structure_.u = refine_knots(structure_.u, 0, next(u, settings_->control_u), nodes_.uv, squares);
  structure_.v = refine_knots(structure_.v, 1, next(v, settings_->control_v), nodes_.uv, squares);
  return true;
}

// Returns true if the surface normals, on average over the nodes, oppose those of the scan. Nodes that span
// holes do not count. Without normals, the sign of the enclosed volume decides for a closed shape, and
// is_inside_out() for an open one.
bool SurfaceFitter::has_inward_normals() const {
  double along = 0.0;
  for (std::size_t n = 0; n + points_->spanning_nodes < nodes_.uv.size(); ++n) {
    if (nodes_.uv[n].hasNaN()) continue;
    const SurfacePoint at = evaluate(surface_, nodes_.uv[n].x(), nodes_.uv[n].y());
    const Vector3 normal = at.du.cross(at.dv).normalized();
    if (normal.allFinite()) along += normal.dot(points_->node_normals[n]);
  }
  if (along != 0.0) return along < 0.0;
  return closed() ? compute_enclosed_mass(surface_).volume_m3 < 0.0 : is_inside_out(surface_);
}

// Reverses a closed surface of negative volume. Early rounds can produce such a surface on a thin wall.
Status SurfaceFitter::orient_outwards() {
  if (!closed() || compute_enclosed_mass(surface_).volume_m3 >= 0.0) return {};
  surface_ = reversed(surface_, Direction::u);
  for (Vector2& uv : all_.uv) uv.x() = 1.0 - uv.x();
  folds_ = check_folds(surface_, {all_.uv, all_normals_});
  return {};
}

Status SurfaceFitter::node_rounds() {
  set_fairness(first_fairness, nodes_);
  if (Status solved = solve(nodes_); !solved) return solved;
  if (has_inward_normals()) {
    for (Vector2& uv : nodes_.uv) uv.x() = 1.0 - uv.x();
  }
  double fairness = first_fairness;
  int stage = 0;
  do {
    for (int round = 0; round < 3; ++round) {
      set_fairness(fairness, nodes_);
      if (Status solved = solve(nodes_); !solved) return solved;
      project(nodes_, true);
      if (stage > 0) update_trust(nodes_);
      fairness = std::max(fairness_factor_ * least_fairness, 0.6 * fairness);
    }
    ++stage;
    if (!report(0.1 * std::min(stage, 6)))
      return Error(ErrorCode::cancelled, "stopped before the fit was done");
  } while (add_control_points());
  return {};
}

Status SurfaceFitter::point_rounds() {
  const std::size_t spanning = points_->spanning_nodes, node_count = points_->graph.size();
  all_points_m_ = points_->scan.points_m;
  all_weights_ = points_->weights;
  double mean = 0.0;
  for (const double weight : all_weights_) mean += weight / static_cast<double>(all_weights_.size());
  for (const std::uint32_t node : points_->node_index) all_.uv.push_back(nodes_.uv[node]);
  for (std::size_t n = node_count - spanning; n < node_count; ++n) {
    all_points_m_.push_back(points_->graph.points_m[n]);
    all_weights_.push_back(spanning_weight * mean);
    all_.uv.push_back(nodes_.uv[n]);
  }
  all_.points_m = all_points_m_;
  all_.weights = all_weights_;
  all_normals_ = points_->scan.normals;
  if (!all_normals_.empty()) {
    all_normals_.insert(all_normals_.end(),
                        points_->node_normals.end() - static_cast<std::ptrdiff_t>(spanning),
                        points_->node_normals.end());
  }
  all_.normals = all_normals_;
  all_.distance_m.assign(all_.uv.size(), 0.0);
  all_.trust.assign(all_.uv.size(), 1.0);
  for (int round = 0; round < point_round_count; ++round) {
    project(all_, false);
    update_trust(all_);
    if (round > 0) distrust_strays();
    if (round == 0) {
      if (Status chosen = choose_fairness(all_); !chosen) return chosen;
    }
    set_fairness(chosen_fairness_, all_);
    if (Status solved = solve(all_); !solved) return solved;
    if (!report(0.7 + 0.05 * round)) return Error(ErrorCode::cancelled, "stopped before the fit was done");
  }
  return {};
}

// Returns the fit. For each point, the closest surface point is searched from the point's parameters and from
// the nearest sample, and the nearer of the two results counts. One search is not enough, because a point may
// have kept old parameters or be caught in a local minimum. Normals that are estimated for clouds are used
// only to count folds: on thin walls some of them belong to the other face, so they must not steer the fit.
FittedSurface SurfaceFitter::result() {
  const std::size_t count = points_->scan.points_m.size();
  all_.uv.resize(count);
  all_.distance_m.resize(count);
  all_.trust.resize(count);
  const ClosestParameters closest(surface_);
  for (std::size_t p = 0; p < all_.uv.size(); ++p) {
    const ClosestPoint found = nearer(closest.project_from(all_.points_m[p], all_.uv[p], projection_steps),
                                      closest.project(all_.points_m[p], projection_steps));
    all_.uv[p] = found.uv;
    all_.distance_m[p] = found.distance_m;
  }
  if (all_normals_.empty()) {
    const std::vector<Vector3> estimated = estimate_normals(*points_, surface_, all_.uv);
    folds_ = check_folds(surface_, {all_.uv, estimated, true});
  }
  return {std::move(surface_), std::move(all_.uv), std::move(all_.distance_m), std::move(all_.trust),
          std::move(folds_)};
}

Result<FittedSurface> SurfaceFitter::run() {
  for (const auto step : {&SurfaceFitter::node_rounds, &SurfaceFitter::point_rounds, &SurfaceFitter::unfold,
                          &SurfaceFitter::orient_outwards}) {
    if (Status done = (this->*step)(); !done) return done.error();
  }
  return result();
}

// Spans with less than `seen_fraction` of the mean weight are stiffened by a factor of up to
// `unseen_fairness`.
constexpr double seen_fraction = 0.3, unseen_fairness = 3.0;
constexpr std::size_t pole_columns = 3;
constexpr double least_pole_size = 0.02;

// Candidates for the fairness, as multiples of the least fairness.
constexpr std::array fairness_factors{1.0, 3.0, 10.0, 30.0, 100.0, 300.0};
// Every fourth point, on average, is held out of the fit for cross-validation.
constexpr std::size_t held_out_stride = 4;
// Largest allowed ratio of the error at held-out points to the smallest such error of all candidates. The
// largest fairness within this ratio is chosen.
constexpr double most_error_ratio = 1.03;

// Sets the fairness of all spans. Spans with few data get up to `unseen_fairness` times the given fairness.
// Small spans around a pole get less.
void SurfaceFitter::set_fairness(double fairness, const FittedData& data) {
  const std::size_t u_spans = span_count(structure_.u), v_spans = span_count(structure_.v);
  std::vector<double> weight(u_spans * v_spans, 0.0);
  const std::vector<double> u_breaks = structure_.u.breakpoints(), v_breaks = structure_.v.breakpoints();
  const auto find_span = [](const std::vector<double>& breaks, double at) {
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    return static_cast<std::size_t>(above - breaks.begin()) - 1;
  };
  double mean = 0.0;
  for (std::size_t p = 0; p + points_->spanning_nodes < data.uv.size(); ++p) {
    if (data.uv[p].hasNaN()) continue;
    const std::size_t span = find_span(u_breaks, structure_.u.into_domain(data.uv[p].x())) * v_spans +
                             find_span(v_breaks, structure_.v.into_domain(data.uv[p].y()));
    weight[span] += data.weights[p];
    mean += data.weights[p] / static_cast<double>(weight.size());
  }
  fairness_.resize(weight.size());
  for (std::size_t t = 0; t < v_spans; ++t) {
    double column = 0.0;
    for (std::size_t s = 0; s < u_spans; ++s) {
      column += weight[s * v_spans + t] / static_cast<double>(u_spans);
    }
    // Spans around a pole are small and have few points, which could not counter the full stiffness.
    const bool is_at_pole = closed() && std::min(t, v_spans - 1 - t) < pole_columns;
    const double size = is_at_pole ? std::clamp(column / mean, least_pole_size, 1.0) : 1.0;
    for (std::size_t s = 0; s < u_spans; ++s) {
      const double seen = std::min(1.0, weight[s * v_spans + t] / (seen_fraction * size * mean));
      fairness_[s * v_spans + t] = fairness * size * std::pow(unseen_fairness, 1.0 - seen);
    }
  }
}

// Chooses the largest fairness whose fit predicts held-out points nearly as well as the best candidate does
// (cross-validation, Craven and Wahba 1979). Noise cannot be predicted, the shape can.
Status SurfaceFitter::choose_fairness(const FittedData& data) {
  set_fairness(least_fairness, data);
  std::vector<double> weights(data.weights.begin(), data.weights.end());
  std::vector<std::size_t> held_out;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    weights[p] *= data.trust[p];
    if (data.uv[p].hasNaN() || weights[p] == 0.0) continue;
    // The index is hashed, because consecutive points may follow each other along a scan line.
    if ((p * 2654435761U >> 7) % held_out_stride != 0) continue;
    if (p + points_->spanning_nodes < weights.size()) held_out.push_back(p);
  }
  std::vector<double> fit_weights = weights;
  for (const std::size_t p : held_out) fit_weights[p] = 0.0;
  const auto surfaces =
      fit_scattered_family(structure_, {data.points_m, data.uv, fit_weights}, fairness_, fairness_factors);
  if (!surfaces) return surfaces.error();
  std::array<double, fairness_factors.size()> errors{};
  for (std::size_t k = 0; k < fairness_factors.size(); ++k) {
    const Surface& surface = surfaces.value()[k];
    for (const std::size_t p : held_out) {
      const SurfacePoint at = evaluate(surface, data.uv[p].x(), data.uv[p].y());
      const double off = at.du.cross(at.dv).normalized().dot(data.points_m[p] - at.position_m);
      if (std::isfinite(off)) errors[k] += weights[p] * std::abs(off);
    }
  }
  const double least = *std::min_element(errors.begin(), errors.end());
  std::size_t best = fairness_factors.size() - 1;
  while (errors[best] > most_error_ratio * least) --best;
  chosen_fairness_ = fairness_factor_ * least_fairness * fairness_factors[best];
  return {};
}

constexpr double huber_deviations = 3.0;
constexpr double stray_deviations = 5.0, most_strays = 0.15;
constexpr std::size_t stray_neighbours = 15;
// A point whose height differs from its neighbours' heights by at most this fraction of the scan's size is
// not a stray, even if all other points are exactly on the surface.
constexpr double least_stray_fraction = 3e-4;

// Distance beyond an open edge within which points still pull the edge outwards, as a fraction of the scan's
// size.
constexpr double edge_fraction = 0.02;

// Reduces the weights of points that are farther from the surface than nearly all others. At most one point
// in twenty is affected: in early rounds, many large distances mean that the surface is wrong, not the
// points.
void SurfaceFitter::update_trust(FittedData& data) const {
  std::vector<double> sorted(data.distance_m.begin(),
                             data.distance_m.end() - static_cast<std::ptrdiff_t>(points_->spanning_nodes));
  const auto at = [&](double fraction) {
    const auto rank =
        sorted.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), rank, sorted.end());
    return *rank;
  };
  const double reach = std::max(
      {huber_deviations * 1.4826 * at(0.5), at(0.95), 1e-9 * bounding_diagonal_m(points_->scan.points_m)});
  for (std::size_t p = 0; p < data.trust.size(); ++p) {
    const double distance = data.distance_m[p] <= reach ? data.distance_m[p] : off_surface_distance(data, p);
    data.trust[p] = distance <= reach ? 1.0 : reach / distance;
  }
}

// Returns the distance of a point from the surface. A point slightly beyond an open edge should pull the edge
// outwards, so only its distance from the tangent plane counts.
double SurfaceFitter::off_surface_distance(const FittedData& data, std::size_t point) const {
  const Vector2& uv = data.uv[point];
  const auto is_end = [](double parameter) { return parameter <= 0.0 || parameter >= 1.0; };
  const bool at_edge = !closed() && (is_end(uv.y()) || (!periodic() && is_end(uv.x())));
  if (!at_edge || data.distance_m[point] > edge_fraction * bounding_diagonal_m(points_->scan.points_m)) {
    return data.distance_m[point];
  }
  const SurfacePoint at = evaluate(surface_, uv.x(), uv.y());
  return std::abs(at.du.cross(at.dv).normalized().dot(data.points_m[point] - at.position_m));
}

// Sets the trust of a cloud's strays to 0. A stray is a point whose height above the surface differs from the
// heights of its neighbours in (u, v). Where only the surface is wrong, neighbours have similar heights.
void SurfaceFitter::distrust_strays() {
  if (points_->is_mesh) return;
  const Vector2 scale(static_cast<double>(span_count(structure_.u)),
                      static_cast<double>(span_count(structure_.v)));
  const std::size_t count = points_->scan.points_m.size();
  std::vector<Vector3> positions;
  std::vector<double> heights;
  for (std::size_t p = 0; p < count; ++p) {
    const SurfacePoint at = evaluate(surface_, all_.uv[p].x(), all_.uv[p].y());
    const Vector3 normal = at.du.cross(at.dv).normalized();
    positions.emplace_back(all_.uv[p].x() * scale.x(), all_.uv[p].y() * scale.y(), 0.0);
    heights.push_back(normal.dot(all_.points_m[p] - at.position_m));
  }
  const NearestPoints nearest(positions);
  std::vector<NearestPoints::Neighbour> found;
  std::vector<double> near, off(count);
  for (std::size_t p = 0; p < count; ++p) {
    nearest.nearest(positions[p], stray_neighbours, found);
    near.clear();
    for (const NearestPoints::Neighbour& other : found) near.push_back(heights[other.index]);
    const auto median = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), median, near.end());
    off[p] = std::abs(heights[p] - *median);
  }
  std::vector<double> sorted = off;
  const auto median = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), median, sorted.end());
  const double reach = std::max(stray_deviations * 1.4826 * *median,
                                least_stray_fraction * bounding_diagonal_m(points_->scan.points_m));
  const auto strays = std::count_if(off.begin(), off.end(), [&](double height) { return height > reach; });
  // If more than the fraction most_strays of the points are strays, the surface cannot follow the data.
  if (static_cast<double>(strays) > most_strays * static_cast<double>(count)) return;
  for (std::size_t p = 0; p < count; ++p) {
    if (off[p] > reach) all_.trust[p] = 0.0;
  }
}

constexpr int fold_rounds = 30, cusp_rounds = 60;
// Numbers of relaxation rounds to try. Relaxing untangles crossed parameters, but displaces parameters that
// do not cross.
constexpr std::array relaxation_rounds{10, 0};
constexpr double most_fairness = 10.0;
// Largest factor by which the removal of cusps may increase the error of a surface without folds.
constexpr double most_smoothing_ratio = 1.2;
constexpr double unlimited = std::numeric_limits<double>::infinity();

// Returns a flag for each span, true for spans with folds. If no span has folds, the flags are true for spans
// with cusps, which are a lesser fault.
const std::vector<bool>& SurfaceFitter::faulty_spans() const {
  return folds_.folds > 0 ? folds_.span_folds : folds_.span_cusps;
}

void SurfaceFitter::stiffen_faulty_spans() {
  const auto u_spans = static_cast<int>(span_count(structure_.u));
  const auto v_spans = static_cast<int>(span_count(structure_.v));
  for (int s = 0; s < u_spans; ++s) {
    for (int t = 0; t < v_spans; ++t) {
      if (!faulty_spans()[static_cast<std::size_t>(s * v_spans + t)]) continue;
      for (int ds = -1; ds <= 1; ++ds) {
        for (int dt = -1; dt <= 1; ++dt) {
          const int row = periodic() ? (s + ds + u_spans) % u_spans : s + ds, column = t + dt;
          if (row < 0 || row >= u_spans || column < 0 || column >= v_spans) continue;
          double& fairness = fairness_[static_cast<std::size_t>(row * v_spans + column)];
          fairness = std::min(most_fairness, fairness * (ds == 0 && dt == 0 ? 4.0 : 2.0));
        }
      }
    }
  }
}

// Moves the parameters of nodes in faulty spans, and in the spans next to them, towards the mean of their
// neighbours' parameters. In a harmonic map every node is at this mean, and no parameters cross.
void SurfaceFitter::relax_faulty_spans(int rounds) {
  const PointGraph& graph = points_->graph;
  const std::size_t count = points_->scan.points_m.size(), spanning = points_->spanning_nodes;
  std::vector<std::vector<std::uint32_t>> node_points(graph.size());
  for (std::uint32_t p = 0; p < count; ++p) node_points[points_->node_index[p]].push_back(p);
  for (std::uint32_t k = 0; k < spanning; ++k) {
    node_points[graph.size() - spanning + k].push_back(static_cast<std::uint32_t>(count) + k);
  }
  // The parameters of a node are the parameters of its first point.
  const auto first_point = [&](std::uint32_t node) {
    return node_points[node].empty() ? no_point : node_points[node].front();
  };
  std::vector<std::uint32_t> folded;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    if (first_point(n) != no_point && is_in_faulty_span(all_.uv[first_point(n)])) folded.push_back(n);
  }
  for (int round = 0; round < rounds; ++round) {
    for (const std::uint32_t n : folded) {
      const Vector2 before = all_.uv[first_point(n)];
      Vector2 shift = Vector2::Zero();
      double near = 0.0;
      for (const std::uint32_t other : graph.adjacent(n)) {
        if (first_point(other) == no_point) continue;
        Vector2 offset = all_.uv[first_point(other)] - before;
        if (periodic()) offset.x() = wrapped(offset.x());
        shift += offset;
        near += 1.0;
      }
      if (near == 0.0) continue;
      for (const std::uint32_t p : node_points[n])
        all_.uv[p] = clamp_to_domain(all_.uv[p] + 0.7 / near * shift);
    }
  }
}

bool SurfaceFitter::is_in_faulty_span(const Vector2& uv) const {
  const auto find_span = [](const std::vector<double>& breaks, double at) {
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    return static_cast<std::size_t>(above - breaks.begin()) - 1;
  };
  const std::vector<double>&u = u_breaks_, &v = v_breaks_;
  const std::size_t columns = v.size() - 1, rows = u.size() - 1;
  const std::size_t row = find_span(u, uv.x()), column = find_span(v, uv.y());
  for (std::size_t s = row + rows - 1; s <= row + rows + 1; ++s) {
    for (std::size_t t = column == 0 ? 0 : column - 1; t <= std::min(columns - 1, column + 1); ++t) {
      if (faulty_spans()[s % rows * columns + t]) return true;
    }
  }
  return false;
}

// Clamps v to [0, 1]. Wraps u into [0, 1) if it is periodic, and otherwise clamps it too.
Vector2 SurfaceFitter::clamp_to_domain(Vector2 uv) const {
  uv.y() = std::clamp(uv.y(), 0.0, 1.0);
  uv.x() = periodic() ? uv.x() - std::floor(uv.x()) : std::clamp(uv.x(), 0.0, 1.0);
  return uv;
}

double SurfaceFitter::percentile_error() const {
  return percentile_95(std::span(all_.distance_m).first(points_->scan.points_m.size()));
}

Status SurfaceFitter::unfold() {
  u_breaks_ = structure_.u.breakpoints();
  v_breaks_ = structure_.v.breakpoints();
  project(all_, false);
  folds_ = check_folds(surface_, {all_.uv, all_normals_});
  const Folding folded{surface_, folds_, all_.uv, fairness_};
  std::optional<Folding> best;
  FitQuality best_quality{};
  for (const int relaxation : relaxation_rounds) {
    restore(folded);
    if (Status done = unfold(relaxation); !done) return done;
    project(all_, false);
    const FitQuality quality{folds_.folds, folds_.cusps, percentile_error()};
    if (!best || quality.is_better_than(best_quality)) {
      best = Folding{surface_, folds_, all_.uv, fairness_};
      best_quality = quality;
    }
    if (folds_.is_clean()) break;
  }
  restore(*best);
  return {};
}

void SurfaceFitter::restore(const Folding& folding) {
  surface_ = folding.surface;
  folds_ = folding.folds;
  all_.uv = folding.uv;
  fairness_ = folding.fairness;
}

Status SurfaceFitter::unfold(int relaxation) {
  Surface least_folded = surface_;
  FoldCheck least = folds_;
  std::vector<Vector2> least_uv = all_.uv;
  double error_limit = least.folds > 0 ? unlimited : most_smoothing_ratio * percentile_error();
  const auto rounds = [&] { return least.folds > 0 ? fold_rounds : least.cusps > 0 ? cusp_rounds : 0; };
  for (int round = 0; round < rounds(); ++round) {
    stiffen_faulty_spans();
    relax_faulty_spans(relaxation);
    if (Status solved = solve(all_); !solved) return solved;
    if (round % 2 == 1) project(all_, false);
    folds_ = check_folds(surface_, {all_.uv, all_normals_});
    if (folds_.is_better_than(least)) {
      if (folds_.folds == 0) {
        project(all_, false);
        if (least.folds > 0) error_limit = most_smoothing_ratio * percentile_error();
        if (percentile_error() > error_limit) break;
      }
      least_folded = surface_;
      least = folds_;
      least_uv = all_.uv;
    }
    if (!report(0.9)) return Error(ErrorCode::cancelled, "stopped before the fit was done");
  }
  surface_ = std::move(least_folded);
  folds_ = std::move(least);
  all_.uv = std::move(least_uv);
  return {};
}

}  // namespace

// Fits the surface several times, with different bounds on the agreement of normals, because the best bound
// differs from scan to scan. A strict bound keeps points in the folds of the initial parameters; a loose
// bound lets points move to the other face of a wall. If all results fold or have large errors, a larger
// fairness is tried.
Result<FittedSurface> fit_surface(const FitPoints& points, const Parameterisation& start,
                                  const FitSettings& settings) {
  SPOONBILL_ASSERT(start.uv.size() == points.graph.size());
  SPOONBILL_ASSERT(settings.tolerance_m >= 0.0);
  struct Trial {
    double agreement, fairness_factor;
    std::size_t cusps;      // largest number of cusps of an accepted result, which has no folds
    double error_fraction;  // limit for the error of an accepted result, relative to the scan's size
  };
  constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
  constexpr std::array trials{Trial{0.0, 1.0, 0, 0.005}, Trial{-0.3, 1.0, 0, 0.005},
                              Trial{-1.0, 1.0, any, 0.01}, Trial{0.0, 4.0, any, 0.01},
                              Trial{-1.0, 4.0, any, 0.01}};
  const double size_m = bounding_diagonal_m(points.scan.points_m);
  FitSettings watched = settings;
  double reported = 0.0;
  watched.progress = Progress([&](double fraction) {
    reported = std::max(reported, fraction);
    return settings.progress.report(reported);
  });
  std::optional<FittedSurface> best;
  FitQuality quality{};
  for (const Trial& trial : trials) {
    if (trial.agreement != 0.0 && points.scan.normals.empty()) continue;
    auto fitted = SurfaceFitter(points, start, watched, trial.agreement, trial.fairness_factor).run();
    if (!fitted) return fitted.error();
    const FitQuality found{fitted->folds.folds, fitted->folds.cusps,
                           percentile_error(fitted.value(), points)};
    if (!best || found.is_better_than(quality)) {
      best = std::move(fitted).value();
      quality = found;
    }
    const bool is_near = quality.error_m < trial.error_fraction * size_m;
    if (quality.folds == 0 && quality.cusps <= trial.cusps && is_near) break;
  }
  return *std::move(best);
}

}  // namespace spoonbill
