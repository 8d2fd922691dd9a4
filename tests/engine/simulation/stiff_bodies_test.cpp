// Tests bodies of stiff elastic materials, which the implicit solver simulates with their true stiffness.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/material/statics/static_solver.h"
#include "engine/simulation/body_state.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr double coupling_n_per_m = 700.0, plane_x_m = 0.01, press_x_m = 0.052;

Material stiff_material(double youngs_modulus_pa) {
  Material material;
  material.name = "stiff";
  material.source = "test";
  material.youngs_modulus_pa = youngs_modulus_pa;
  material.poissons_ratio = 0.35;
  material.density_kg_per_m3 = 1020.0;
  material.damping_time_s = 1.1e-5;
  return material;
}

// Returns a scene with a handle whose nodes below x = 10 mm are fixed.
Scene held_stiff_handle(double youngs_modulus_pa) {
  Scene scene = small_handle();
  scene.bodies[0].material = stiff_material(youngs_modulus_pa);
  scene.planes.push_back({Vector3(plane_x_m, 0, 0), Vector3::UnitX()});
  scene.tool.substeps = 1;
  scene.sculpting.drag_per_s = 40.0;
  return scene;
}

ToolInput hand_at(double y_m) {
  ToolInput input = above(press_x_m, y_m);
  input.coupling_n_per_m = coupling_n_per_m;
  return input;
}

// Returns the mean of `of` over the nodes at the pressed x, interpolated between the slices on both sides.
template <class Of>
double mean_at_press(const LatticeMesh& mesh, const Of& of) {
  const double pitch_m = 0.06 / (mesh.count[2] - 1);
  double sum = 0.0, weights = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const double apart_m = std::abs(mesh.nodes[static_cast<std::size_t>(n)].x() - press_x_m);
    const double weight = std::max(0.0, 1.0 - apart_m / pitch_m);
    sum += weight * of(n, weight);
    weights += weight;
  }
  return sum / weights;
}

double sunk_m(const Simulation& simulation) {
  const SpringLattice& lattice = simulation.lattice();
  return mean_at_press(lattice.mesh(), [&](int n, double) { return -lattice.displacement(n).y(); });
}

// Returns the static displacement of the pressed point under a force. The static solver computes it on the
// cells of the implicit solver.
double sinking_at_rest_m(const Scene& scene, double force_n) {
  const BodyState body = make_body_state(scene.bodies[0], scene.planes, InstructionSet::baseline).value();
  const LatticeMesh& mesh = body.implicit_solver->mesh();
  std::vector<FixedAxis> held;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (mesh.nodes[static_cast<std::size_t>(n)].x() <= plane_x_m) fix_node(n, Vector3::Zero(), held);
  }
  StaticLoads loads;
  double weights = 0.0;
  mean_at_press(mesh, [&](int n, double weight) {
    loads.forces.push_back({n, {0.0, -weight * force_n, 0.0}});
    return weights += weight;
  });
  for (NodeForce& force : loads.forces) force.force_n /= weights;
  const StaticBody at_rest = StaticBody::make(mesh, scene.bodies[0].material, CellKind::hexahedra).value();
  const StaticResult result = rest_under_load(at_rest, loads, held).value();
  return mean_at_press(
      mesh, [&](int n, double) { return -result.displacement_m[static_cast<std::size_t>(n)].y(); });
}

TEST(StiffBodies, BendUnderTheHandAsTheStaticSolverSays) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double youngs : {2e9, 5e7}) {
    const Scene scene = held_stiff_handle(youngs);
    Simulation simulation = simulate(scene);
    Reaction reaction;
    // The hand moves 2 mm beyond the touch into the handle and waits.
    for (int tick = 0; tick < 600; ++tick) {
      reaction = simulation.advance(hand_at(0.0085 - 2e-3 * std::min(1.0, tick / 300.0)));
    }
    EXPECT_TRUE(reaction.touching);
    EXPECT_GT(reaction.force_n.y(), 0.1);
    // The hand is at 6.5 mm. The coupling spring is stretched by the distance from the hand to the tool.
    EXPECT_NEAR(reaction.force_n.y() / (coupling_n_per_m * (reaction.proxy.position_m.y() - 0.0065)), 1.0,
                0.01);
    // A sphere presses on a few nodes of one slice only, which accounts for a difference of 3 %.
    EXPECT_NEAR(sunk_m(simulation) / sinking_at_rest_m(scene, reaction.force_n.y()), 1.0, 0.03) << youngs;
    for (int tick = 0; tick < 600; ++tick) reaction = simulation.advance(hand_at(0.02));
    EXPECT_NEAR(sunk_m(simulation), 0.0, 1e-6) << youngs;
  }
}

// Clay that is bent and then changed to steel stays bent.
TEST(StiffBodies, KeepTheShapeInWhichTheyAreCast) {
  Scene scene = small_handle();
  scene.planes.push_back({Vector3(plane_x_m, 0, 0), Vector3::UnitX()});
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 600; ++tick) simulation.advance(above(press_x_m, 0.009 - 1e-5 * tick));
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(press_x_m, 0.03));
  const double bent = sunk_m(simulation);
  EXPECT_GT(bent, 3e-4);
  ASSERT_TRUE(simulation.apply(SetMaterial{stiff_material(193e9)}).ok());
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(press_x_m, 0.03));
  EXPECT_NEAR(sunk_m(simulation), bent, 1e-7);
  const ShapeState cast = simulation.shape();
  // Presses the steel body and then undoes the press.
  for (int tick = 0; tick < 200; ++tick) simulation.advance(hand_at(0.0085 - 1e-5 * tick));
  ASSERT_TRUE(simulation.restore(cast).ok());
  for (int tick = 0; tick < 100; ++tick) simulation.advance(hand_at(0.03));
  EXPECT_NEAR(sunk_m(simulation), bent, 1e-7);
}

// The hand holds the tool without a coupling spring and moves at up to 5 m/s.
TEST(StiffBodies, NoHandBlowsThemUp) {
  for (const double youngs : {2e6, 2e9, 193e9}) {
    if ((sanitized || !is_full_run()) && youngs != 2e9) continue;
    Scene scene = held_stiff_handle(youngs);
    scene.planes.clear();
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 1000; ++tick) {
      const double y = 0.02 * std::cos(0.25 * tick);
      simulation.advance(above(0.03 + 0.02 * std::sin(0.01 * tick), y));
    }
    const LatticeMesh& mesh = simulation.lattice().mesh();
    Vector3 middle = Vector3::Zero();
    for (int n = 0; n < mesh.node_count(); ++n) {
      middle += simulation.lattice().position(n) / mesh.node_count();
    }
    for (int n = 0; n < mesh.node_count(); ++n) {
      ASSERT_TRUE(simulation.lattice().position(n).allFinite()) << youngs;
      EXPECT_LT((simulation.lattice().position(n) - middle).norm(), 0.05) << youngs;
    }
  }
}

}  // namespace
}  // namespace spoonbill
