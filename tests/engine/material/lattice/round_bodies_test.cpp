// Tests lattices of round and box-like bodies, whose end caps are as large as their sides, and of merged
// bodies whose thickness varies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/springs/spring_lattice.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// The profile of a tube along z: half its width along x and half its thickness along y, each as a function of
// the fraction of the length. The rings are superellipses. The rings beside the poles are in the planes of
// the poles, so that the ends are smooth.
struct BodyProfile {
  double length_m;
  double exponent;
  std::function<double(double)> half_width_m, half_thickness_m;
};

Surface tube_of(const BodyProfile& profile, int around = 16, int along = 20) {
  const KnotVector knots = KnotVector::clamped_uniform(3, along).value();
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * pi * i / around, c = std::cos(angle), s = std::sin(angle);
    const double radius =
        std::pow(std::pow(std::abs(c), profile.exponent) + std::pow(std::abs(s), profile.exponent),
                 -1.0 / profile.exponent);
    for (int j = 0; j < along; ++j) {
      double share = (knots.knots()[j + 1] + knots.knots()[j + 2] + knots.knots()[j + 3]) / 3.0;
      const bool pole = j == 0 || j == along - 1;
      const double width = pole ? 0.0 : profile.half_width_m(share);
      const double thickness = pole ? 0.0 : profile.half_thickness_m(share);
      if (j == 1) share = 0.0;
      if (j == along - 2) share = 1.0;
      net.set_point(i, j, {width * radius * c, thickness * radius * s, profile.length_m * share});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, around).value(), knots, net).value();
}

// Returns the relative half width of a circle or an ellipse at a fraction of its length.
double arch(double share) {
  return std::sqrt(std::max(0.0, 1.0 - std::pow(2.0 * share - 1.0, 2)));
}

BodyProfile sphere() {
  const auto half = [](double share) { return 0.03 * arch(share); };
  return {0.06, 2.0, half, half};
}
BodyProfile egg() {
  const auto half = [](double share) { return 0.022 * arch(share) * (1.15 - 0.3 * share); };
  return {0.058, 2.0, half, half};
}
BodyProfile pear_profile() {
  const auto half = [](double share) {
    return 0.03 * arch(share) * (share < 0.5 ? 1.0 : 1.0 - 0.55 * std::pow(std::sin(pi * (share - 0.5)), 2));
  };
  return {0.09, 2.0, half, half};
}
BodyProfile rounded_box() {
  const auto end = [](double share) {
    return std::pow(1.0 - std::pow(std::abs(2.0 * share - 1.0), 8.0), 0.125);
  };
  return {0.03, 8.0, [end](double share) { return 0.012 * end(share); },
          [end](double share) { return 0.01 * end(share); }};
}
// Returns a handle of 12 x 9 mm that blends into an end of 36 x 2 mm.
BodyProfile spoon() {
  const auto blend = [](double share) {
    const double t = std::clamp((share - 0.5) / 0.2, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  };
  const auto end = [](double share) {
    return std::pow(1.0 - std::pow(std::abs(2.0 * share - 1.0), 8.0), 0.125);
  };
  return {0.15, 2.5, [=](double share) { return end(share) * (0.006 + 0.012 * blend(share)); },
          [=](double share) { return end(share) * (0.0045 - 0.0035 * blend(share)); }};
}

TEST(RoundBodies, HavePositiveCells) {
  struct Case {
    const char* name;
    BodyProfile profile;
    double worst_jacobian;
  };
  for (const Case& of :
       {Case{"sphere", sphere(), 0.05}, Case{"egg", egg(), 0.05}, Case{"pear", pear_profile(), 0.01},
        Case{"rounded box", rounded_box(), 0.3}, Case{"spoon", spoon(), 0.05}}) {
    for (const int budget : {2000, 4000, 8000}) {
      if ((sanitized && budget > 2000) || (budget > 4000 && !is_full_run())) continue;
      const Result<LatticeMesh> mesh = tube_lattice(tube_of(of.profile), {budget, {}});
      ASSERT_TRUE(mesh.ok()) << of.name << ", " << budget << ": " << mesh.error().message;
      const CellQuality quality = measure_cell_quality(mesh.value());
      EXPECT_GT(quality.worst_jacobian, of.worst_jacobian) << of.name << ", " << budget;
      EXPECT_LT(quality.volume_spread, 1.0) << of.name << ", " << budget;
    }
  }
}

// The stiffness is a mean over the cells along each axis. Cells along the rounded edges become more slender
// as the budget grows, and their springs are slightly too soft.
TEST(RoundBodies, RoundedBoxIsAsStiffAsItsMaterial) {
  for (const int budget : {2000, 8000}) {
    const LatticeMesh mesh = tube_lattice(tube_of(rounded_box()), {budget, {}}).value();
    const SpringLattice lattice =
        SpringLattice::make(mesh, elastic_material(1e5, 0.3, 1000.0), InstructionSet::baseline).value();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(lattice.report().youngs_modulus_ratio[axis], 1.0, 0.05) << budget << ", axis " << axis;
    }
  }
}

}  // namespace
}  // namespace spoonbill
