#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

Tool solid(ToolSolid of, std::optional<SoftTool> soft = std::nullopt) {
  Tool tool;
  tool.kind = ToolKind::solid;
  tool.body = std::make_shared<ToolBody>(ToolBody{std::move(of), std::move(soft)});
  return tool;
}

// Returns a fingertip of 10 x 5 x 25 mm, scaled down from a pebble of 40 x 20 x 100 mm.
Surface finger() {
  Surface surface = ellipsoid_tube(12, 12);
  for (std::vector<double>* values : {&surface.net.x, &surface.net.y, &surface.net.z}) {
    for (double& value : *values) value *= 0.25;
  }
  return surface;
}

SoftTool soft_flesh() {
  return {silicone(), {300, {}}, {Vector3(0, 0.001, 0), -Vector3::UnitY()}};
}

Scene held_handle(const Tool& tool) {
  Scene scene = small_handle();
  scene.tool = tool;
  scene.planes.push_back({Vector3(0.015, 0, 0), Vector3::UnitX()});
  return scene;
}

// Lowers the tool onto the handle. Returns the mean force over the last hundred ticks, because the light free
// end vibrates under the tool.
Reaction press(Simulation& simulation, double from_m, double to_m, int ticks = 300, double x_m = 0.05) {
  Reaction felt;
  for (int tick = 0; tick < ticks; ++tick) {
    const Reaction now = simulation.advance(above(x_m, from_m + (to_m - from_m) * tick / ticks));
    if (tick < ticks - 100) continue;
    felt.touching |= now.touching;
    felt.force_n += 0.01 * now.force_n;
  }
  return felt;
}

MeshSolid cube(double half_m) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices_m.push_back(half_m *
                              Vector3(corner & 4 ? 1 : -1, corner & 2 ? 1 : -1, corner & 1 ? 1 : -1));
  }
  for (const auto& [a, b, c, d] :
       {std::array{0u, 1u, 3u, 2u}, std::array{4u, 6u, 7u, 5u}, std::array{0u, 4u, 5u, 1u},
        std::array{2u, 3u, 7u, 6u}, std::array{0u, 2u, 6u, 4u}, std::array{1u, 5u, 7u, 3u}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return {clean_mesh(std::move(mesh), "cube").value()};
}

// Every rigid shape is lowered onto the handle, whose half thickness is 2.5 mm, until its lowest point is 1
// mm below the handle's upper side at rest.
TEST(SolidTool, OfEveryRigidShapePushes) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  struct Case {
    ToolSolid solid;
    double below_m;  // distance from the frame's origin to the lowest point
  };
  const Case cases[] = {
      {ImplicitShape(SphereShape{0.006}), 0.006},
      {ImplicitShape(EllipsoidShape{{0.008, 0.004, 0.006}}), 0.004},
      {ImplicitShape(CylinderShape{0.005, 0.008}), 0.008},
      {ImplicitShape(CapsuleShape{0.004, 0.004}), 0.008},
      {ImplicitShape(BoxShape{{0.004, 0.003, 0.01}}), 0.003},
      {ImplicitShape(ConeShape{0.006, 0.01}), 0.0},
      {ImplicitShape(TorusShape{0.006, 0.002}), 0.002},
      {ImplicitShape(SuperquadricShape{{0.006, 0.004, 0.006}, 0.5, 0.5}), 0.004},
      {cube(0.004), 0.004},
      {SurfaceSolid{finger()}, 0.0025},
  };
  for (const Case& each : cases) {
    Simulation simulation = simulate(held_handle(solid(each.solid)));
    const double before = lowest(simulation.surface());
    const Reaction reaction = press(simulation, 0.0035 + each.below_m, 0.0015 + each.below_m);
    EXPECT_TRUE(reaction.touching) << "case " << &each - cases;
    EXPECT_GT(reaction.force_n.y(), 0.0) << "pushes the hand back";
    EXPECT_LT(lowest(simulation.surface()), before - 0.3e-3) << "the end has bent down";
  }
}

// A sphere as a solid behaves like a sphere tool.
TEST(SolidTool, ASolidSphereActsAsTheSphereDoes) {
  Tool sphere;
  sphere.radius_m = 0.006;
  Simulation plain = simulate(held_handle(sphere));
  Simulation general = simulate(held_handle(solid(ImplicitShape(SphereShape{0.006}))));
  const Reaction one = press(plain, 0.0095, 0.0075), other = press(general, 0.0095, 0.0075);
  // The sphere pushes points of the lattice, the solid pushes the surface, and these differ slightly: here by
  // 1 % of the dent.
  EXPECT_NEAR(lowest(plain.surface()), lowest(general.surface()), 3e-5);
  EXPECT_NEAR(other.force_n.y() / one.force_n.y(), 1.0, 0.35);
}

TEST(SolidTool, ABSplineToolPullsWhatItGrips) {
  Tool tool = solid(SurfaceSolid{finger()});
  tool.action = ToolAction::pull;
  Simulation simulation = simulate(held_handle(tool));
  const double before =
      *std::max_element(simulation.surface().net.y.begin(), simulation.surface().net.y.end());
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(0.05, 0.0045 + 1e-5 * tick, true));
  EXPECT_GT(*std::max_element(simulation.surface().net.y.begin(), simulation.surface().net.y.end()),
            before + 0.5e-3);
}

TEST(SolidTool, WorksOnBothSidesOfAMirror) {
  for (const ToolSolid& of :
       {ToolSolid(ImplicitShape(BoxShape{{0.003, 0.003, 0.002}})), ToolSolid(SurfaceSolid{finger()})}) {
    Scene scene = held_handle(solid(of));
    scene.symmetry = {true, Vector3::Zero(), Vector3::UnitY()};
    Simulation simulation = simulate(scene);
    const double above_it = std::holds_alternative<SurfaceSolid>(of) ? 0.0025 : 0.003;
    for (int tick = 0; tick < 300; ++tick) {
      const Quaternion turned(Eigen::AngleAxisd(0.2, Vector3::UnitX()));
      simulation.advance({{Vector3(0.04, 0.0045 + above_it - 1e-5 * tick, 0), turned}, false, 0.0});
    }
    // The handle is pressed from both sides, so it stays centred.
    double middle = 0.0, most = 0.0;
    for (const double y : simulation.surface().net.y) {
      middle += y;
      most = std::max(most, std::abs(y));
    }
    EXPECT_LT(std::abs(middle) / static_cast<double>(simulation.surface().net.y.size()), 1e-4);
    EXPECT_LT(most, 0.01);
  }
}

TEST(SolidTool, ASoftToolGivesWayAndReturns) {
  Scene scene = held_handle(solid(SurfaceSolid{finger()}, soft_flesh()));
  scene.bodies[0].material = silicone();
  Simulation simulation = simulate(scene);
  const double before = lowest(simulation.surface());
  simulation.advance(above(0.018, 0.0065));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  ASSERT_EQ(snapshot.bodies.size(), 2u);
  const LatticeSnapshot rest = snapshot.bodies[1].lattice;
  // Returns the largest distance of a node from its position on a rigid tool.
  const auto bent = [&](double hand_m) {
    simulation.write_snapshot(snapshot);
    const LatticeSnapshot& now = snapshot.bodies[1].lattice;
    double most = 0.0;
    for (std::size_t n = 0; n < now.x.size(); ++n) {
      const Vector3 moved(now.x[n] - rest.x[n], now.y[n] - rest.y[n] - (hand_m - 0.0065),
                          now.z[n] - rest.z[n]);
      most = std::max(most, moved.norm());
    }
    return most;
  };
  const Reaction reaction = press(simulation, 0.0065, 0.003, 400, 0.018);
  EXPECT_TRUE(reaction.touching);
  EXPECT_GT(reaction.force_n.y(), 0.0);
  EXPECT_LT(lowest(simulation.surface()), before);
  EXPECT_GT(bent(0.003), 0.3e-3);
  for (int tick = 0; tick < 1500; ++tick) simulation.advance(above(0.018, 0.02));
  EXPECT_LT(bent(0.02), 0.05e-3) << "elastic";
}

TEST(SolidTool, IsExchangedWhileTheSimulationRuns) {
  Simulation simulation = simulate(held_handle(solid(SurfaceSolid{finger()}, soft_flesh())));
  press(simulation, 0.0055, 0.004);
  const ShapeState shape = simulation.shape();
  EXPECT_EQ(shape.lattices.size(), 1u) << "undo is of the bodies, not of the tool";
  ASSERT_TRUE(simulation.apply(SetTool{Tool{}}).ok());
  Snapshot snapshot;
  simulation.advance(above(0.05, 0.02));
  simulation.write_snapshot(snapshot);
  EXPECT_EQ(snapshot.bodies.size(), 1u);
  ASSERT_TRUE(simulation.apply(SetTool{solid(ImplicitShape(BoxShape{}))}).ok());
  EXPECT_TRUE(press(simulation, 0.014, 0.011).touching);
  ASSERT_TRUE(simulation.restore(shape).ok());
}

// Dragging a slider sends a command for each step. None of them may mesh the tool again.
TEST(SolidTool, ABodyThatIsHeldIsNotMeshedAgainForAnotherSetting) {
  Tool tool = solid(SurfaceSolid{finger()});
  Simulation simulation = simulate(held_handle(tool));
  tool.radius_m = 0.007;
  tool.action = ToolAction::pull;
  const Command change = SetTool{tool};
  const std::size_t before = allocation_count();
  EXPECT_TRUE(simulation.apply(change).ok());
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(simulation.scene().tool.radius_m, 0.007);
  tool.substeps = 0;
  EXPECT_FALSE(simulation.apply(SetTool{tool}).ok());
  Tool empty;
  empty.kind = ToolKind::solid;
  EXPECT_FALSE(simulation.apply(SetTool{empty}).ok());
}

// A sphere behaves the same, whatever tool was held before.
TEST(SolidTool, LeavesNothingOfItselfToASphere) {
  const Tool solids[] = {solid(ImplicitShape(BoxShape{{0.02, 0.02, 0.02}})), solid(SurfaceSolid{finger()})};
  for (const Tool& before : solids) {
    Simulation always = simulate(held_handle(Tool{})), exchanged = simulate(held_handle(before));
    ASSERT_TRUE(always.apply(SetTool{Tool{}}).ok());
    ASSERT_TRUE(exchanged.apply(SetTool{Tool{}}).ok());
    EXPECT_TRUE(press(always, 0.011, 0.0085).touching);
    EXPECT_TRUE(press(exchanged, 0.011, 0.0085).touching);
    EXPECT_EQ(always.state_hash(), exchanged.state_hash()) << &before - solids;
  }
}

// The tool moves from above the handle to below it in one tick and is stopped on its path.
TEST(SolidTool, AFastToolIsMetOnItsWay) {
  struct Case {
    Tool tool;
    double half_height_m;
  };
  Tool needle, ball;
  needle.kind = ToolKind::point;
  ball.radius_m = 0.001;
  const Case cases[] = {{needle, 0.0},
                        {ball, 0.001},
                        {solid(ImplicitShape(BoxShape{{0.001, 0.001, 0.001}})), 0.001},
                        {solid(cube(0.001)), 0.001},
                        {solid(SurfaceSolid{finger()}), 0.00275}};
  for (const Case& each : cases) {
    Simulation simulation = simulate(held_handle(each.tool));
    const double height = 0.0027 + each.half_height_m + 0.002;
    EXPECT_FALSE(simulation.advance(above(0.03, height)).touching);
    EXPECT_TRUE(simulation.advance(above(0.03, -height)).touching) << &each - cases;
  }
}

TEST(SolidTool, IsRefusedWhereItCannotBe) {
  const auto refusal = [](const Tool& tool, const Symmetry& symmetry = {}) {
    Scene scene = held_handle(tool);
    scene.symmetry = symmetry;
    const auto made = Simulation::make(scene, InstructionSet::baseline);
    return made.ok() ? Error(ErrorCode::internal, "") : made.error();
  };
  Tool without;
  without.kind = ToolKind::solid;
  EXPECT_EQ(refusal(without).code, ErrorCode::missing);
  EXPECT_EQ(refusal(without).field, "solid");
  const Error inside_out = refusal(solid(ImplicitShape(BoxShape{{0.004, -1.0, 0.004}})));
  EXPECT_EQ(inside_out.code, ErrorCode::out_of_range);
  EXPECT_EQ(inside_out.field, "half_extents_mm");
  EXPECT_TRUE(inside_out.message.starts_with("tool: ")) << inside_out.message;
  Surface open = finger();
  open.net.y[0] += 0.001;
  EXPECT_EQ(refusal(solid(SurfaceSolid{open})).code, ErrorCode::inconsistent);
  Tool soft = solid(SurfaceSolid{finger()}, soft_flesh());
  const Error mirrored = refusal(soft, {true, Vector3::Zero(), Vector3::UnitZ()});
  EXPECT_EQ(mirrored.code, ErrorCode::unsupported);
  EXPECT_EQ(mirrored.field, "symmetry");
  soft.action = ToolAction::pull;
  EXPECT_EQ(refusal(soft).code, ErrorCode::unsupported);
  EXPECT_EQ(refusal(soft).field, "action");
}

TEST(SolidTool, AllocatesNothingInATick) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  for (const Tool& tool : {solid(SurfaceSolid{finger()}), solid(SurfaceSolid{finger()}, soft_flesh()),
                           solid(ImplicitShape(TorusShape{0.006, 0.002}))}) {
    Simulation simulation = simulate(held_handle(tool));
    Snapshot snapshot;
    simulation.advance(above(0.05, 0.006));
    simulation.write_snapshot(snapshot);
    const std::size_t before = allocation_count();
    press(simulation, 0.006, 0.003, 100);
    simulation.write_snapshot(snapshot);
    EXPECT_EQ(allocation_count(), before);
  }
}

}  // namespace
}  // namespace spoonbill
