#include "engine/merging/nearly_same_knots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"

namespace spoonbill {

namespace {

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

// Distinct ones; of a period without its end.
std::vector<double> knots_once(const KnotVector& knots) {
  std::vector<double> all = knots.breakpoints();
  if (knots.is_periodic()) all.pop_back();
  return all;
}

double nearer(double a, double b) {
  return std::abs(a) <= std::abs(b) ? a : b;
}

double nearest_to(const std::vector<double>& sorted, double knot) {
  const auto after = std::lower_bound(sorted.begin(), sorted.end(), knot);
  if (after == sorted.begin()) return *after;
  if (after == sorted.end()) return sorted.back();
  return std::abs(*after - knot) < std::abs(after[-1] - knot) ? *after : after[-1];
}

// For each knot of `from` inside the domain where it is to go: to the one of `to` that it nearly is, if no
// other of them is nearer to that.
std::vector<std::pair<double, double>> moves_between(const KnotVector& from, const KnotVector& to) {
  const std::vector<double> own = from.breakpoints(), wanted = to.breakpoints();
  const double reach = nearly_same_share * length_of(from);
  std::vector<std::pair<double, double>> moves;
  for (std::size_t k = 1; k + 1 < own.size(); ++k) {
    const double target = nearest_to(wanted, own[k]);
    const bool is_end = target == wanted.front() || target == wanted.back();
    if (is_end || target == own[k] || std::abs(target - own[k]) > reach) continue;
    if (nearest_to(own, target) == own[k]) moves.emplace_back(own[k], target);
  }
  return moves;
}

}  // namespace

double seam_at_nearly_same_knots(const KnotVector& first, const KnotVector& second, double seam) {
  SPOONBILL_ASSERT(first.is_periodic() && second.is_periodic());
  const double length = length_of(second);
  const auto apart = [&](double of_second, double of_first) {
    const double step = (of_second - seam) - (of_first - first.domain_start());
    return step - length * std::round(step / length);
  };
  const std::vector<double> of_first = knots_once(first), of_second = knots_once(second);
  double at_seam = std::numeric_limits<double>::infinity(), anywhere = at_seam;
  for (const double b : of_second) {
    at_seam = nearer(at_seam, apart(b, first.domain_start()));
    for (const double a : of_first) anywhere = nearer(anywhere, apart(b, a));
  }
  const double reach = nearly_same_share * length;
  if (std::abs(at_seam) <= reach) return seam + at_seam;
  return std::abs(anywhere) <= reach ? seam + anywhere : seam;
}

MovedKnots with_nearly_same_knots(const Surface& surface, const KnotVector& knots, double most_m) {
  const auto moves = moves_between(surface.u, knots);
  if (moves.empty()) return {surface, 0.0};
  std::vector<double> moved = surface.u.knots();
  for (double& knot : moved) {
    const auto move =
        std::find_if(moves.begin(), moves.end(), [&](const auto& pair) { return pair.first == knot; });
    if (move != moves.end()) knot = move->second;
  }
  auto u = surface.u.is_periodic() ? KnotVector::periodic(surface.u.degree(), std::move(moved))
                                   : KnotVector::open(surface.u.degree(), std::move(moved));
  if (!u) return {surface, 0.0};
  MovedKnots result{{std::move(u).value(), surface.v, surface.net}, 0.0};
  constexpr int samples_in_piece = 5;
  result.deviation_m = largest_deviation_m(
      result.surface, sample_grid_points(surface, nested_parameters(surface.u, samples_in_piece, 0).parameters,
                                 nested_parameters(surface.v, samples_in_piece, 0).parameters));
  return result.deviation_m <= most_m ? result : MovedKnots{surface, 0.0};
}

}  // namespace spoonbill
