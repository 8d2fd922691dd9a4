#include "engine/collision/solids/superquadric_distance.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/solids/exponential.h"

namespace spoonbill {

namespace {

constexpr double nothing = -1e300;     // stands for the logarithm of 0
constexpr double least_ratio = 1e-60;  // fraction of a semi-axis below which a coordinate counts as 0
// Convergence tolerance of log(price), where `price` is a Lagrange multiplier (mu in
// superquadric_distance.h). It also determines the accuracy of the distance.
constexpr double convergence_step = 1e-13;
// Largest |log(gauge)| of a point that counts as on the surface. The gauge is 1 on the surface and less
// inside. At such a point, the distance to the tangent plane is exact up to rounding.
constexpr double at_surface_gauge = 1e-14;

double log_of_sum(double a, double b) {
  const double high = std::max(a, b), low = std::min(a, b);
  return low - high < -40.0 ? high : high + stable_log(1.0 + stable_exp(low - high));
}

// One coordinate x of the nearest point. It is stored as L = log(x / a), where a is the semi-axis. L is the
// root of e^L + price e^((q-1) L) = target, where `price` is a Lagrange multiplier.
struct Coordinate {
  double log_value = nothing;
  // The term price e^((q-1) L). It is the offset of the point from the surface along this axis, divided by
  // the semi-axis.
  double reach = 0.0;
  // Derivative of log_value with respect to the logarithm of the Lagrange multiplier `price`.
  double slope = 0.0;
};

// Solves e^L + price e^((q-1) L) = target for L by Newton's method. It starts where the larger term alone
// equals the target, at or above the root. Both terms are convex in L, so the iteration decreases
// monotonically.
Coordinate solve_coordinate(double log_target, double log_price, double q) {
  if (log_target == nothing) return {};
  const double target = stable_exp(log_target);
  double value = std::min(log_target, (log_target - log_price) / (q - 1.0));
  double own = 0.0, priced = 0.0;
  for (int step = 0; step < 60; ++step) {
    own = stable_exp(value);
    priced = stable_exp(log_price + (q - 1.0) * value);
    const double move = (own + priced - target) / (own + (q - 1.0) * priced);
    value -= move;
    if (!(move > 1e-14)) break;
  }
  return {value, priced, -priced / (own + (q - 1.0) * priced)};
}

Vector3 with_signs_of(const Vector3& point, const Vector3& magnitude) {
  return (point.array() < 0.0).select(-magnitude, magnitude);
}

// Returns log(|p_i| / a_i) for each coordinate p_i of the point and semi-axis a_i, or `nothing` for 0.
Vector3 log_targets(const Vector3& point, const Vector3& axes) {
  Vector3 logs;
  for (int k = 0; k < 3; ++k) {
    const double ratio = std::abs(point[k]) / axes[k];
    logs[k] = ratio > least_ratio ? stable_log(ratio) : nothing;
  }
  return logs;
}

double log_norm(double a, double b, double q) {
  if (a == nothing && b == nothing) return nothing;
  if (a == nothing || b == nothing) return std::max(a, b);
  return log_of_sum(q * a, q * b) / q;
}

}  // namespace

SuperquadricDistance::SuperquadricDistance(const SuperquadricShape& shape)
    : axes_(shape.semi_axes_m), along_(2.0 / shape.exponent_along), around_(2.0 / shape.exponent_around) {
  for (int k = 0; k < 3; ++k) log_axes_[k] = stable_log(axes_[k]);
}

double SuperquadricDistance::log_gauge(const Vector3& point) const {
  const Vector3 logs = log_targets(point, axes_);
  return log_norm(log_norm(logs.x(), logs.z(), around_), logs.y(), along_);
}

DistanceSample SuperquadricDistance::at(const Vector3& point_m) const {
  const double gauge = log_gauge(point_m);
  if (gauge > at_surface_gauge) return outside(point_m);
  if (gauge < -at_surface_gauge) return inside(point_m);
  return at_surface(point_m);
}

DistanceSample SuperquadricDistance::at_within(const Vector3& point_m, double enough_m) const {
  const DistanceSample plane = at_surface(point_m);
  return plane.distance_m >= enough_m ? plane : at(point_m);
}

bool SuperquadricDistance::is_beyond(const Vector3& point_m, double limit_m) const {
  return log_gauge(point_m) > 0.0 && at_within(point_m, limit_m).distance_m > limit_m;
}

DistanceSample SuperquadricDistance::at_surface(const Vector3& point) const {
  return tangent(radial_exit(point), point);
}

DistanceSample SuperquadricDistance::outside(const Vector3& point) const {
  const Vector3 targets = log_targets(point, axes_);
  const bool ring = targets.x() != nothing || targets.z() != nothing;
  if (!ring) return {std::abs(point.y()) - axes_.y(), with_signs_of(point, Vector3::UnitY())};
  Coordinate x, y, z;
  double low = -1e300, high = 1e300;
  double log_price = 2.0 * log_axes_.minCoeff();
  for (int step = 0; step < 200; ++step) {
    x = solve_coordinate(targets.x(), log_price - 2.0 * log_axes_.x(), around_);
    z = solve_coordinate(targets.z(), log_price - 2.0 * log_axes_.z(), around_);
    const double rho = log_norm(x.log_value, z.log_value, around_);
    const double fraction_x = x.log_value == nothing ? 0.0 : stable_exp(around_ * (x.log_value - rho));
    const double fraction_z = z.log_value == nothing ? 0.0 : stable_exp(around_ * (z.log_value - rho));
    const double rho_slope = fraction_x * x.slope + fraction_z * z.slope;
    const double price_slope = 1.0 + (around_ - along_) * rho_slope;
    y = solve_coordinate(targets.y(), log_price + (around_ - along_) * rho - 2.0 * log_axes_.y(), along_);
    const double gauge = log_norm(rho, y.log_value, along_);
    const double fraction_rho = stable_exp(along_ * (rho - gauge));
    const double slope = fraction_rho * rho_slope + (1.0 - fraction_rho) * y.slope * price_slope;
    (gauge > 0.0 ? low : high) = log_price;
    double move = std::clamp(-gauge / slope, -8.0, 8.0);
    if (!(std::abs(move) >= 0.0)) move = gauge > 0.0 ? 8.0 : -8.0;
    double next = log_price + move;
    // While only one bound is known, a step beyond this bound is due to rounding, and the iteration ends.
    const bool bounded = low > -1e300 && high < 1e300, leads_back = next <= low || next >= high;
    if (leads_back) next = bounded ? 0.5 * (low + high) : log_price;
    const bool converged = std::abs(gauge) < 2e-16 || std::abs(next - log_price) < convergence_step;
    log_price = next;
    if (converged) break;
  }
  const Vector3 away = axes_.cwiseProduct(Vector3(x.reach, y.reach, z.reach));
  const double distance = away.norm();
  if (!(distance > 0.0)) return at_surface(point);
  return {distance, with_signs_of(point, away / distance)};
}

namespace {

constexpr double farthest_logit = 600.0;
// A smaller relative decrease of the squared distance counts as rounding error.
constexpr double least_distance_gain = 1e-15;

double bounded(double logit) {
  return std::clamp(logit, -farthest_logit, farthest_logit);
}

double log_ratio(double value) {
  return stable_log(std::max(value, least_ratio));
}

// A fraction and its complement, with their logarithms, computed from the logit of the fraction.
struct Fractions {
  explicit Fractions(double logit) {
    const double less = stable_exp(-std::abs(logit)), larger = 1.0 / (1.0 + less);
    const double rest = stable_log(1.0 + less);
    log_fraction = std::min(logit, 0.0) - rest;
    log_other = std::min(-logit, 0.0) - rest;
    fraction = logit < 0.0 ? less * larger : larger;
    other = logit < 0.0 ? larger : less * larger;
  }
  double fraction, other, log_fraction, log_other;
};

}  // namespace

// Half the squared distance from a point of the first octant to a point of the surface, and its derivatives
// with respect to the coordinates `around` and `along` of the surface point.
struct SuperquadricDistance::Expansion {
  double half_square;  // half the squared distance
  double slope[2];
  double curvature[3];  // second derivatives: around-around, around-along, along-along
};

void SuperquadricDistance::expand(const Spot& spot, const Vector3& point, Expansion& out) const {
  const Fractions around(spot.around), along(spot.along);
  const double s = around.fraction, s_other = around.other, t = along.fraction, t_other = along.other;
  const double ring = along.log_fraction / along_;
  const Vector3 at = axes_.cwiseProduct(Vector3(stable_exp(ring + around.log_fraction / around_),
                                                stable_exp(along.log_other / along_),
                                                stable_exp(ring + around.log_other / around_)));
  // Each coordinate of the surface point is the exponential of a sum. Its derivatives are therefore the
  // coordinate times these factors.
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

// Moves a point of the surface to a local minimum of the distance by Newton's method. Steps are damped so
// that the distance decreases.
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
    if (promise < least_distance_gain * here.half_square) break;
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
    if (gain < least_distance_gain * here.half_square) break;
  }
  return spot;
}

// Returns the distance to the tangent plane at a point of the surface. Any tangent plane bounds the solid,
// because the solid is convex.
DistanceSample SuperquadricDistance::tangent(const Spot& spot, const Vector3& point) const {
  const Fractions around(spot.around), along(spot.along);
  const double ring = along.log_fraction / along_, ring_normal = along.log_fraction - ring;
  const double across = around.log_fraction / around_, other = around.log_other / around_;
  const double height = along.log_other / along_;
  const Vector3 at =
      axes_.cwiseProduct(Vector3(stable_exp(ring + across), stable_exp(height), stable_exp(ring + other)));
  const Vector3 normal =
      Vector3(stable_exp(ring_normal + around.log_fraction - across), stable_exp(along.log_other - height),
              stable_exp(ring_normal + around.log_other - other))
          .cwiseQuotient(axes_)
          .normalized();
  const Vector3 signed_normal = (point.array() < 0.0).select(-normal, normal);
  return {normal.dot(point.cwiseAbs() - at), signed_normal};
}

// Returns the point of the surface where the ray from the solid's centre through `point` leaves the solid.
SuperquadricDistance::Spot SuperquadricDistance::radial_exit(const Vector3& point) const {
  const Vector3 ratio = point.cwiseAbs().cwiseQuotient(axes_);
  const double x = around_ * log_ratio(ratio.x()), z = around_ * log_ratio(ratio.z());
  const double high = std::max(x, z);
  const double ring = (high + stable_log(1.0 + stable_exp(std::min(x, z) - high))) / around_;
  return {bounded(x - z), bounded(along_ * (ring - log_ratio(ratio.y())))};
}

// Returns the point of the surface where the line through `point` along one axis leaves the solid.
SuperquadricDistance::Spot SuperquadricDistance::axis_exit(const Vector3& point, int axis) const {
  const Vector3 ratio = point.cwiseAbs().cwiseQuotient(axes_);
  const auto power = [](double value, double q) { return stable_exp(q * log_ratio(value)); };
  if (axis == 1) {
    const double ring_fraction = power(
        stable_exp(stable_log(std::max(power(ratio.x(), around_) + power(ratio.z(), around_), least_ratio)) /
                   around_),
        along_);
    return {radial_exit(point).around, bounded(log_ratio(ring_fraction) - log_ratio(1.0 - ring_fraction))};
  }
  const double height_fraction = power(ratio.y(), along_),
               ring_fraction = std::max(1.0 - height_fraction, least_ratio);
  const double whole = stable_exp(stable_log(ring_fraction) * (around_ / along_));
  const double clamped = std::min(power(ratio[2 - axis], around_) / whole, 1.0);
  const double around = log_ratio(1.0 - clamped) - log_ratio(clamped);
  return {bounded(axis == 0 ? around : -around),
          bounded(log_ratio(ring_fraction) - log_ratio(height_fraction))};
}

DistanceSample SuperquadricDistance::inside(const Vector3& point) const {
  const Vector3 folded = point.cwiseAbs();
  const Spot starts[] = {
      radial_exit(point), axis_exit(point, 0), axis_exit(point, 1), axis_exit(point, 2), {0.0, 0.0}};
  DistanceSample best{-2.0 * axes_.norm(), Vector3::UnitY()};
  for (const Spot& start : starts) {
    const DistanceSample found = tangent(improve(start, folded), point);
    if (found.distance_m > best.distance_m) best = found;
  }
  return best;
}

}  // namespace spoonbill
