// Tests trimmed shells in a simulation: the tool touches only the kept part.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "loops.h"
#include "tests/engine/allocations.h"
#include "tests/engine/material/lattice/shells.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr double side_m = 0.06, thickness_m = 0.002, hole_radius_m = 0.011, tool_radius_m = 0.008;
constexpr double from_m = 0.02;

// Returns u and v of a point on the flat sheet by Newton's method, which is exact after one step where the
// sheet is linear in u and v.
Eigen::Vector2d parameters_at(const Surface& surface, double x_m, double z_m) {
  Eigen::Vector2d at(0.5 * (surface.u.domain_start() + surface.u.domain_end()),
                     0.5 * (surface.v.domain_start() + surface.v.domain_end()));
  for (int step = 0; step < 20; ++step) {
    const SurfacePoint point = evaluate(surface, at.x(), at.y());
    Eigen::Matrix2d slope;
    slope << point.du.x(), point.dv.x(), point.du.z(), point.dv.z();
    at += slope.inverse() * Eigen::Vector2d(x_m - point.position_m.x(), z_m - point.position_m.z());
  }
  return at;
}

// Returns a scene with a flat sheet of clay, fixed at one end, that may have a round hole in its centre.
Scene sheet_scene(bool with_hole, Vector3* centre_m = nullptr) {
  Scene scene = small_handle();
  Body& body = scene.bodies[0];
  body.surface = flat_sheet(side_m, side_m);
  body.shell_thickness_m = thickness_m;
  body.lattice = {600, {}};
  const SurfacePoint centre =
      evaluate(body.surface, 0.5 * (body.surface.u.domain_start() + body.surface.u.domain_end()),
               0.5 * (body.surface.v.domain_start() + body.surface.v.domain_end()));
  const Vector3 middle = centre.position_m;
  if (centre_m != nullptr) *centre_m = middle;
  scene.planes = {{middle - Vector3(0.4 * side_m, 0.0, 0.0), Vector3::UnitX()}};
  scene.tool.radius_m = tool_radius_m;
  if (!with_hole) return scene;
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < 200; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 200;
    corners.push_back(parameters_at(body.surface, middle.x() + hole_radius_m * std::cos(angle),
                                    middle.z() + hole_radius_m * std::sin(angle)));
  }
  TrimLoop loop = polygon_loop(body.surface.u, body.surface.v, corners);
  if (signed_area(to_polygon(loop, body.surface.u, body.surface.v)) > 0.0) {
    loop = polygon_loop(body.surface.u, body.surface.v, backwards(corners));
  }
  body.trims = {loop};
  return scene;
}

struct Descent {
  bool touched = false;
  double first_touch_m = 0.0;
  double largest_n = 0.0;
};

Descent come_down(const Scene& scene, const Vector3& over_m, double to_m) {
  Simulation simulation = simulate(scene);
  Descent descent;
  for (double height = from_m; height > to_m; height -= 2e-5) {
    ToolInput hand;
    hand.pose.position_m = over_m + Vector3(0.0, height, 0.0);
    const Reaction reaction = simulation.advance(hand);
    if (reaction.touching && !descent.touched) {
      descent.touched = true;
      descent.first_touch_m = height;
    }
    descent.largest_n = std::max(descent.largest_n, reaction.force_n.norm());
  }
  return descent;
}

TEST(TrimmedBody, ASphereFallsThroughAHoleWithoutForce) {
  Vector3 middle;
  const Scene pierced = sheet_scene(true, &middle);
  const Descent through = come_down(pierced, middle, -from_m);
  EXPECT_FALSE(through.touched);
  EXPECT_EQ(through.largest_n, 0.0);
  const Descent whole = come_down(sheet_scene(false), middle, 0.005);
  EXPECT_TRUE(whole.touched);
  EXPECT_GT(whole.largest_n, 0.005);
}

TEST(TrimmedBody, ASphereIsFeltBesideAHoleWhereItTouches) {
  Vector3 middle;
  const Scene pierced = sheet_scene(true, &middle);
  const Vector3 beside = middle + Vector3(0.5 * hole_radius_m + 0.012, 0.0, 0.0);
  const Descent on_sheet = come_down(pierced, beside, 0.005);
  EXPECT_GT(on_sheet.largest_n, 0.005);
  // The tool first touches at the distance of its radius, within two steps of 0.02 mm and the sway of the
  // sheet.
  EXPECT_NEAR(on_sheet.first_touch_m, tool_radius_m, 5e-5);
  // With the tool 8 mm from the hole's centre, the rim is 3 mm from the tool's axis.
  const Descent on_rim = come_down(pierced, middle + Vector3(0.0, 0.0, 0.008), 0.004);
  EXPECT_GT(on_rim.largest_n, 0.0);
  EXPECT_NEAR(on_rim.first_touch_m, std::sqrt(tool_radius_m * tool_radius_m - 0.003 * 0.003), 5e-5);
}

TEST(TrimmedBody, ATickAllocatesNothing) {
  Vector3 middle;
  Simulation simulation = simulate(sheet_scene(true, &middle));
  ToolInput hand;
  hand.pose.position_m = middle + Vector3(0.0, tool_radius_m - 0.0005, 0.0085);
  simulation.advance(hand);
  int touching = 0;
  const auto before = allocation_count();
  for (int tick = 0; tick < 50; ++tick) {
    hand.pose.position_m.y() -= 2e-5;
    touching += simulation.advance(hand).touching;
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(touching, 0);
}

TEST(TrimmedBody, IsRefusedWithLoopsThatDoNotFit) {
  Scene scene = sheet_scene(true);
  scene.bodies[0].trims.push_back(scene.bodies[0].trims[0]);
  const auto simulation = Simulation::make(scene, InstructionSet::baseline);
  ASSERT_FALSE(simulation.ok());
  EXPECT_NE(simulation.error().message.find("trim loop"), std::string::npos) << simulation.error().message;
}

TEST(TrimmedBody, TrimsStayWhenKnotsAreAdded) {
  Vector3 middle;
  Simulation simulation = simulate(sheet_scene(true, &middle));
  // The hand first presses the sheet, so that the refinement has a deformation to follow.
  ToolInput hand;
  for (int tick = 0; tick < 100; ++tick) {
    hand.pose.position_m = middle + Vector3(0.018, tool_radius_m - 2e-5 * tick, 0.0);
    simulation.advance(hand);
  }
  const Status refined = simulation.apply(RefineKnots{});
  ASSERT_TRUE(refined.ok()) << refined.error().message;
  hand.pose.position_m = middle + Vector3(0.0, from_m, 0.0);
  simulation.advance(hand);  // lets the pressed point go
  for (double height = from_m; height > -from_m; height -= 1e-4) {
    hand.pose.position_m = middle + Vector3(0.0, height, 0.0);
    EXPECT_FALSE(simulation.advance(hand).touching) << height;
  }
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  ASSERT_TRUE(snapshot.bodies[0].surface.trim);
  EXPECT_FALSE(snapshot.bodies[0].surface.trim->contains(
      0.5 * (snapshot.bodies[0].surface.u.domain_start() + snapshot.bodies[0].surface.u.domain_end()),
      0.5 * (snapshot.bodies[0].surface.v.domain_start() + snapshot.bodies[0].surface.v.domain_end())));
}

TEST(TrimmedBody, KeptAreaShareIsThatOfTheMetres) {
  const Scene pierced = sheet_scene(true);
  const Body& body = pierced.bodies[0];
  const double hole_m2 = 0.5 * 200 * hole_radius_m * hole_radius_m * std::sin(2.0 * std::numbers::pi / 200);
  // The triangles of a flat sheet are exact if their corners are.
  EXPECT_NEAR(remaining_area_fraction(body.surface, *make_trimmed_area(body).value()),
              1.0 - hole_m2 / (side_m * side_m), 1e-5);
}

}  // namespace
}  // namespace spoonbill
