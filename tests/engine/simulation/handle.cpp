#include "tests/engine/simulation/handle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace spoonbill {

Scene small_handle() {
  constexpr int around = 12;
  const double length = 0.06;
  const std::vector<double> stations = {0.0,  0.0,  0.001, 0.004, 0.01, 0.02, 0.03,
                                        0.04, 0.05, 0.056, 0.059, 0.06, 0.06};
  const std::vector<double> scale = {0.0, 0.8, 0.97, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.97, 0.8, 0.0};
  const int along = static_cast<int>(stations.size());
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / around;
    const double c = std::cos(angle), s = std::sin(angle);
    const double radius = 1.08 / std::cbrt(std::pow(std::abs(c), 3) + std::pow(std::abs(s), 3));
    for (int j = 0; j < along; ++j) {
      net.set_point(i, j, {stations[j], -0.0025 * scale[j] * radius * s, 0.005 * scale[j] * radius * c});
    }
  }
  std::vector<double> knots = {0, 0, 0};
  for (int k = 0; k <= along - 3; ++k) knots.push_back(length * k / (along - 3));
  knots.insert(knots.end(), 3, length);
  Scene scene{{Body{"handle",
                    make_surface(KnotVector::periodic_uniform(3, around).value(),
                                 KnotVector::open(3, knots).value(), net)
                        .value(),
                    Material{}, LatticeRequest{500, {}}}},
              {},
              Tool{},
              Sculpting{}};
  Material& clay = scene.bodies[0].material;
  clay.name = "clay";
  clay.source = "test";
  clay.youngs_modulus_pa = 1e5;
  clay.poissons_ratio = 0.45;
  clay.density_kg_per_m3 = 1700.0;
  clay.damping_time_s = 1.1e-5;
  clay.plastic = true;
  clay.yield_strain = 0.005;
  clay.flow_rate_per_s = 300.0;
  scene.tool.radius_m = 0.006;
  return scene;
}

Simulation simulate(const Scene& scene, InstructionSet set) {
  Result<Simulation> simulation = Simulation::make(scene, set);
  EXPECT_TRUE(simulation.ok()) << simulation.error().message;
  return std::move(simulation).value();
}

ToolInput above(double x_m, double y_m, bool gripping) {
  return {{Vector3(x_m, y_m, 0.0), Quaternion::Identity()}, gripping, 0.0};
}

}  // namespace spoonbill
