#include "engine/collision/solids/implicit/superquadric_distance.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/solids/implicit/exponential.h"

namespace spoonbill {
namespace {

constexpr double nothing = -1e300;     // the logarithm of a coordinate that is 0
constexpr double least_share = 1e-60;  // of a semi-axis, below which a coordinate counts as 0
// Of the price's logarithm, and so of the distance.
constexpr double settled_step = 1e-13;
// Where the gauge is so near 1 the distance is the gauge's over its slope, to less than rounding.
constexpr double at_surface_gauge = 1e-14;

double log_of_sum(double a, double b) {
  const double high = std::max(a, b), low = std::min(a, b);
  return low - high < -40.0 ? high : high + stable_log(1.0 + stable_exp(low - high));
}

// One coordinate of the nearest point: the root L = log(x / a) of e^L + price e^((q-1) L) = target.
struct Coordinate {
  double log_value = nothing;
  double reach = 0.0;  // the second term: what the point lies beyond the surface, by the semi-axis
  double slope = 0.0;  // of log_value by log(price)
};

// Both terms are convex in L, and each alone is at most the target: Newton's method comes down from there.
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

// log(|p_i| / a_i), `nothing` for 0.
Vector3 log_targets(const Vector3& point, const Vector3& axes) {
  Vector3 logs;
  for (int k = 0; k < 3; ++k) {
    const double ratio = std::abs(point[k]) / axes[k];
    logs[k] = ratio > least_share ? stable_log(ratio) : nothing;
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
  return tangent(radial(point), point);
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
    const double share_x = x.log_value == nothing ? 0.0 : stable_exp(around_ * (x.log_value - rho));
    const double share_z = z.log_value == nothing ? 0.0 : stable_exp(around_ * (z.log_value - rho));
    const double rho_slope = share_x * x.slope + share_z * z.slope;
    const double price_slope = 1.0 + (around_ - along_) * rho_slope;
    y = solve_coordinate(targets.y(), log_price + (around_ - along_) * rho - 2.0 * log_axes_.y(), along_);
    const double gauge = log_norm(rho, y.log_value, along_);
    const double share_rho = stable_exp(along_ * (rho - gauge));
    const double slope = share_rho * rho_slope + (1.0 - share_rho) * y.slope * price_slope;
    (gauge > 0.0 ? low : high) = log_price;
    double move = std::clamp(-gauge / slope, -8.0, 8.0);
    if (!(std::abs(move) >= 0.0)) move = gauge > 0.0 ? 8.0 : -8.0;
    double next = log_price + move;
    // Without a bound on the other side, only rounding can lead back.
    const bool bounded = low > -1e300 && high < 1e300, leads_back = next <= low || next >= high;
    if (leads_back) next = bounded ? 0.5 * (low + high) : log_price;
    const bool settled = std::abs(gauge) < 2e-16 || std::abs(next - log_price) < settled_step;
    log_price = next;
    if (settled) break;
  }
  const Vector3 away = axes_.cwiseProduct(Vector3(x.reach, y.reach, z.reach));
  const double distance = away.norm();
  if (!(distance > 0.0)) return at_surface(point);
  return {distance, with_signs_of(point, away / distance)};
}

}  // namespace spoonbill
