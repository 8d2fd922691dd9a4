#include "tests/engine/collision/surfaces/sheets.h"

#include <cmath>
#include <numbers>

namespace spoonbill {
namespace {

constexpr int degree = 5;

double angle(int i, int count) {
  return 2.0 * std::numbers::pi * i / count;
}

// Returns the radius of the control points for which a uniform curve of degree 5 is on the unit circle at its
// knots, where the B-spline has the values 1, 26, 66, 26 and 1, divided by 120.
double control_radius(int count) {
  const double h = angle(1, count);
  return 120.0 / (66.0 + 52.0 * std::cos(h) + 2.0 * std::cos(2.0 * h));
}

}  // namespace

Surface quadric_sheet(double half_m, double bend_x, double bend_z, int controls) {
  const KnotVector knots = KnotVector::clamped_uniform(2, controls).value();
  const std::vector<double>& t = knots.knots();
  ControlNet net(controls, controls);
  const auto at = [&](int k) { return half_m * (2.0 * t[k] - 1.0); };
  for (int i = 0; i < controls; ++i) {
    for (int j = 0; j < controls; ++j) {
      // `x`, `z` and `height` are the polar forms (blossoms) of x, z and the height, at the control point's
      // two knots.
      const double x = 0.5 * (at(j + 1) + at(j + 2)), z = 0.5 * (at(i + 1) + at(i + 2));
      const double height = bend_x * at(j + 1) * at(j + 2) + bend_z * at(i + 1) * at(i + 2);
      net.set_point(i, j, {x, height, z});
    }
  }
  return make_surface(knots, knots, std::move(net)).value();
}

Surface round_tube(double radius_m, double half_length_m) {
  constexpr int around = 60;
  const KnotVector u = KnotVector::periodic_uniform(degree, around).value();
  const KnotVector v = KnotVector::clamped_uniform(1, 5).value();
  ControlNet net(around, 5);
  const double radius = radius_m * control_radius(around);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < 5; ++j) {
      net.set_point(i, j,
                    {half_length_m * (0.5 * j - 1.0), radius * std::cos(angle(i, around)),
                     radius * std::sin(angle(i, around))});
    }
  }
  return make_surface(u, v, std::move(net)).value();
}

Surface round_torus(double ring_radius_m, double tube_radius_m) {
  constexpr int around = 60, along = 40;
  const KnotVector u = KnotVector::periodic_uniform(degree, around).value();
  const KnotVector v = KnotVector::periodic_uniform(degree, along).value();
  ControlNet net(around, along);
  const double tube = tube_radius_m * control_radius(along);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double out = control_radius(around) * (ring_radius_m + tube * std::cos(angle(j, along)));
      net.set_point(i, j,
                    {out * std::cos(angle(i, around)), tube * std::sin(angle(j, along)),
                     -out * std::sin(angle(i, around))});
    }
  }
  return make_surface(u, v, std::move(net)).value();
}

}  // namespace spoonbill
