// Tests where a sphere touches a body: at its surface, however coarse the control net, and at its nearest
// wall if the sphere starts inside the body.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "engine/bspline/evaluate.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

constexpr double sphere_m = 0.006;
constexpr double start_m = 1e-4;  // gap from which a sphere approaches a body

// Returns a scene with a pebble whose control net has `count` points in each direction.
Scene pebble(int count) {
  Scene scene = small_handle();
  scene.bodies = {{"pebble", ellipsoid_tube(count, count), silicone(), {1500, {}}}};
  scene.planes = {{Vector3(0.0, -0.004, 0.0), Vector3::UnitY()}};
  scene.tool.radius_m = sphere_m;
  return scene;
}

// Returns the distance of a point from a surface, found at samples so dense that its error is below 0.02 mm.
double distance_m(const Surface& surface, const Vector3& point) {
  constexpr int samples = 200;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < samples; ++i) {
    for (int j = 0; j <= samples; ++j) {
      const double u = surface.u.domain_start() + surface.u.domain_length() * i / samples;
      const double v = surface.v.domain_start() + surface.v.domain_length() * j / samples;
      least = std::min(least, (position(surface, u, v) - point).norm());
    }
  }
  return least;
}

TEST(SphereContact, StartsAtTheSurfaceOfACoarseNet) {
  for (const double x_m : {-0.006, -0.003, 0.0, 0.002, 0.005}) {
    // The surface of this net bulges far over the chords between samples.
    Simulation simulation = simulate(pebble(5));
    const Surface surface = simulation.surface();
    Vector3 centre(x_m, 0.02, 0.004);
    for (int step = 0; step < 10; ++step) {
      centre.y() -= distance_m(surface, centre) - sphere_m - start_m;
    }
    double force_n = 0.0;
    while (centre.y() > 0.0 && !(force_n > 0.0)) {
      centre.y() -= 2e-6;
      force_n = simulation.advance({{centre, Quaternion::Identity()}, false, 0.0}).force_n.norm();
    }
    EXPECT_NEAR(distance_m(surface, centre), sphere_m, 5e-5) << x_m;
  }
}

TEST(SphereContact, PushesOutASphereThatStartsInside) {
  Simulation simulation = simulate(pebble(20));
  const Vector3 centre(0.001, 0.0115, 0.002);
  const ToolInput held{{centre, Quaternion::Identity()}, false, 0.0};
  Reaction reaction = simulation.advance(held);
  EXPECT_GT(reaction.force_n.y(), 0.0);
  for (int tick = 1; tick < 1000; ++tick) reaction = simulation.advance(held);
  EXPECT_GT(reaction.force_n.y(), 0.5 * reaction.force_n.norm());
  EXPECT_GT(distance_m(simulation.surface(), centre), 0.9 * sphere_m);
}

// A body that is about to fall onto the sphere in this tick meets it at once, not a tick later.
TEST(SphereContact, StopsAFallingBodyAtItsSurface) {
  Scene scene = pebble(20);
  scene.planes.clear();
  scene.sculpting.real_time = true;
  scene.sculpting.drag_per_s = 0.0;
  scene.sculpting.gravity_m_per_s2 = {0.0, -9.81, 0.0};
  Simulation simulation = simulate(scene);
  // The sphere is so far below that the body falls 0.5 mm per tick when it arrives.
  const Vector3 centre(0.0, -0.03, 0.0);
  double force_n = 0.0;
  for (int tick = 0; tick < 200 && !(force_n > 0.0); ++tick) {
    force_n = simulation.advance({{centre, Quaternion::Identity()}, false, 0.0}).force_n.norm();
  }
  EXPECT_GT(force_n, 0.0);
  EXPECT_NEAR(distance_m(simulation.surface(), centre), sphere_m, 1e-4);
}

}  // namespace
}  // namespace spoonbill
