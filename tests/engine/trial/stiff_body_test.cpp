// Tests deformable bodies that are too stiff for springs and move freely: they keep their shape while they
// turn, and roll.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/simulation/body_hold.h"
#include "engine/trial/body_measures.h"
#include "engine/trial/trial.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// A ball on a slope that falls along x.
Simulation make_ball_on_slope(const char* material_name, LatticeCells cells, double slope_rad) {
  Material material = made_elastic(bundled_material(material_name));
  material.friction = 0.6;
  Scene scene;
  scene.bodies = {stock_body("ball", SphereSize{0.01}, {0.0, 0.01, 0.0}, material, 500)};
  scene.bodies[0].lattice.cells = cells;
  scene.ground = Ground{Vector3::Zero(), Vector3::UnitY(), 0.6};
  scene.sculpting.gravity_m_per_s2 =
      standard_gravity_m_per_s2 * Vector3(std::sin(slope_rad), -std::cos(slope_rad), 0.0);
  return make_simulation(make_trial_scene(scene, {}).value());
}

// A ball that rolls moves by 5/14 g sin(slope) t^2. The surface of the lattice is a polyhedron, which loses
// speed with each facet: a wheel with 28 spokes on this slope would keep at most 0.55 m/s. In half a second
// the balls reach more than half of the way.
TEST(StiffBody, RollsAndKeepsItsShape) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const double slope = 20.0 * std::numbers::pi / 180.0;
  const double way_m = 5.0 / 14.0 * standard_gravity_m_per_s2 * std::sin(slope) * 0.25;
  for (const char* const material : {"steel-304", "polypropylene"}) {
    for (const LatticeCells cells : {LatticeCells::bent, LatticeCells::box}) {
      SCOPED_TRACE(std::string(material) + (cells == LatticeCells::box ? ", box" : ", bent"));
      Simulation simulation = make_ball_on_slope(material, cells, slope);
      EnergyMeter meter;
      const auto energy_j = [&] {
        return meter.find_energy_j(simulation.lattice(0), simulation.scene().sculpting.gravity_m_per_s2)
            .value();
      };
      const double start_j = energy_j();
      const double start_m = find_mass_centre(simulation.lattice(0)).position_m.x();
      const double weight_n = simulation.lattice(0).mass_kg() * standard_gravity_m_per_s2;
      double highest_j = start_j;
      for (int tick = 0; tick < 500; ++tick) {
        ASSERT_EQ(simulation.advance(trial_input()).flags, tick_flag_none);
        if (tick % 10 == 0) highest_j = std::max(highest_j, energy_j());
      }
      const double moved_m = find_mass_centre(simulation.lattice(0)).position_m.x() - start_m;
      EXPECT_GT(moved_m, 0.5 * way_m);
      EXPECT_LT(moved_m, way_m);
      EXPECT_LT(highest_j - start_j, 0.01 * weight_n * moved_m);
      const CellShapes shape = measure_cells(simulation.lattice(0));
      EXPECT_NEAR(shape.smallest_jacobian, 1.0, 0.02);
    }
  }
}

}  // namespace
}  // namespace spoonbill
