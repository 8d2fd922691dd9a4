#include <algorithm>
#include <cmath>

#include "engine/collision/solids/implicit/exponential.h"
#include "engine/collision/solids/implicit/superquadric_distance.h"

namespace spoonbill {
namespace {

constexpr double farthest_logit = 600.0;
constexpr double least_share = 1e-60;
// Of the square of a distance: below it a step of Newton's method gains nothing but rounding.
constexpr double least_gain = 1e-15;

double bounded(double logit) {
  return std::clamp(logit, -farthest_logit, farthest_logit);
}

double log_ratio(double value) {
  return stable_log(std::max(value, least_share));
}

// Share and 1 - share, and their logarithms.
struct Shares {
  explicit Shares(double logit) {
    const double less = stable_exp(-std::abs(logit)), larger = 1.0 / (1.0 + less);
    const double rest = stable_log(1.0 + less);
    log_share = std::min(logit, 0.0) - rest;
    log_other = std::min(-logit, 0.0) - rest;
    share = logit < 0.0 ? less * larger : larger;
    other = logit < 0.0 ? larger : less * larger;
  }
  double share, other, log_share, log_other;
};

}  // namespace

// A point of the surface with its derivatives by both logits, against a point of the first octant.
struct SuperquadricDistance::Expansion {
  double half_square;  // of the distance
  double slope[2];
  double curvature[3];  // around twice, both, along twice
};

void SuperquadricDistance::expand(const Spot& spot, const Vector3& point, Expansion& out) const {
  const Shares around(spot.around), along(spot.along);
  const double s = around.share, s_other = around.other, t = along.share, t_other = along.other;
  const double ring = along.log_share / along_;
  const Vector3 at = axes_.cwiseProduct(Vector3(stable_exp(ring + around.log_share / around_),
                                                stable_exp(along.log_other / along_),
                                                stable_exp(ring + around.log_other / around_)));
  // Each coordinate is the exponential of a sum: its derivatives are itself times these.
  const Vector3 by_around(s_other / around_, 0.0, -s / around_);
  const Vector3 by_along(t_other / along_, -t / along_, t_other / along_);
  const double bend_around = s * s_other / around_, bend_along = t * t_other / along_;
  const Vector3 around_twice = by_around.cwiseAbs2() - Vector3(bend_around, 0.0, bend_around);
  const Vector3 along_twice = by_along.cwiseAbs2() - Vector3::Constant(bend_along);
  const Vector3 apart = at - point, pull = apart.cwiseProduct(at), square = at.cwiseAbs2();
  out.half_square = 0.5 * apart.squaredNorm();
  out.slope[0] = pull.dot(by_around);
  out.slope[1] = pull.dot(by_along);
  out.curvature[0] = square.dot(by_around.cwiseAbs2()) + pull.dot(around_twice);
  out.curvature[1] = (square + pull).dot(by_around.cwiseProduct(by_along));
  out.curvature[2] = square.dot(by_along.cwiseAbs2()) + pull.dot(along_twice);
}

// Newton's method, damped until it comes nearer.
SuperquadricDistance::Spot SuperquadricDistance::improve(Spot spot, const Vector3& point) const {
  Expansion here, there;
  expand(spot, point, here);
  double damping = 0.0;
  for (int step = 0; step < 60; ++step) {
    const double a = here.curvature[0] + damping * (std::abs(here.curvature[0]) + 1e-300),
                 b = here.curvature[1],
                 c = here.curvature[2] + damping * (std::abs(here.curvature[2]) + 1e-300);
    const double determinant = a * c - b * b;
    if (!(a > 0.0 && determinant > 1e-14 * a * c)) {
      damping = std::max(4.0 * damping, 1e-3);
      if (damping > 1e12) break;
      continue;
    }
    const double move_around = (b * here.slope[1] - c * here.slope[0]) / determinant;
    const double move_along = (b * here.slope[0] - a * here.slope[1]) / determinant;
    const double promise = -0.5 * (here.slope[0] * move_around + here.slope[1] * move_along);
    if (promise < least_gain * here.half_square) break;
    const double size = std::max({1.0, std::abs(move_around) / 20.0, std::abs(move_along) / 20.0});
    const Spot next{bounded(spot.around + move_around / size), bounded(spot.along + move_along / size)};
    expand(next, point, there);
    if (!(there.half_square < here.half_square)) {
      damping = std::max(4.0 * damping, 1e-3);
      if (damping > 1e12 || std::abs(move_around) + std::abs(move_along) < 1e-13) break;
      continue;
    }
    const double gain = here.half_square - there.half_square;
    spot = next;
    here = there;
    damping = damping > 1e-6 ? 0.1 * damping : 0.0;
    if (gain < least_gain * here.half_square) break;
  }
  return spot;
}

// By the tangent plane at the spot, which leaves the solid on one side wherever the spot is.
DistanceSample SuperquadricDistance::tangent(const Spot& spot, const Vector3& point) const {
  const Shares around(spot.around), along(spot.along);
  const double ring = along.log_share / along_, ring_normal = along.log_share - ring;
  const double across = around.log_share / around_, other = around.log_other / around_;
  const double height = along.log_other / along_;
  const Vector3 at =
      axes_.cwiseProduct(Vector3(stable_exp(ring + across), stable_exp(height), stable_exp(ring + other)));
  const Vector3 normal =
      Vector3(stable_exp(ring_normal + around.log_share - across), stable_exp(along.log_other - height),
              stable_exp(ring_normal + around.log_other - other))
          .cwiseQuotient(axes_)
          .normalized();
  const Vector3 signed_normal = (point.array() < 0.0).select(-normal, normal);
  return {normal.dot(point.cwiseAbs() - at), signed_normal};
}

// Where the ray from the middle leaves the solid.
SuperquadricDistance::Spot SuperquadricDistance::radial(const Vector3& point) const {
  const Vector3 ratio = point.cwiseAbs().cwiseQuotient(axes_);
  const double x = around_ * log_ratio(ratio.x()), z = around_ * log_ratio(ratio.z());
  const double high = std::max(x, z);
  const double ring = (high + stable_log(1.0 + stable_exp(std::min(x, z) - high))) / around_;
  return {bounded(x - z), bounded(along_ * (ring - log_ratio(ratio.y())))};
}

// Where the way along one axis leaves the solid.
SuperquadricDistance::Spot SuperquadricDistance::foot(const Vector3& point, int axis) const {
  const Vector3 ratio = point.cwiseAbs().cwiseQuotient(axes_);
  const auto power = [](double value, double q) { return stable_exp(q * log_ratio(value)); };
  if (axis == 1) {
    const double ring_share = power(
        stable_exp(stable_log(std::max(power(ratio.x(), around_) + power(ratio.z(), around_), least_share)) /
                   around_),
        along_);
    return {radial(point).around, bounded(log_ratio(ring_share) - log_ratio(1.0 - ring_share))};
  }
  const double height_share = power(ratio.y(), along_),
               ring_share = std::max(1.0 - height_share, least_share);
  const double whole = stable_exp(stable_log(ring_share) * (around_ / along_));
  const double kept = std::min(power(ratio[2 - axis], around_) / whole, 1.0);
  const double around = log_ratio(1.0 - kept) - log_ratio(kept);
  return {bounded(axis == 0 ? around : -around), bounded(log_ratio(ring_share) - log_ratio(height_share))};
}

DistanceSample SuperquadricDistance::inside(const Vector3& point) const {
  const Vector3 folded = point.cwiseAbs();
  const Spot starts[] = {radial(point), foot(point, 0), foot(point, 1), foot(point, 2), {0.0, 0.0}};
  DistanceSample best{-2.0 * axes_.norm(), Vector3::UnitY()};
  for (const Spot& start : starts) {
    const DistanceSample found = tangent(improve(start, folded), point);
    if (found.distance_m > best.distance_m) best = found;
  }
  return best;
}

}  // namespace spoonbill
