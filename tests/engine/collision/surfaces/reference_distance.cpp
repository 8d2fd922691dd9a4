#include "tests/engine/collision/surfaces/reference_distance.h"

#include <algorithm>
#include <array>
#include <limits>
#include <queue>
#include <vector>

namespace spoonbill {
namespace {

struct Ball {
  double u0, u1, v0, v1;
  double speed_u, speed_v;  // bounds of the derivatives over the element that contains the piece
  Vector3 centre;
  double radius;
};

Ball ball_over(const Surface& surface, double u0, double u1, double v0, double v1, double speed_u,
               double speed_v) {
  return {u0,
          u1,
          v0,
          v1,
          speed_u,
          speed_v,
          position(surface, 0.5 * (u0 + u1), 0.5 * (v0 + v1)),
          0.5 * ((u1 - u0) * speed_u + (v1 - v0) * speed_v)};
}

// Returns the largest length of degree * (P[i+1] - P[i]) / (knot[i+degree+1] - knot[i+1]) along u, over the
// control points of one element.
double longest_step_by_u(const KnotVector& u, const KnotVector& v, int span_u, int span_v,
                         const auto& point) {
  const std::vector<double>& knots = u.extended_knots();
  double longest = 0.0;
  for (int a = 0; a < u.degree(); ++a) {
    const double width = knots[span_u + a + 1] - knots[span_u - u.degree() + a + 1];
    for (int b = 0; b <= v.degree(); ++b) {
      const int j = v.control_index(span_v, b);
      const Vector3 step = point(u.control_index(span_u, a + 1), j) - point(u.control_index(span_u, a), j);
      longest = std::max(longest, u.degree() * step.norm() / width);
    }
  }
  return longest;
}

std::vector<Ball> balls_of(const Surface& surface) {
  std::vector<Ball> balls;
  const std::vector<double> us = surface.u.breakpoints(), vs = surface.v.breakpoints();
  for (std::size_t i = 0; i + 1 < us.size(); ++i) {
    for (std::size_t j = 0; j + 1 < vs.size(); ++j) {
      const int span_u = surface.u.find_span(0.5 * (us[i] + us[i + 1]));
      const int span_v = surface.v.find_span(0.5 * (vs[j] + vs[j + 1]));
      const double speed_u = longest_step_by_u(surface.u, surface.v, span_u, span_v,
                                               [&](int a, int b) { return surface.net.point(a, b); });
      const double speed_v = longest_step_by_u(surface.v, surface.u, span_v, span_u,
                                               [&](int a, int b) { return surface.net.point(b, a); });
      balls.push_back(ball_over(surface, us[i], us[i + 1], vs[j], vs[j + 1], speed_u, speed_v));
    }
  }
  return balls;
}

std::array<Ball, 2> halves(const Surface& surface, const Ball& of) {
  const auto part = [&](double u0, double u1, double v0, double v1) {
    return ball_over(surface, u0, u1, v0, v1, of.speed_u, of.speed_v);
  };
  const double u = 0.5 * (of.u0 + of.u1), v = 0.5 * (of.v0 + of.v1);
  if ((of.u1 - of.u0) * of.speed_u > (of.v1 - of.v0) * of.speed_v) {
    return {part(of.u0, u, of.v0, of.v1), part(u, of.u1, of.v0, of.v1)};
  }
  return {part(of.u0, of.u1, of.v0, v), part(of.u0, of.u1, v, of.v1)};
}

struct BallPair {
  Ball a, b;
  double low;
  friend bool operator<(const BallPair& x, const BallPair& y) { return x.low > y.low; }
};

BallPair pair_of(const Ball& a, const Ball& b) {
  return {a, b, (a.centre - b.centre).norm() - a.radius - b.radius};
}

}  // namespace

DistanceBounds reference_distance(const Surface& first, const Surface& second, double share,
                                  double enough_m) {
  std::priority_queue<BallPair> open;
  double high = std::numeric_limits<double>::infinity();
  const auto add = [&](const BallPair& pair) {
    high = std::min(high, (pair.a.centre - pair.b.centre).norm());
    if (pair.low < high) open.push(pair);
  };
  for (const Ball& a : balls_of(first)) {
    for (const Ball& b : balls_of(second)) add(pair_of(a, b));
  }
  while (open.top().low < (1.0 - share) * high && high > enough_m) {
    const BallPair pair = open.top();
    open.pop();
    const bool split_a = pair.a.radius > pair.b.radius;
    for (const Ball& half : split_a ? halves(first, pair.a) : halves(second, pair.b)) {
      add(split_a ? pair_of(half, pair.b) : pair_of(pair.a, half));
    }
  }
  return {std::max(0.0, open.top().low), high};
}

}  // namespace spoonbill
