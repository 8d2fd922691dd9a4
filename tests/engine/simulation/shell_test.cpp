// Tests thin shells in a simulation. A tool touches the face of the shell that it meets first, and dents the
// shell from either side.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/lattice/shells.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr double shell_radius_m = 0.03, shell_thickness_m = 0.002, shell_tool_radius_m = 0.008;
constexpr double opening_rad = std::numbers::pi / 3.0;
constexpr double rim_m = -0.5 * shell_radius_m;  // height of the rim, y upwards

Material shell_material(double youngs_modulus_pa) {
  Material material;
  material.name = "elastic";
  material.source = "test";
  material.youngs_modulus_pa = youngs_modulus_pa;
  material.poissons_ratio = 0.35;
  material.density_kg_per_m3 = 1100.0;
  material.damping_time_s = 1.1e-5;
  return material;
}

// Returns a clay bowl about the origin, open upwards and fixed at the rim. Its surface is the outer face of
// the shell.
Scene clay_bowl() {
  Scene scene = small_handle();
  Body& body = scene.bodies[0];
  body.surface = spherical_bowl(shell_radius_m, opening_rad);
  body.shell_thickness_m = shell_thickness_m;
  body.lattice = {1000, {}};
  scene.planes = {{Vector3(0.0, rim_m - 0.002, 0.0), -Vector3::UnitY()}};
  scene.tool.radius_m = shell_tool_radius_m;
  return scene;
}

ToolInput at_height(double y_m) {
  return above(0.0, y_m);
}

bool is_finite(const Simulation& simulation) {
  for (const Vector3& position : simulation.lattice().positions()) {
    if (!position.allFinite() || position.norm() > 0.2) return false;
  }
  return true;
}

double bottom_m(const Simulation& simulation) {
  return position(simulation.surface(), 0.0, simulation.surface().v.domain_start()).y();
}

// Moves the tool down (or up) by a hundredth of a millimetre per tick. Returns the position of its centre
// when it first touches.
double first_touch_m(const Scene& scene, double from_m, double to_m) {
  Simulation simulation = simulate(scene);
  const double step = to_m > from_m ? 1e-5 : -1e-5;
  const int ticks = static_cast<int>(std::abs(to_m - from_m) / 1e-5);
  for (int tick = 0; tick < ticks; ++tick) {
    if (simulation.advance(at_height(from_m + step * tick)).touching) return from_m + step * tick;
  }
  return to_m;
}

TEST(Shell, IsTouchedOnTheFaceThatIsMet) {
  const Scene scene = clay_bowl();
  // From below, the tool touches the surface. From above, it touches the far face, one thickness higher.
  EXPECT_NEAR(first_touch_m(scene, -shell_radius_m - shell_tool_radius_m - 0.003, -0.03),
              -shell_radius_m - shell_tool_radius_m, 5e-5);
  EXPECT_NEAR(first_touch_m(scene, -shell_radius_m + shell_thickness_m + shell_tool_radius_m + 0.003, -0.03),
              -shell_radius_m + shell_thickness_m + shell_tool_radius_m, 5e-5);
  Scene point = scene;
  point.tool.kind = ToolKind::point;
  EXPECT_NEAR(first_touch_m(point, -shell_radius_m - 0.003, -0.025), -shell_radius_m, 5e-5);
  EXPECT_NEAR(first_touch_m(point, -shell_radius_m + shell_thickness_m + 0.003, -0.035),
              -shell_radius_m + shell_thickness_m, 5e-5);
}

TEST(Shell, OfClayIsDentedFromEitherSideAndStaysSo) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const bool from_below : {true, false}) {
    // The default run presses the far face, which needs the shell's thickness.
    if (from_below && !is_full_run()) continue;
    Simulation simulation = simulate(clay_bowl());
    const double sign = from_below ? 1.0 : -1.0;
    const double touch_m = from_below ? -shell_radius_m - shell_tool_radius_m
                                      : -shell_radius_m + shell_thickness_m + shell_tool_radius_m;
    const double before = bottom_m(simulation);
    double largest_n = 0.0;
    for (int tick = 0; tick < 1200; ++tick) {
      const double way = tick < 500 ? 0.004 * tick / 500.0 : tick < 600 ? 0.004 : -0.004;
      largest_n = std::max(largest_n, simulation.advance(at_height(touch_m + sign * way)).force_n.norm());
      ASSERT_TRUE(is_finite(simulation)) << tick;
    }
    const double dent = sign * (bottom_m(simulation) - before);
    EXPECT_GT(dent, 0.0015) << "it stays";
    EXPECT_LT(dent, 0.0045) << "no farther than it was pressed";
    EXPECT_GT(largest_n, 0.0);
    EXPECT_FALSE(simulation.advance(at_height(touch_m - sign * 0.004)).touching);
  }
}

TEST(Shell, OfASteadierMaterialBendsAndComesBack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double youngs : {2e5, 2e9}) {
    Scene scene = clay_bowl();
    scene.bodies[0].material = shell_material(youngs);
    scene.sculpting.drag_per_s = 40.0;
    scene.tool.substeps = 1;
    Simulation simulation = simulate(scene);
    const double before = bottom_m(simulation);
    double highest = before;
    for (int tick = 0; tick < 1500; ++tick) {
      ToolInput input =
          at_height(-shell_radius_m - shell_tool_radius_m + (tick < 700 ? 0.002 * tick / 700.0 : -0.004));
      input.coupling_n_per_m = 700.0;
      simulation.advance(input);
      ASSERT_TRUE(is_finite(simulation)) << tick;
      highest = std::max(highest, bottom_m(simulation));
    }
    EXPECT_GT(highest - before, youngs < 1e6 ? 2e-4 : 1e-7);
    EXPECT_NEAR(bottom_m(simulation), before, 2e-5) << youngs << " Pa";
  }
}

TEST(Shell, RestsWhereNothingTouchesIt) {
  for (const bool ring : {false, true}) {
    Scene scene = clay_bowl();
    scene.planes.clear();
    if (ring) scene.bodies[0].surface = open_ring(0.02, 0.015);
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 50; ++tick) simulation.advance(at_height(0.2));
    for (int n = 0; n < simulation.lattice().mesh().node_count(); ++n) {
      EXPECT_LT(simulation.lattice().displacement(n).norm(), 1e-7);
    }
  }
}

// A point, which could slip through, and a sphere strike the shell along fixed paths at up to 5 m/s.
TEST(Shell, OutlastsFastStrokes) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene = clay_bowl();
  for (const ToolKind kind : {ToolKind::point, ToolKind::sphere}) {
    scene.tool.kind = kind;
    Simulation simulation = simulate(scene);
    Vector3 place(0.0, -0.06, 0.0);
    const Vector3 ends[] = {{0.0, 0.03, 0.0},    {0.02, -0.05, 0.01}, {-0.03, 0.0, 0.0},
                            {0.04, -0.02, 0.02}, {0.0, -0.025, 0.0},  {0.01, -0.06, -0.02},
                            {-0.01, 0.02, 0.01}, {0.0, -0.06, 0.0}};
    for (const Vector3& end : ends) {
      while ((end - place).norm() > 0.005) {
        place += 0.005 * (end - place).normalized();
        simulation.advance({{place, Quaternion::Identity()}, false, 700.0});
        ASSERT_TRUE(is_finite(simulation));
      }
      for (int tick = 0; tick < 100; ++tick) {
        simulation.advance({{place, Quaternion::Identity()}, false, 700.0});
        ASSERT_TRUE(is_finite(simulation));
      }
    }
  }
}

// The tool presses the ring at its seam, or a quarter of a turn from the seam. The ring must be dented
// equally in both cases.
TEST(Shell, RingGivesWayAtItsSeamAsElsewhere) {
  const auto pressed = [](double seam_turn) {
    Scene scene = clay_bowl();
    scene.bodies[0].surface = open_ring(0.02, 0.015, seam_turn);
    scene.planes = {{Vector3(-0.015, 0.0, 0.0), Vector3::UnitX()}};
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 400; ++tick) {
      const double x = 0.02 + shell_tool_radius_m - 0.003 * std::min(1.0, tick / 300.0);
      simulation.advance({{Vector3(x, 0.0075, 0.0), Quaternion::Identity()}, false, 0.0});
    }
    const Surface& surface = simulation.surface();
    double least = 1.0;
    for (int s = 0; s < 64; ++s) {
      const Vector3 at = position(surface, surface.u.domain_start() + s / 64.0, 0.5);
      if (at.x() > 0.0 && std::abs(at.z()) < 1e-3) least = std::min(least, at.x());
    }
    return least;
  };
  const double at_seam = pressed(0.0), elsewhere = pressed(0.25);
  EXPECT_LT(at_seam, 0.0185);
  EXPECT_NEAR(at_seam, elsewhere, 2e-4);
}

// A pillow of jelly falls into the bowl, or onto its outside with inverted gravity, and stays on it. Friction
// keeps it on the outside, from which it would slide otherwise.
TEST(Shell, BearsAnotherBody) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const bool upside_down : {false, true}) {
    if (upside_down && !is_full_run()) break;
    Scene scene = clay_bowl();
    scene.bodies[0].material = shell_material(2e9);
    const double sign = upside_down ? -1.0 : 1.0;
    const double floor_m = upside_down ? -shell_radius_m : -shell_radius_m + shell_thickness_m;
    // An ellipsoid with semi-axes of 20, 10 and 50 mm, scaled to a quarter; it is flattest along y.
    Surface pillow = ellipsoid_tube(12, 12, {0, 0, 0});
    for (auto* axis : {&pillow.net.x, &pillow.net.y, &pillow.net.z}) {
      for (double& value : *axis) value *= 0.25;
    }
    for (double& y : pillow.net.y) y += floor_m + sign * 0.0045;
    scene.bodies.push_back({"pillow", pillow, shell_material(1e4), {300, {}}});
    for (Body& body : scene.bodies) body.material.friction = 0.5;
    scene.sculpting.gravity_m_per_s2 = {0.0, -9.81 * sign, 0.0};
    scene.sculpting.drag_per_s = 20.0;
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < (is_full_run() ? 1000 : 400); ++tick) simulation.advance(at_height(0.3));
    double lowest = 1.0;
    for (const Vector3& node : simulation.lattice(1).positions()) {
      lowest = std::min(lowest, sign * node.y());
    }
    EXPECT_GT(lowest, sign * floor_m - 5e-4) << "it has not sunk in";
    EXPECT_LT(lowest, sign * floor_m + 1e-3) << "it lies on the bowl";
  }
}

// The nodes at the seam of a closed shell, which are stored twice, must weigh only once.
TEST(Shell, RingWeighsOnItsSupportOnce) {
  Scene scene = small_handle();
  Body& body = scene.bodies[0];
  body.surface = open_ring(0.02, 0.02);
  body.shell_thickness_m = shell_thickness_m;
  body.lattice.counts = {25, 2, 5};
  body.supports = {{{{0.0, 0.3}}, {}}};
  scene.sculpting.gravity_m_per_s2 = Vector3(0.0, -9.81, 0.0);
  scene.sculpting.drag_per_s = 60.0;
  for (const double youngs_modulus_pa : {1e5, 2e9}) {
    body.material = shell_material(youngs_modulus_pa);
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 1500; ++tick) simulation.advance(at_height(0.1));
    const double weight_n = 9.81 * simulation.lattice().mass_kg();
    // The tolerance covers the remaining motion.
    EXPECT_NEAR(simulation.support_force_n(0).y() / weight_n, 1.0, 0.005) << youngs_modulus_pa;
  }
}

TEST(Shell, TickAllocatesNothing) {
  Simulation simulation = simulate(clay_bowl());
  for (int tick = 0; tick < 5; ++tick)
    simulation.advance(at_height(-shell_radius_m - shell_tool_radius_m + 1e-4 * tick));
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 20; ++tick) {
    simulation.advance(at_height(-shell_radius_m - shell_tool_radius_m + 1e-4 * tick));
  }
  EXPECT_EQ(allocation_count(), before);
}

TEST(Shell, KeepsItsKindThroughCommands) {
  Simulation simulation = simulate(clay_bowl());
  ASSERT_TRUE(simulation.apply(SetMaterial{shell_material(2e9), 0}).ok());
  for (int tick = 0; tick < 20; ++tick) {
    simulation.advance(at_height(-shell_radius_m - shell_tool_radius_m + 1e-4 * tick));
  }
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  ASSERT_TRUE(simulation.apply(RemovePlanes{}).ok());
  for (int tick = 0; tick < 20; ++tick) simulation.advance(at_height(-shell_radius_m - shell_tool_radius_m));
  EXPECT_TRUE(is_finite(simulation));
  EXPECT_TRUE(simulation.lattice().mesh().thin);
}

}  // namespace
}  // namespace spoonbill
