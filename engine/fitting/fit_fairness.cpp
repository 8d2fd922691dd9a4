#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/fitting/surface_fitter.h"

namespace spoonbill {

namespace {

// A span with less than this share of the mean's data is stiffened, by up to this factor.
constexpr double seen_share = 0.3, unseen_fairness = 3.0;
constexpr std::size_t pole_columns = 3;
constexpr double least_pole_size = 0.02;

// Fairness that is tried, times the least.
constexpr std::array tried{1.0, 3.0, 10.0, 30.0, 100.0, 300.0};
// Every so manieth point is left out, and asked afterwards.
constexpr std::size_t asked_stride = 4;
// Fairer is better where it costs no more of what the points left out tell.
constexpr double error_of_fairness = 1.03;

}  // namespace

// More where there is little data: all of it where there is none.
void SurfaceFitter::set_fairness(double fairness, const FittedData& data) {
  const std::size_t u_spans = span_count(structure_.u), v_spans = span_count(structure_.v);
  std::vector<double> weight(u_spans * v_spans, 0.0);
  const std::vector<double> u_breaks = structure_.u.breakpoints(), v_breaks = structure_.v.breakpoints();
  const auto span_of = [](const std::vector<double>& breaks, double at) {
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    return static_cast<std::size_t>(above - breaks.begin()) - 1;
  };
  double mean = 0.0;
  for (std::size_t p = 0; p + points_->spanning_nodes < data.uv.size(); ++p) {
    if (data.uv[p].hasNaN()) continue;
    const std::size_t span = span_of(u_breaks, structure_.u.into_domain(data.uv[p].x())) * v_spans +
                             span_of(v_breaks, structure_.v.into_domain(data.uv[p].y()));
    weight[span] += data.weights[p];
    mean += data.weights[p] / static_cast<double>(weight.size());
  }
  fairness_.resize(weight.size());
  for (std::size_t t = 0; t < v_spans; ++t) {
    double column = 0.0;
    for (std::size_t s = 0; s < u_spans; ++s) {
      column += weight[s * v_spans + t] / static_cast<double>(u_spans);
    }
    // Spans about a pole are small, and have few points to hold them against their stiffness.
    const bool at_pole = closed() && std::min(t, v_spans - 1 - t) < pole_columns;
    const double size = at_pole ? std::clamp(column / mean, least_pole_size, 1.0) : 1.0;
    for (std::size_t s = 0; s < u_spans; ++s) {
      const double seen = std::min(1.0, weight[s * v_spans + t] / (seen_share * size * mean));
      fairness_[s * v_spans + t] = fairness * size * std::pow(unseen_fairness, 1.0 - seen);
    }
  }
}

// The fairest of those that tell of points which they were not fitted to nearly as well as the best: noise
// cannot be told, a shape can (cross-validation, Craven and Wahba 1979).
Status SurfaceFitter::choose_fairness(const FittedData& data) {
  set_fairness(least_fairness, data);
  std::vector<double> weights(data.weights.begin(), data.weights.end());
  std::vector<std::size_t> asked;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    weights[p] *= data.trust[p];
    if (data.uv[p].hasNaN() || weights[p] == 0.0) continue;
    if ((p * 2654435761U >> 7) % asked_stride != 0) continue;  // scattered, for scans run along lines
    if (p + points_->spanning_nodes < weights.size()) asked.push_back(p);
  }
  std::vector<double> told = weights;
  for (const std::size_t p : asked) told[p] = 0.0;
  const auto surfaces = fit_scattered_at(structure_, {data.points_m, data.uv, told}, fairness_, tried);
  if (!surfaces) return surfaces.error();
  std::array<double, tried.size()> errors{};
  for (std::size_t k = 0; k < tried.size(); ++k) {
    const Surface& surface = surfaces.value()[k];
    for (const std::size_t p : asked) {
      const SurfacePoint at = evaluate(surface, data.uv[p].x(), data.uv[p].y());
      const double off = at.du.cross(at.dv).normalized().dot(data.points_m[p] - at.position_m);
      if (std::isfinite(off)) errors[k] += weights[p] * std::abs(off);
    }
  }
  const double least = *std::min_element(errors.begin(), errors.end());
  std::size_t best = tried.size() - 1;
  while (errors[best] > error_of_fairness * least) --best;
  chosen_fairness_ = fairness_factor_ * least_fairness * tried[best];
  return {};
}

}  // namespace spoonbill
