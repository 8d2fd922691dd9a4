// Tests bodies whose lattice is a box of cells: they stay at rest if untouched, deform if pressed, and rest
// on the ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/tube_rings.h"
#include "engine/simulation/ground_contact.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr double body_ring_m = 0.02, body_tube_m = 0.005, tool_radius_m = 0.004;

// Returns a torus about y whose tube is round to within 5 %. It has few control points, so that ticks are
// fast.
Surface ring() {
  constexpr int around = 20, along = 8;
  ControlNet net(around, along);
  const auto turn = [](int index, int count) { return 2.0 * std::numbers::pi * index / count; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double out = body_ring_m + body_tube_m * std::cos(turn(j, along));
      net.set_point(i, j,
                    {out * std::cos(turn(i, around)), body_tube_m * std::sin(turn(j, along)),
                     -out * std::sin(turn(i, around))});
    }
  }
  return make_surface(KnotVector::periodic_uniform(2, around).value(),
                      KnotVector::periodic_uniform(2, along).value(), std::move(net))
      .value();
}

Scene held_ring(double flatness = 1.0) {
  Scene scene = small_handle();
  Body& body = scene.bodies[0];
  body.surface = ring();
  for (double& y : body.surface.net.y) y *= flatness;
  body.lattice = {800, {}};
  scene.planes = {{Vector3(-body_ring_m, 0.0, 0.0), Vector3::UnitX()}};
  scene.tool.radius_m = tool_radius_m;
  return scene;
}

double farthest_moved_m(const Simulation& simulation, const Surface& before) {
  double farthest = 0.0;
  for (int i = 0; i < before.net.rows; ++i) {
    for (int j = 0; j < before.net.columns; ++j) {
      farthest = std::max(farthest, (simulation.surface().net.point(i, j) - before.net.point(i, j)).norm());
    }
  }
  return farthest;
}

// Returns the smallest height of the surface above the ground.
double gap_m(const Simulation& simulation) {
  const Ground& ground = *simulation.scene().ground;
  const Surface& surface = simulation.surface();
  constexpr int samples_u = 120, samples_v = 48;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < samples_u; ++i) {
    for (int j = 0; j < samples_v; ++j) {
      const Vector3 point = position(surface, surface.u.parameter_at(static_cast<double>(i) / samples_u),
                                     surface.v.parameter_at(static_cast<double>(j) / samples_v));
      least = std::min(least, ground.normal.dot(point - ground.point_m));
    }
  }
  return least;
}

double lowest_m(const Simulation& simulation) {
  const std::vector<double>& y = simulation.surface().net.y;
  return *std::min_element(y.begin(), y.end());
}

// The sides of a flat body are within one cell of each other, but neither pushes the other out.
TEST(BoxedBody, KeepsStillUntouched) {
  for (const double flatness : {1.0, 0.2, 0.05}) {
    const Scene scene = held_ring(flatness);
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < effort(100); ++tick) simulation.advance(above(0.0, 0.1));
    EXPECT_LT(farthest_moved_m(simulation, scene.bodies[0].surface), 1e-9) << flatness;
  }
}

// The section of the ring is a square and thick enough for self-contact. Points on two faces beside their
// common edge must not count as self-contact.
TEST(BoxedBody, WithSharpEdgesKeepsStillUntouched) {
  constexpr int along = 24;
  ControlNet net(4, along);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < along; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / along;
      const double out = body_ring_m + (i < 2 ? body_tube_m : -body_tube_m),
                   up = i == 0 || i == 3 ? body_tube_m : -body_tube_m;
      net.set_point(i, j, {out * std::cos(angle), up, -out * std::sin(angle)});
    }
  }
  Scene scene = held_ring();
  Surface& surface = scene.bodies[0].surface;
  surface = make_surface(KnotVector::periodic_uniform(1, 4).value(),
                         KnotVector::periodic_uniform(2, along).value(), std::move(net))
                .value();
  Simulation simulation = simulate(scene);
  ASSERT_FALSE(simulation.lattice().mesh().slender);
  const Surface before = simulation.surface();
  for (int tick = 0; tick < effort(100); ++tick) simulation.advance(above(0.0, 0.1));
  EXPECT_LT(farthest_moved_m(simulation, before), 1e-9);
}

TEST(BoxedBody, IsDentedAndKeepsItsDent) {
  Simulation simulation = simulate(held_ring());
  double largest_n = 0.0;
  for (int tick = 0; tick < 900; ++tick) {
    const double displacement_m = tick < 400 ? 0.004 * tick / 400.0 : tick < 500 ? 0.004 : -0.02;
    const double force =
        simulation.advance(above(body_ring_m, body_tube_m + tool_radius_m - displacement_m)).force_n.norm();
    if (tick < 500) largest_n = std::max(largest_n, force);
  }
  EXPECT_GT(largest_n, 0.0);
  const double moved_m = farthest_moved_m(simulation, held_ring().bodies[0].surface);
  EXPECT_GT(moved_m, 0.001);
  EXPECT_LT(moved_m, 0.01);
}

TEST(BoxedBody, TickAllocatesNothing) {
  Simulation simulation = simulate(held_ring());
  const double touch_m = body_tube_m + tool_radius_m;
  for (int tick = 0; tick < 5; ++tick) simulation.advance(above(body_ring_m, touch_m - 1e-4 * tick));
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 20; ++tick) simulation.advance(above(body_ring_m, touch_m - 1e-4 * tick));
  EXPECT_EQ(allocation_count(), before);
}

// The test runs with springs and with the implicit solver.
TEST(BoxedBody, RestsOnTheGround) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double youngs_modulus_pa : {2e5, 2e9}) {
    Scene scene = held_ring();
    scene.planes.clear();
    scene.bodies[0].material.plastic = false;
    scene.bodies[0].material.youngs_modulus_pa = youngs_modulus_pa;
    scene.sculpting.gravity_m_per_s2 = {0.0, -9.81, 0.0};
    scene.sculpting.drag_per_s = 120.0;
    scene.ground = Ground{{0.0, -body_tube_m, 0.0}, Vector3::UnitY(), 0.5};
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 500; ++tick) simulation.advance(above(0.0, 0.1));
    EXPECT_NEAR(lowest_m(simulation), -body_tube_m, 0.1 * body_tube_m) << youngs_modulus_pa;
  }
}

// The body starts on its edge and tips over, because cell corners outside the skin do not bear it.
TEST(BoxedBody, TouchesTheGroundWithItsSkinHoweverItLies) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  struct Case {
    int nodes;
    double youngs_modulus_pa;
  };
  for (const Case& each : {Case{800, 2e5}, Case{800, 2e9}, Case{4000, 2e9}}) {
    if (each.nodes > 800 && !is_full_run()) continue;
    Scene scene = held_ring();
    scene.planes.clear();
    scene.bodies[0].lattice.node_budget = each.nodes;
    scene.bodies[0].material.plastic = false;
    scene.bodies[0].material.youngs_modulus_pa = each.youngs_modulus_pa;
    scene.sculpting.drag_per_s = 120.0;
    scene.ground = Ground{Vector3::Zero(), Vector3(0.6, 0.8, 0.0), 0.5};
    scene.sculpting.gravity_m_per_s2 = -9.81 * scene.ground->normal;
    scene.ground->point_m = gap_m(simulate(scene)) * scene.ground->normal;
    Simulation simulation = simulate(scene);
    const double cell = static_cast<double>(simulation.lattice().cell_size_m());
    for (int tick = 0; tick < 1500; ++tick) {
      simulation.advance(above(0.0, 0.1));
      // The body penetrates the ground briefly when it falls flat.
      if (tick % 10 > 0) continue;
      EXPECT_NEAR(gap_m(simulation) / cell, 0.0, 0.1) << each.nodes << ", " << tick;
    }
    EXPECT_NEAR(gap_m(simulation) / cell, 0.0, ground_depth_limit_cells) << each.nodes;
  }
}

}  // namespace
}  // namespace spoonbill
