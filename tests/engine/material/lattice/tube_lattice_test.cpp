// Tests lattices of bent bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice/body_lattice.h"
#include "tests/engine/material/lattice/revolved.h"

namespace spoonbill {
namespace {

constexpr double coil_radius_m = 0.03, rise_m = 0.02, coil_tube_radius_m = 0.004;

// Returns a round bar along a helix about y that rises `rise_m` per turn; its ends are poles.
Surface coil(double turn_rad) {
  constexpr int around = 12;
  const int along = 12 + static_cast<int>(8.0 * turn_rad);
  ControlNet net(around, along);
  for (int j = 0; j < along; ++j) {
    const double angle = turn_rad * std::clamp((j - 1.0) / (along - 3.0), 0.0, 1.0);
    const Vector3 out(std::cos(angle), 0.0, std::sin(angle));
    const Vector3 centre = coil_radius_m * out + rise_m * angle / (2.0 * std::numbers::pi) * Vector3::UnitY();
    const double radius = j == 0 || j == along - 1 ? 0.0 : coil_tube_radius_m;
    for (int i = 0; i < around; ++i) {
      const double around_bar = 2.0 * std::numbers::pi * i / around;
      net.set_point(i, j,
                    centre + radius * (std::cos(around_bar) * out + std::sin(around_bar) * Vector3::UnitY()));
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, around).value(),
                      KnotVector::clamped_uniform(3, along).value(), net)
      .value();
}

// The ends of a coil may be apart, beside each other or above each other.
TEST(TubeLattice, FillsCoilsOfAnyTurn) {
  for (const double degrees : {5.0, 90.0, 180.0, 270.0, 360.0, 400.0, 540.0, 720.0, 900.0}) {
    const double turn = degrees * std::numbers::pi / 180.0;
    const Result<LatticeMesh> mesh = tube_lattice(coil(turn), {3000, {}});
    ASSERT_TRUE(mesh.ok()) << degrees << " degrees: " << mesh.error().message;
    if (degrees < 90.0) continue;
    const double length = std::hypot(coil_radius_m * turn, rise_m * turn / (2.0 * std::numbers::pi));
    const double bar = std::numbers::pi * coil_tube_radius_m * coil_tube_radius_m * length;
    // The bar's cross section is 9 % smaller than the circle of its control points. The lattice also cuts off
    // the bar's round corners, because rings of the lattice have only about ten nodes.
    EXPECT_NEAR(volume_of(mesh.value()) / bar, 0.8, 0.15) << degrees << " degrees";
  }
}

}  // namespace
}  // namespace spoonbill
