#include "engine/merging/rolling_ball.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {

namespace {

struct Places {
  double v, other_u, other_v;
};

// Of the domain, for differences of points in double.
constexpr double small_step = 1e-6;

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

// Into the domain, unless it lies outside by more than rounding.
bool settle(const KnotVector& knots, double& t) {
  const double rounding = 1e-9 * length_of(knots);
  if (knots.is_periodic()) return true;
  if (t < knots.domain_start() - rounding || t > knots.domain_end() + rounding) return false;
  t = std::clamp(t, knots.domain_start(), knots.domain_end());
  return true;
}

// Backwards at the end, beyond which the surface does not go on.
double step_from(const KnotVector& knots, double t) {
  const double step = small_step * length_of(knots);
  return !knots.is_periodic() && t + step > knots.domain_end() ? -step : step;
}

class Corner {
 public:
  Corner(const Surface& surface, double u, const Surface& other, BallSides sides)
      : surface_(surface),
        u_(u),
        other_(other),
        sides_(sides),
        pole_at_start_(is_tube(other) && is_pole(other, Side::v_start)),
        pole_at_end_(is_tube(other) && is_pole(other, Side::v_end)) {}

  Vector3 centre_from_surface(double v, double radius_m) const {
    return position(surface_, u_, v) + sides_.of_surface * radius_m * unit_normal(surface_, u_, v);
  }
  Vector3 centre_from_other(double u, double v, double radius_m) const {
    return position(other_, u, v) + sides_.of_other * radius_m * unit_normal(other_, u, v);
  }
  Vector3 apart(const Places& at, double radius_m) const {
    return centre_from_surface(at.v, radius_m) - centre_from_other(at.other_u, at.other_v, radius_m);
  }
  std::optional<Places> solved(Places at, double radius_m) const {
    for (int step = 0; step < 25; ++step) {
      const Vector3 now = apart(at, radius_m);
      if (now.norm() <= 1e-9 * radius_m) return at;
      const double dv = step_from(surface_.v, at.v), du_other = step_from(other_.u, at.other_u),
                   dv_other = step_from(other_.v, at.other_v);
      Eigen::Matrix3d slopes;
      slopes.col(0) = (apart({at.v + dv, at.other_u, at.other_v}, radius_m) - now) / dv;
      slopes.col(1) = (apart({at.v, at.other_u + du_other, at.other_v}, radius_m) - now) / du_other;
      slopes.col(2) = (apart({at.v, at.other_u, at.other_v + dv_other}, radius_m) - now) / dv_other;
      const Vector3 moved = slopes.partialPivLu().solve(-now);
      if (!moved.allFinite()) return std::nullopt;
      at = {at.v + moved.x(), at.other_u + moved.y(), at.other_v + moved.z()};
      lead_across_poles(at);
      if (!settle(surface_.v, at.v) || !settle(other_.u, at.other_u) || !settle(other_.v, at.other_v)) {
        return std::nullopt;
      }
    }
    return std::nullopt;
  }

 private:
  // Beyond a pole the other surface goes on at the opposite side of it.
  void lead_across_poles(Places& at) const {
    const double start = other_.v.domain_start(), end = other_.v.domain_end();
    const bool before = pole_at_start_ && at.other_v < start, behind = pole_at_end_ && at.other_v > end;
    if (!before && !behind) return;
    at.other_v = 2.0 * (before ? start : end) - at.other_v;
    at.other_u += 0.5 * length_of(other_.u);
  }

  const Surface& surface_;
  double u_;
  const Surface& other_;
  BallSides sides_;
  bool pole_at_start_, pole_at_end_;
};

}  // namespace

std::optional<BallContact> ball_contact(const Surface& surface, double u, const Surface& other,
                                        const LineCrossing& crossing, BallSides sides, double radius_m) {
  SPOONBILL_ASSERT(radius_m > 0.0);
  SPOONBILL_ASSERT(std::abs(sides.of_surface) == 1 && std::abs(sides.of_other) == 1);
  const Corner corner(surface, u, other, sides);
  constexpr int steps = 8;
  std::optional<Places> at = Places{crossing.along, crossing.other_u, crossing.other_v};
  for (int k = 1; at && k <= steps; ++k) at = corner.solved(*at, radius_m * k / steps);
  if (!at) return std::nullopt;
  return BallContact{at->v, at->other_u, at->other_v, corner.centre_from_surface(at->v, radius_m)};
}

}  // namespace spoonbill
