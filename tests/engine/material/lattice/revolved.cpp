#include "tests/engine/material/lattice/revolved.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"

namespace spoonbill {
namespace {

constexpr int around = 24, along = 32, stations = 400;

}  // namespace

Surface revolved(const std::function<MeridianPlace(double)>& meridian, double lean_m) {
  const KnotVector knots = KnotVector::clamped_uniform(3, along).value();
  const std::vector<double> samples = uniform_parameters(knots, 8 * along);
  Eigen::MatrixXd points(static_cast<Eigen::Index>(samples.size()), 2);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const MeridianPlace point = meridian(samples[s]);
    points.row(static_cast<Eigen::Index>(s)) << point.radius_m, point.height_m;
  }
  const Eigen::MatrixXd control = pseudo_inverse(knots, samples).value() * points;
  // A closed uniform cubic curve is smaller than the circle of its control points. The circle is larger by
  // this factor.
  const double outside = 3.0 / (2.0 + std::cos(2.0 * std::numbers::pi / around));
  const double low = control(0, 1), high = control(along - 1, 1);
  ControlNet net(around, along);
  for (int j = 0; j < along; ++j) {
    const bool pole = j == 0 || j == along - 1;
    const double radius = pole ? 0.0 : outside * control(j, 0), height = control(j, 1);
    const double lean = lean_m * std::pow((height - low) / (high - low), 2);
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / around;
      net.set_point(i, j, {radius * std::cos(angle) + lean, radius * std::sin(angle), height});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, around).value(), knots, net).value();
}

Surface round_ball(double radius_m) {
  return revolved([=](double share) {
    const double angle = std::numbers::pi * share;
    return MeridianPlace{radius_m * std::sin(angle), -radius_m * std::cos(angle)};
  });
}

double enclosed_volume_m3(const Surface& surface) {
  const auto at = [&](int i, int j) {
    const auto parameter = [](const KnotVector& knots, int station) {
      return knots.domain_start() + (knots.domain_end() - knots.domain_start()) * station / stations;
    };
    return position(surface, parameter(surface.u, i), parameter(surface.v, j));
  };
  double volume = 0.0;
  for (int j = 0; j < stations; ++j) {
    Vector3 low = at(0, j), high = at(0, j + 1);
    for (int i = 0; i < stations; ++i) {
      const Vector3 next_low = at(i + 1, j), next_high = at(i + 1, j + 1);
      volume += (low.dot(next_low.cross(next_high)) + low.dot(next_high.cross(high))) / 6.0;
      low = next_low;
      high = next_high;
    }
  }
  return volume;
}

double volume_of(const LatticeMesh& mesh) {
  double volume = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) volume += cell_volume(mesh.cell(i, j, k));
    }
  }
  return volume;
}

}  // namespace spoonbill
