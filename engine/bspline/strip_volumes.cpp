#include "engine/bspline/strip_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

struct GaussPoint {
  double parameter, weight;
};

// Returns the points of the Gauss-Legendre rule with five points on each interval between breaks. The rule is
// exact for polynomials up to degree 9.
std::vector<GaussPoint> place_gauss_points(std::span<const double> breaks) {
  const double root = std::sqrt(70.0);
  const double inner = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double outer = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const std::array<double, 5> nodes = {-outer, -inner, 0.0, inner, outer};
  const double inner_weight = (322.0 + 13.0 * root) / 900.0, outer_weight = (322.0 - 13.0 * root) / 900.0;
  const std::array<double, 5> weights = {outer_weight, inner_weight, 128.0 / 225.0, inner_weight,
                                         outer_weight};
  std::vector<GaussPoint> points;
  points.reserve(nodes.size() * breaks.size());
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    const double half = 0.5 * (breaks[b + 1] - breaks[b]);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      points.push_back({breaks[b] + half * (1.0 + nodes[n]), half * weights[n]});
    }
  }
  return points;
}

// Returns the ends of an interval and the breakpoints between them.
std::vector<double> split_at_breakpoints(const std::vector<double>& breakpoints, double from, double to) {
  std::vector<double> result = {from};
  std::copy_if(breakpoints.begin(), breakpoints.end(), std::back_inserter(result),
               [&](double at) { return at > from && at < to; });
  result.push_back(to);
  return result;
}

}  // namespace

std::vector<double> compute_strip_volumes_m3(const Surface& surface, std::span<const double> v,
                                             const Vector3& apex_m) {
  SPOONBILL_ASSERT(std::is_sorted(v.begin(), v.end()));
  const std::vector<GaussPoint> in_u = place_gauss_points(surface.u.breakpoints());
  const std::vector<double> v_breakpoints = surface.v.breakpoints();
  std::vector<double> volumes;
  for (std::size_t s = 0; s + 1 < v.size(); ++s) {
    double volume = 0.0;
    for (const GaussPoint& at_v : place_gauss_points(split_at_breakpoints(v_breakpoints, v[s], v[s + 1]))) {
      for (const GaussPoint& at_u : in_u) {
        const SurfacePoint point = evaluate(surface, at_u.parameter, at_v.parameter);
        volume += at_u.weight * at_v.weight * (point.position_m - apex_m).dot(point.du.cross(point.dv)) / 3.0;
      }
    }
    volumes.push_back(volume);
  }
  return volumes;
}

double compute_closed_volume_m3(const Surface& surface) {
  const std::array<double, 2> whole = {surface.v.domain_start(), surface.v.domain_end()};
  return compute_strip_volumes_m3(surface, whole, surface.net.point(0, 0)).front();
}

}  // namespace spoonbill
