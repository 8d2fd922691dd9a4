#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/fitting/refine_knots.h"
#include "engine/fitting/surface_fitter.h"

namespace spoonbill {

namespace {

constexpr int fold_rounds = 30, cusp_rounds = 60;
// Parameters that cross are untangled by relaxing them; where they do not cross, that only leads them away.
constexpr std::array relaxing_rounds{10, 0};
constexpr double most_fairness = 10.0;
// What the removal of cusps may cost, against what removed the folds.
constexpr double error_of_smoothing = 1.2;
constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

// Cusps wait until nothing folds: they are the smaller fault.
const std::vector<bool>& SurfaceFitter::faulty_spans() const {
  return folds_.folds > 0 ? folds_.span_folds : folds_.span_cusps;
}

void SurfaceFitter::stiffen_folds() {
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

// Parameters of points in spans that fold, moved towards the means of their neighbours': as in the harmonic
// map that they come from, where none crosses another.
void SurfaceFitter::relax_folds(int rounds) {
  const PointGraph& graph = points_->graph;
  const std::size_t count = points_->scan.points_m.size(), spanning = points_->spanning_nodes;
  std::vector<std::vector<std::uint32_t>> of_node(graph.size());
  for (std::uint32_t p = 0; p < count; ++p) of_node[points_->node_of[p]].push_back(p);
  for (std::uint32_t k = 0; k < spanning; ++k) {
    of_node[graph.size() - spanning + k].push_back(static_cast<std::uint32_t>(count) + k);
  }
  // A node lies where its first point does.
  const auto place = [&](std::uint32_t node) {
    return of_node[node].empty() ? no_point : of_node[node].front();
  };
  std::vector<std::uint32_t> folded;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    if (place(n) != no_point && in_folded_span(all_.uv[place(n)])) folded.push_back(n);
  }
  for (int round = 0; round < rounds; ++round) {
    for (const std::uint32_t n : folded) {
      const Vector2 before = all_.uv[place(n)];
      Vector2 shift = Vector2::Zero();
      double near = 0.0;
      for (const std::uint32_t other : graph.of(n)) {
        if (place(other) == no_point) continue;
        Vector2 way = all_.uv[place(other)] - before;
        if (periodic()) way.x() = wrapped(way.x());
        shift += way;
        near += 1.0;
      }
      if (near == 0.0) continue;
      for (const std::uint32_t p : of_node[n]) all_.uv[p] = kept_inside(all_.uv[p] + 0.7 / near * shift);
    }
  }
}

bool SurfaceFitter::in_folded_span(const Vector2& uv) const {
  const auto span_of = [](const std::vector<double>& breaks, double at) {
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    return static_cast<std::size_t>(above - breaks.begin()) - 1;
  };
  const std::vector<double>&u = u_breaks_, &v = v_breaks_;
  const std::size_t columns = v.size() - 1, rows = u.size() - 1;
  const std::size_t row = span_of(u, uv.x()), column = span_of(v, uv.y());
  for (std::size_t s = row + rows - 1; s <= row + rows + 1; ++s) {
    for (std::size_t t = column == 0 ? 0 : column - 1; t <= std::min(columns - 1, column + 1); ++t) {
      if (faulty_spans()[s % rows * columns + t]) return true;
    }
  }
  return false;
}

// Wrapped in u where it is periodic, else on the nearest edge.
Vector2 SurfaceFitter::kept_inside(Vector2 uv) const {
  uv.y() = std::clamp(uv.y(), 0.0, 1.0);
  uv.x() = periodic() ? uv.x() - std::floor(uv.x()) : std::clamp(uv.x(), 0.0, 1.0);
  return uv;
}

double SurfaceFitter::usual_error() const {
  return ninety_fifth(std::span(all_.distance_m).first(points_->scan.points_m.size()));
}

Status SurfaceFitter::unfold() {
  u_breaks_ = structure_.u.breakpoints();
  v_breaks_ = structure_.v.breakpoints();
  project(all_, false);
  folds_ = check_folds(surface_, {all_.uv, all_normals_});
  const Folding folded{surface_, folds_, all_.uv, fairness_};
  std::optional<Folding> best;
  FitQuality best_quality{};
  for (const int relaxing : relaxing_rounds) {
    take(folded);
    if (Status done = unfold(relaxing); !done) return done;
    project(all_, false);
    const FitQuality quality{folds_.folds, folds_.cusps, usual_error()};
    if (!best || quality.better_than(best_quality)) {
      best = Folding{surface_, folds_, all_.uv, fairness_};
      best_quality = quality;
    }
    if (folds_.is_clean()) break;
  }
  take(*best);
  return {};
}

void SurfaceFitter::take(const Folding& folding) {
  surface_ = folding.surface;
  folds_ = folding.folds;
  all_.uv = folding.uv;
  fairness_ = folding.fairness;
}

Status SurfaceFitter::unfold(int relaxing) {
  Surface least_folded = surface_;
  FoldCheck least = folds_;
  std::vector<Vector2> least_uv = all_.uv;
  double error_limit = least.folds > 0 ? unlimited : error_of_smoothing * usual_error();
  const auto rounds = [&] { return least.folds > 0 ? fold_rounds : least.cusps > 0 ? cusp_rounds : 0; };
  for (int round = 0; round < rounds(); ++round) {
    stiffen_folds();
    relax_folds(relaxing);
    if (Status solved = solve(all_); !solved) return solved;
    if (round % 2 == 1) project(all_, false);
    folds_ = check_folds(surface_, {all_.uv, all_normals_});
    if (folds_.better_than(least)) {
      if (folds_.folds == 0) {
        project(all_, false);
        if (least.folds > 0) error_limit = error_of_smoothing * usual_error();
        if (usual_error() > error_limit) break;
      }
      least_folded = surface_;
      least = folds_;
      least_uv = all_.uv;
    }
    if (!report(0.9)) return Error{"stopped before the fit was done"};
  }
  surface_ = std::move(least_folded);
  folds_ = std::move(least);
  all_.uv = std::move(least_uv);
  return {};
}

}  // namespace spoonbill
