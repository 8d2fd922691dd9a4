#include "tests/engine/material/lattice/shells.h"

#include <cmath>
#include <numbers>

#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"

namespace spoonbill {
namespace {

constexpr int shell_around = 32, shell_along = 24;

// Returns the radius of the circle of control points for which a closed uniform cubic curve has the radius
// `radius`. The curve is smaller than the circle by the factor (2 + cos(a)) / 3, where a is the angle between
// two control points.
double control_radius(double radius) {
  return radius * 3.0 / (2.0 + std::cos(2.0 * std::numbers::pi / shell_around));
}

}  // namespace

Surface flat_sheet(double a_m, double b_m, bool up) {
  constexpr int count = 8;
  const KnotVector knots = KnotVector::clamped_uniform(3, count).value();
  ControlNet net(count, count);
  const auto greville = [&](int i) {
    return (knots.knots()[i + 1] + knots.knots()[i + 2] + knots.knots()[i + 3]) / 3;
  };
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double x = up ? greville(i) : 1.0 - greville(i);
      // The normal du x dv is up if u is along z and v along x. Here u is along x, so v runs against z.
      net.set_point(i, j, {a_m * x, 0.0, b_m * (1.0 - greville(j))});
    }
  }
  return make_surface(knots, knots, net).value();
}

Surface spherical_bowl(double radius_m, double opening_rad, bool pole_at_end) {
  const KnotVector knots = KnotVector::clamped_uniform(3, shell_along).value();
  const std::vector<double> samples = uniform_parameters(knots, 8 * shell_along);
  const Eigen::MatrixXd inverse = pseudo_inverse(knots, samples).value();
  Eigen::MatrixXd arc(static_cast<Eigen::Index>(samples.size()), 2);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const double angle = opening_rad * (pole_at_end ? 1.0 - samples[s] : samples[s]);
    arc.row(static_cast<Eigen::Index>(s)) << radius_m * std::sin(angle), -radius_m * std::cos(angle);
  }
  const Eigen::MatrixXd control = inverse * arc;
  ControlNet net(shell_around, shell_along);
  for (int i = 0; i < shell_around; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / shell_around * (pole_at_end ? 1.0 : -1.0);
    for (int j = 0; j < shell_along; ++j) {
      const bool pole = j == (pole_at_end ? shell_along - 1 : 0);
      const double radius = pole ? 0.0 : control_radius(control(j, 0));
      net.set_point(i, j, {radius * std::cos(turn), control(j, 1), radius * std::sin(turn)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, shell_around).value(), knots, net).value();
}

Surface open_ring(double radius_m, double height_m, double seam_turn) {
  const KnotVector knots = KnotVector::clamped_uniform(3, 6).value();
  ControlNet net(shell_around, 6);
  for (int i = 0; i < shell_around; ++i) {
    // A control point has its largest weight two knots after the first knot of its basis function.
    const double angle = -2.0 * std::numbers::pi * ((i + 2.0) / shell_around + seam_turn);
    for (int j = 0; j < 6; ++j) {
      const double share = (knots.knots()[j + 1] + knots.knots()[j + 2] + knots.knots()[j + 3]) / 3;
      net.set_point(i, j,
                    {control_radius(radius_m) * std::cos(angle), height_m * share,
                     control_radius(radius_m) * std::sin(angle)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, shell_around).value(), knots, net).value();
}

Surface open_ring_around_v(double radius_m, double height_m) {
  const Surface ring = open_ring(radius_m, height_m);
  ControlNet net(ring.net.columns, ring.net.rows);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, ring.net.point(ring.net.rows - 1 - j, i));
  }
  return make_surface(ring.v, ring.u, net).value();
}

}  // namespace spoonbill
