#include "engine/fitting/closest_parameters.h"

#include <algorithm>
#include <cmath>

#include "engine/fitting/scattered_fit.h"

namespace spoonbill {
namespace {

constexpr int samples_a_span = 3;

std::vector<double> sample_parameters(const KnotVector& knots) {
  const std::vector<double> breaks = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
    for (int k = 0; k < samples_a_span; ++k) {
      parameters.push_back(breaks[s] + (breaks[s + 1] - breaks[s]) * k / samples_a_span);
    }
  }
  if (!knots.is_periodic()) parameters.push_back(breaks.back());
  return parameters;
}

std::vector<Vector2> sample_places(const Surface& surface) {
  std::vector<Vector2> places;
  for (const double u : sample_parameters(surface.u)) {
    for (const double v : sample_parameters(surface.v)) places.emplace_back(u, v);
  }
  return places;
}

std::vector<Vector3> positions(const Surface& surface, const std::vector<Vector2>& places) {
  std::vector<Vector3> points(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) points[k] = position(surface, places[k].x(), places[k].y());
  return points;
}

double half_span(const KnotVector& knots) {
  return 0.75 * (knots.domain_end() - knots.domain_start()) / static_cast<double>(span_count(knots));
}

}  // namespace

ClosestParameters::ClosestParameters(const Surface& surface)
    : surface_(&surface),
      u_(surface.u),
      v_(surface.v),
      longest_step_(half_span(surface.u), half_span(surface.v)),
      samples_(),
      places_(sample_places(surface)),
      nearest_((samples_ = positions(surface, places_), samples_)) {}

Vector3 ClosestParameters::position_at(const Vector2& uv) const {
  return position({surface_, &u_, &v_}, uv.x(), uv.y());
}

ClosestPoint ClosestParameters::from(const Vector3& point, const Vector2& start, int steps) const {
  const PiecewiseSurface piecewise{surface_, &u_, &v_};
  Vector2 uv(surface_->u.into_domain(start.x()), surface_->v.into_domain(start.y()));
  SurfacePoint at = evaluate(piecewise, uv.x(), uv.y());
  double distance = (at.position_m - point).norm();
  for (int step = 0; step < steps; ++step) {
    const Vector3 away = at.position_m - point;
    const double a = at.du.squaredNorm(), b = at.du.dot(at.dv), c = at.dv.squaredNorm();
    const double p = at.du.dot(away), q = at.dv.dot(away);
    // Newton's matrix where it is positive, that of Gauss otherwise.
    double m = a + at.duu.dot(away), n = b + at.duv.dot(away), o = c + at.dvv.dot(away);
    if (!(m > 0.1 * a && o > 0.1 * c && m * o - n * n > 0.1 * (a * c - b * b))) m = a, n = b, o = c;
    const double ridge = 1e-9 * (m + o) + 1e-300;
    m += ridge, o += ridge;
    const double determinant = m * o - n * n;
    if (!(determinant > 0.0)) break;
    Vector2 move(-(o * p - n * q) / determinant, -(m * q - n * p) / determinant);
    const double share =
        std::max(std::abs(move.x()) / longest_step_.x(), std::abs(move.y()) / longest_step_.y());
    if (!std::isfinite(share)) break;
    if (share > 1.0) move /= share;
    bool nearer = false;
    for (int halving = 0; halving < 4 && !nearer; ++halving, move *= 0.5) {
      const Vector2 next(surface_->u.into_domain(uv.x() + move.x()),
                         surface_->v.into_domain(uv.y() + move.y()));
      const double reached = (position_at(next) - point).norm();
      if (reached >= distance) continue;
      nearer = distance - reached > 1e-6 * distance;
      distance = reached;
      uv = next;
      break;
    }
    if (!nearer) break;
    if (step + 1 < steps) at = evaluate(piecewise, uv.x(), uv.y());
  }
  return {uv, distance, position_at(uv)};
}

ClosestPoint ClosestParameters::anywhere(const Vector3& point, int steps) const {
  return from(point, places_[nearest_.nearest(point).index], steps);
}

}  // namespace spoonbill
