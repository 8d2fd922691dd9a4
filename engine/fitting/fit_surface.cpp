#include "engine/fitting/fit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/fitting/closest_parameters.h"
#include "engine/fitting/estimated_normals.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/outer_side.h"
#include "engine/fitting/refine_knots.h"
#include "engine/fitting/surface_fitter.h"
#include "engine/inspection/mass_properties.h"

namespace spoonbill {
namespace {

constexpr int degree = 3;
constexpr int first_controls = 10;
constexpr double growth = 1.35;
constexpr double first_fairness = 1e-2;
constexpr int point_round_count = 3;
// Of a node that spans a hole, against the others': it is a guess.
constexpr double spanning_weight = 0.15;
constexpr double pole_weight = 0.5;  // of a pole, in spans' worth of points

const ClosestPoint& nearer(const ClosestPoint& one, const ClosestPoint& other) {
  return other.distance_m < one.distance_m ? other : one;
}

// The distance within which 95 % of the points given are, strays left out.
double usual_error(const FittedSurface& fitted, const FitPoints& points) {
  std::vector<double> distances;
  for (const std::uint32_t point : points.stands_for) {
    if (point != no_point && fitted.trust[point] > 0.0) distances.push_back(fitted.distance_m[point]);
  }
  return ninety_fifth(distances);
}

KnotVector first_knots(bool is_periodic, int count) {
  return is_periodic ? KnotVector::periodic_uniform(degree, std::max(count, degree)).value()
                     : KnotVector::clamped_uniform(degree, std::max(count, degree + 1)).value();
}

// Over [0, 1], whatever period the uniform knots have.
KnotVector over_unit(const KnotVector& knots) {
  std::vector<double> scaled = knots.knots();
  const double start = knots.domain_start(), length = knots.domain_end() - start;
  for (double& knot : scaled) knot = (knot - start) / length;
  return knots.is_periodic() ? KnotVector::periodic(degree, std::move(scaled)).value()
                             : KnotVector::open(degree, std::move(scaled)).value();
}

}  // namespace

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
    node_weights_[points.node_of[p]] += points.weights[p];
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
  if (closed()) take_poles();
}

Status SurfaceFitter::solve(FittedData& data) {
  std::vector<double> weights(data.weights.begin(), data.weights.end());
  for (std::size_t p = 0; p < weights.size(); ++p) weights[p] *= data.trust[p];
  std::vector<Vector3> points(data.points_m.begin(), data.points_m.end());
  std::vector<Vector2> uv = data.uv;
  const double span_weight =
      std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(fairness_.size());
  for (const auto& [place, v] : poles_) {
    points.push_back(place);
    uv.emplace_back(0.0, v);
    weights.push_back(pole_weight * span_weight);
  }
  auto surface = fit_scattered(structure_, {points, uv, weights}, fairness_);
  if (!surface) return surface.error();
  surface_ = std::move(surface).value();
  return {};
}

// Where the poles were at first: else the surface may reach beyond the points there.
void SurfaceFitter::take_poles() {
  constexpr double near = 0.02;
  for (const double v : {0.0, 1.0}) {
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    bool exact = false;
    for (std::size_t n = 0; n < nodes_.uv.size(); ++n) {
      const double away = std::abs(nodes_.uv[n].y() - v);
      if (exact || !(away < near)) continue;  // also NaN
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
    for (const std::uint32_t other : points_->graph.of(n)) {
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

// Nodes that span holes may: their normals are guesses.
bool SurfaceFitter::may_go_to(const FittedData& data, std::size_t point, const Vector2& uv) const {
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
                                   ? closest.anywhere(data.points_m[p], projection_steps)
                                   : closest.from(data.points_m[p], before[p], projection_steps);
    if (before[p].hasNaN() || may_go_to(data, p, found.uv)) {
      data.uv[p] = found.uv;
      data.distance_m[p] = found.distance_m;
    } else {
      data.distance_m[p] = closest.from(data.points_m[p], before[p], 0).distance_m;
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

// More control points; false where there are enough.
bool SurfaceFitter::grow() {
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
  structure_.u = with_knots_for_errors(structure_.u, 0, next(u, settings_->control_u), nodes_.uv, squares);
  structure_.v = with_knots_for_errors(structure_.v, 1, next(v, settings_->control_v), nodes_.uv, squares);
  return true;
}

// Against the normals of what was scanned (those of nodes that span holes may face either way) or, without
// them, against the inside of a closed shape, or the side of an open one that is taken to be out.
bool SurfaceFitter::faces_inwards() const {
  double along = 0.0;
  for (std::size_t n = 0; n + points_->spanning_nodes < nodes_.uv.size(); ++n) {
    if (nodes_.uv[n].hasNaN()) continue;
    const SurfacePoint at = evaluate(surface_, nodes_.uv[n].x(), nodes_.uv[n].y());
    const Vector3 normal = at.du.cross(at.dv).normalized();
    if (normal.allFinite()) along += normal.dot(points_->node_normals[n]);
  }
  if (along != 0.0) return along < 0.0;
  return closed() ? compute_enclosed_mass(surface_).volume_m3 < 0.0 : faces_inner_side(surface_);
}

// The first rounds of a thin wall may enclose less than nothing.
Status SurfaceFitter::face_outwards() {
  if (!closed() || compute_enclosed_mass(surface_).volume_m3 >= 0.0) return {};
  surface_ = reversed(surface_, Direction::u);
  for (Vector2& uv : all_.uv) uv.x() = 1.0 - uv.x();
  folds_ = check_folds(surface_, {all_.uv, all_normals_});
  return {};
}

Status SurfaceFitter::node_rounds() {
  set_fairness(first_fairness, nodes_);
  if (Status solved = solve(nodes_); !solved) return solved;
  if (faces_inwards()) {
    for (Vector2& uv : nodes_.uv) uv.x() = 1.0 - uv.x();
  }
  double fairness = first_fairness;
  int stage = 0;
  do {
    for (int round = 0; round < 3; ++round) {
      set_fairness(fairness, nodes_);
      if (Status solved = solve(nodes_); !solved) return solved;
      project(nodes_, true);
      if (stage > 0) take_trust(nodes_);
      fairness = std::max(fairness_factor_ * least_fairness, 0.6 * fairness);
    }
    ++stage;
    if (!report(0.1 * std::min(stage, 6))) return Error{"stopped before the fit was done"};
  } while (grow());
  return {};
}

Status SurfaceFitter::point_rounds() {
  const std::size_t spanning = points_->spanning_nodes, node_count = points_->graph.size();
  all_points_m_ = points_->scan.points_m;
  all_weights_ = points_->weights;
  double mean = 0.0;
  for (const double weight : all_weights_) mean += weight / static_cast<double>(all_weights_.size());
  for (const std::uint32_t node : points_->node_of) all_.uv.push_back(nodes_.uv[node]);
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
    take_trust(all_);
    if (round > 0) distrust_strays();
    if (round == 0) {
      if (Status chosen = choose_fairness(all_); !chosen) return chosen;
    }
    set_fairness(chosen_fairness_, all_);
    if (Status solved = solve(all_); !solved) return solved;
    if (!report(0.7 + 0.05 * round)) return Error{"stopped before the fit was done"};
  }
  return {};
}

// What was held in place, or slid to a place that is nearest only about itself, is measured from anywhere.
// Estimated normals tell of folds, but do not lead what mends them: on thin walls some are of the other face.
FittedSurface SurfaceFitter::result() {
  const std::size_t count = points_->scan.points_m.size();
  all_.uv.resize(count);
  all_.distance_m.resize(count);
  all_.trust.resize(count);
  const ClosestParameters closest(surface_);
  for (std::size_t p = 0; p < all_.uv.size(); ++p) {
    const ClosestPoint found = nearer(closest.from(all_.points_m[p], all_.uv[p], projection_steps),
                                      closest.anywhere(all_.points_m[p], projection_steps));
    all_.uv[p] = found.uv;
    all_.distance_m[p] = found.distance_m;
  }
  if (all_normals_.empty()) {
    const std::vector<Vector3> estimated = estimated_normals(*points_, surface_, all_.uv);
    folds_ = check_folds(surface_, {all_.uv, estimated, true});
  }
  return {std::move(surface_), std::move(all_.uv), std::move(all_.distance_m), std::move(all_.trust),
          std::move(folds_)};
}

Result<FittedSurface> SurfaceFitter::run() {
  for (const auto step : {&SurfaceFitter::node_rounds, &SurfaceFitter::point_rounds, &SurfaceFitter::unfold,
                          &SurfaceFitter::face_outwards}) {
    if (Status done = (this->*step)(); !done) return done.error();
  }
  return result();
}

// Which agreement of normals serves best differs from scan to scan: a firm one holds points in folds of the
// first parameters, a loose one lets them slip to the other face. Where all fold or are far off, so does
// which fairness.
Result<FittedSurface> fit_surface(const FitPoints& points, const Parameterisation& start,
                                  const FitSettings& settings) {
  SPOONBILL_ASSERT(start.uv.size() == points.graph.size());
  SPOONBILL_ASSERT(settings.tolerance_m >= 0.0);
  struct Trial {
    double agreement, fairness_factor;
    std::size_t cusps;   // no more trials where there are no more of them, no folds,
    double error_share;  // and the error is below this share of the size
  };
  constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
  constexpr std::array trials{Trial{0.0, 1.0, 0, 0.005}, Trial{-0.3, 1.0, 0, 0.005},
                              Trial{-1.0, 1.0, any, 0.01}, Trial{0.0, 4.0, any, 0.01},
                              Trial{-1.0, 4.0, any, 0.01}};
  const double size_m = size_of(points.scan.points_m);
  FitSettings watched = settings;
  double told = 0.0;
  watched.progress = Progress([&](double fraction) {
    told = std::max(told, fraction);
    return settings.progress.report(told);
  });
  std::optional<FittedSurface> best;
  FitQuality quality{};
  for (const Trial& trial : trials) {
    if (trial.agreement != 0.0 && points.scan.normals.empty()) continue;
    auto fitted = SurfaceFitter(points, start, watched, trial.agreement, trial.fairness_factor).run();
    if (!fitted) return fitted.error();
    const FitQuality found{fitted->folds.folds, fitted->folds.cusps, usual_error(fitted.value(), points)};
    if (!best || found.better_than(quality)) {
      best = std::move(fitted).value();
      quality = found;
    }
    const bool is_near = quality.error_m < trial.error_share * size_m;
    if (quality.folds == 0 && quality.cusps <= trial.cusps && is_near) break;
  }
  return *std::move(best);
}

}  // namespace spoonbill
