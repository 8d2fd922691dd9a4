#include "engine/simulation/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// Lowers the tool from y = 20 mm to `deepest` and raises it again within `ticks`.
void push(Simulation& simulation, double x, double deepest, int ticks, bool gripping = false) {
  for (int tick = 0; tick < ticks; ++tick) {
    const double share = 1.0 - std::abs(2.0 * tick / ticks - 1.0);
    simulation.advance(above(x, 0.02 + share * (deepest - 0.02), gripping));
  }
}

double largest_move(const Simulation& simulation, const Surface& from, double first_v, double last_v) {
  double largest = 0.0;
  for (int a = 0; a < 24; ++a) {
    for (int b = 0; b <= 60; ++b) {
      const double u = a / 24.0, v = first_v + (last_v - first_v) * b / 60.0;
      largest = std::max(
          largest,
          (evaluate(simulation.surface(), u, v).position_m - evaluate(from, u, v).position_m).norm());
    }
  }
  return largest;
}

TEST(Simulation, UntouchedStaysUntouchedToTheLastBit) {
  Simulation simulation = simulate(small_handle());
  const ControlNet before = simulation.surface().net;
  for (int tick = 0; tick < 200; ++tick) EXPECT_FALSE(simulation.advance(above(0.03, 0.05)).touching);
  EXPECT_EQ(simulation.surface().net.x, before.x);
  EXPECT_EQ(simulation.surface().net.y, before.y);
  EXPECT_EQ(simulation.surface().net.z, before.z);
}

TEST(Simulation, APlacedPlaneChangesNoShape) {
  Simulation simulation = simulate(small_handle());
  push(simulation, 0.045, 0.006, 400);
  const Surface before = simulation.surface();
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
  EXPECT_GT(simulation.surface().net.columns, before.net.columns);
  EXPECT_LT(largest_move(simulation, before, 0.0, 0.06), 1e-12);
}

TEST(Simulation, FixedNodesAndTheFixedSurfaceStay) {
  Simulation simulation = simulate(small_handle());
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
  const Surface before = simulation.surface();
  push(simulation, 0.05, -0.003, 1200);
  EXPECT_EQ(largest_move(simulation, before, 0.0, 0.0199), 0.0);
  EXPECT_GT(largest_move(simulation, before, 0.05, 0.06), 1e-3);
  int fixed = 0;
  for (int n = 0; n < simulation.lattice().mesh().node_count(); ++n) {
    if (simulation.lattice().mesh().nodes[n].x() > 0.02) continue;
    ++fixed;
    EXPECT_EQ(simulation.lattice().displacement(n), Vector3::Zero());
  }
  EXPECT_GT(fixed, 20);
}

TEST(Simulation, ThePolesStayClosed) {
  Simulation simulation = simulate(small_handle());
  push(simulation, 0.05, 0.004, 400);
  const ControlNet& net = simulation.surface().net;
  for (int i = 1; i < net.rows; ++i) {
    EXPECT_LT((net.point(i, 0) - net.point(0, 0)).norm(), 1e-8);
    EXPECT_LT((net.point(i, net.columns - 1) - net.point(0, net.columns - 1)).norm(), 1e-8);
  }
}

// With few substeps the inertia is large, so a stroke acts locally and hardly moves the far end. With many
// substeps the whole body follows.
TEST(Simulation, SubstepsReachFromLocalToGlobal) {
  double share[2];
  for (const int which : {0, 1}) {
    Scene scene = small_handle();
    scene.planes.push_back({Vector3(0.008, 0, 0), Vector3::UnitX()});
    scene.tool.substeps = which == 0 ? 1 : 8;
    Simulation simulation = simulate(scene);
    const Surface before = simulation.surface();
    for (int tick = 0; tick < 250; ++tick) simulation.advance(above(0.035, 0.009 - 1.6e-5 * tick));
    const double near = largest_move(simulation, before, 0.034, 0.036),
                 far = largest_move(simulation, before, 0.055, 0.06);
    share[which] = far / near;
  }
  EXPECT_LT(share[0], 0.5 * share[1]);
}

TEST(Simulation, PullRaisesWhatItGripsUntilReleased) {
  Scene scene = small_handle();
  scene.tool.action = ToolAction::pull;
  scene.tool.substeps = 1;
  Simulation simulation = simulate(scene);
  const Surface before = simulation.surface();
  const double touch = 0.0025 + 0.006 - 0.0003;
  for (int tick = 0; tick < 20; ++tick) simulation.advance(above(0.03, touch, true));
  Reaction reaction;
  for (int tick = 0; tick < 300; ++tick)
    reaction = simulation.advance(above(0.03, touch + 1e-5 * tick, true));
  EXPECT_TRUE(reaction.touching);
  EXPECT_LT(reaction.force_n.y(), 0.0);  // the material pulls back
  const Vector3 top = evaluate(simulation.surface(), 0.75, 0.03).position_m;
  EXPECT_GT(top.y() - evaluate(before, 0.75, 0.03).position_m.y(), 1e-3);
  simulation.advance(above(0.03, touch + 0.003));
  for (int tick = 0; tick < 5; ++tick) reaction = simulation.advance(above(0.03, 0.03));
  EXPECT_FALSE(reaction.touching);
  EXPECT_EQ(reaction.force_n, Vector3::Zero());
}

TEST(Simulation, APointToolPressesADent) {
  Scene scene = small_handle();
  scene.tool.kind = ToolKind::point;
  scene.tool.substeps = 1;
  Simulation simulation = simulate(scene);
  Reaction reaction;
  for (int tick = 0; tick < 300; ++tick) reaction = simulation.advance(above(0.03, 0.004 - 1e-5 * tick));
  EXPECT_TRUE(reaction.touching);
  EXPECT_GT(reaction.force_n.y(), 0.0);
  EXPECT_LT(evaluate(simulation.surface(), 0.75, 0.03).position_m.y(), 0.0022);
}

TEST(Simulation, ForceGrowsWithTheStiffness) {
  Scene scene = small_handle();
  scene.bodies[0].material.plastic = false;
  double force[2];
  for (const int which : {0, 1}) {
    scene.bodies[0].material.youngs_modulus_pa = which == 0 ? 1e5 : 2e5;
    Simulation simulation = simulate(scene);
    EXPECT_GT(simulation.inertia_scale(), 1.0);
    Reaction reaction;
    for (int tick = 0; tick < 200; ++tick) reaction = simulation.advance(above(0.03, 0.0095 - 1e-5 * tick));
    force[which] = reaction.force_n.y();
  }
  EXPECT_GT(force[0], 0.0);
  EXPECT_NEAR(force[1] / force[0], 2.0, 1e-3);
}

TEST(Simulation, RestoreGivesBackTheShapeBitForBit) {
  Simulation simulation = simulate(small_handle());
  push(simulation, 0.03, 0.006, 200);
  const ShapeState before = simulation.shape();
  const ControlNet net = simulation.surface().net;
  push(simulation, 0.045, 0.005, 200);
  ASSERT_NE(simulation.shape(), before);
  ASSERT_TRUE(simulation.restore(before).ok());
  EXPECT_EQ(simulation.shape(), before);
  EXPECT_EQ(simulation.surface().net.y, net.y);
  EXPECT_FALSE(simulation.restore(ShapeState{{{1.0f}}}).ok());
}

TEST(Simulation, KeepShapeMakesThePresentTheRestShape) {
  Scene scene = small_handle();
  scene.bodies[0].material.plastic = false;
  Simulation simulation = simulate(scene);
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
  for (int tick = 0; tick < 600; ++tick) simulation.advance(above(0.05, 0.009 - 1e-5 * tick));
  const Surface bent = simulation.surface();
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(0.05, 0.05));
  EXPECT_LT(largest_move(simulation, bent, 0.0, 0.06), 1e-12);
}

TEST(Simulation, CommandsOutOfRangeChangeNothing) {
  Simulation simulation = simulate(small_handle());
  const std::uint64_t before = simulation.state_hash();
  Tool tool;
  tool.radius_m = std::nan("");
  EXPECT_FALSE(simulation.apply(SetTool{tool}).ok());
  Material material = simulation.scene().bodies[0].material;
  material.poissons_ratio = 0.5;
  EXPECT_FALSE(simulation.apply(SetMaterial{material}).ok());
  EXPECT_FALSE(simulation.apply(PlacePlane{{Vector3::Zero(), Vector3::Zero()}}).ok());
  EXPECT_EQ(simulation.state_hash(), before);
}

TEST(Simulation, RefusesBodiesThatAreNotClosedTubes) {
  Scene open = small_handle();
  for (int i = 0; i < open.bodies[0].surface.net.rows; ++i)
    open.bodies[0].surface.net.set_point(i, 0, {0.0, 1e-3 * i, 0.0});
  const Error without_pole = Simulation::make(open, InstructionSet::baseline).error();
  EXPECT_EQ(without_pole.code, ErrorCode::inconsistent);
  EXPECT_NE(without_pole.message.find("pole"), std::string::npos) << without_pole.message;
  Scene inward = small_handle();
  for (double& z : inward.bodies[0].surface.net.z) z = -z;
  const Error inside_out = Simulation::make(inward, InstructionSet::baseline).error();
  EXPECT_EQ(inside_out.code, ErrorCode::inconsistent);
  EXPECT_NE(inside_out.message.find("inward"), std::string::npos) << inside_out.message;
}

TEST(Simulation, OneHashForEveryInstructionSet) {
  std::uint64_t hash = 0;
  for (const InstructionSet set : available_instruction_sets()) {
    Simulation simulation = simulate(small_handle(), set);
    ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
    push(simulation, 0.05, 0.002, 300);
    if (hash == 0) hash = simulation.state_hash();
    EXPECT_EQ(simulation.state_hash(), hash) << name_of(set);
  }
}

TEST(Simulation, StepRewindStepAgainGivesTheSameHash) {
  Simulation a = simulate(small_handle()), b = simulate(small_handle());
  push(a, 0.05, 0.002, 150);
  push(b, 0.05, 0.002, 150);
  EXPECT_EQ(a.state_hash(), b.state_hash());
  b.advance(above(0.05, 0.00200001));
  a.advance(above(0.05, 0.002));
  EXPECT_NE(a.state_hash(), b.state_hash());
}

// A tool that moves randomly about the handle at up to 5 m/s.
struct RandomStroke {
  Random& random;
  Vector3 at{0.05, 0.02, 0.0}, to{0.05, 0.02, 0.0};

  void step(int tick) {
    if (tick % 20 == 0)
      to = Vector3(random.uniform(0.0, 0.07), random.uniform(-0.03, 0.03), random.uniform(-0.02, 0.02));
    const Vector3 way = to - at;
    at += way.norm() > 5e-3 ? Vector3(way * (5e-3 / way.norm())) : way;
  }
};

// With random materials, tools and strokes at up to 5 m/s, all values stay finite and all nodes stay near
// their initial positions.
TEST(Simulation, NoSettingBlowsItUp) {
  const int trials = random_cases(is_full_run() ? 12 : 5, 100);
  Random random(77);
  for (int trial = 0; trial < trials; ++trial) {
    Scene scene = small_handle();
    Material& material = scene.bodies[0].material;
    material.youngs_modulus_pa = std::pow(10.0, random.uniform(0.5, 11.5));
    material.friction = random.uniform(0.0, 1.0);
    material.density_kg_per_m3 = std::pow(10.0, random.uniform(1.0, 4.0));
    material.damping_time_s = random.uniform(damping_time_range_s.low, damping_time_range_s.high);
    material.plastic = random.integer(0, 1) == 1;
    material.yield_strain = std::pow(10.0, random.uniform(-4.0, -0.5));
    material.flow_rate_per_s = random.uniform(0.0, flow_rate_range_per_s.high);
    material.hardening = random.uniform(0.0, 1.0);
    material.stiffening = random.integer(0, 1) == 0 ? 0.0 : random.uniform(-1000.0, 1000.0);
    material.relaxing_fraction = material.plastic ? 0.0 : random.uniform(0.0, 1.0);
    material.relaxation_time_s = std::pow(10.0, random.uniform(-1.0, 3.0));
    material.poissons_ratio = random.uniform(is_linear_elastic(material) ? 0.0 : 0.2, 0.49);
    scene.sculpting.drag_per_s = random.integer(0, 1) == 0 ? 0.0 : random.uniform(0.0, drag_range_per_s.high);
    // Gravity is limited to what the material can bear: a body of a few Pa stretches without end under full
    // gravity.
    const double carried = 0.1 * material.youngs_modulus_pa / (material.density_kg_per_m3 * 0.06);
    scene.sculpting.gravity_m_per_s2 = {0.0, -std::min(20.0, random.uniform(0.0, 1.0) * carried), 0.0};
    scene.tool.kind = random.integer(0, 3) == 0 ? ToolKind::point : ToolKind::sphere;
    scene.tool.action = static_cast<ToolAction>(random.integer(0, static_cast<int>(tool_actions.size()) - 1));
    scene.tool.radius_m = random.uniform(0.0, 0.03);
    scene.tool.substeps = random.integer(1, 8);
    scene.planes.push_back({Vector3(0.015, 0, 0), Vector3::UnitX()});
    Simulation simulation = simulate(scene);
    const double coupling = random.integer(0, 1) == 0 ? 0.0 : std::pow(10.0, random.uniform(-3.0, 4.0));
    RandomStroke stroke{random};
    for (int tick = 0; tick < 400; ++tick) {
      stroke.step(tick);
      const Reaction reaction =
          simulation.advance({{stroke.at, Quaternion::Identity()}, random.integer(0, 9) > 0, coupling});
      ASSERT_TRUE(reaction.force_n.allFinite()) << "trial " << trial << " tick " << tick;
    }
    for (int n = 0; n < simulation.lattice().mesh().node_count(); ++n) {
      const Vector3 d = simulation.lattice().displacement(n);
      ASSERT_TRUE(d.allFinite()) << "trial " << trial;
      ASSERT_LT(d.norm(), 0.2) << "trial " << trial;
    }
  }
}

// This worst case is rare among random settings: no damping, and a rigid oversized sphere hits a gel
// at 5 m/s.
TEST(Simulation, AnUndampedGelStaysNearWhateverHitsIt) {
  const int trials = random_cases(8, 40);
  Random random(9);
  for (int trial = 0; trial < trials; ++trial) {
    Scene scene = small_handle();
    Material& material = scene.bodies[0].material;
    material.youngs_modulus_pa = std::pow(10.0, random.uniform(0.0, 3.5));
    material.poissons_ratio = random.uniform(0.25, 0.35);
    material.density_kg_per_m3 = std::pow(10.0, random.uniform(1.0, 4.0));
    material.damping_time_s = 0.0;
    material.plastic = random.integer(0, 1) == 1;
    scene.sculpting.drag_per_s = 0.0;
    scene.tool.action = random.integer(0, 1) == 0 ? ToolAction::push : ToolAction::pull;
    scene.tool.radius_m = random.uniform(0.01, 0.03);
    scene.tool.substeps = random.integer(1, 8);
    scene.planes.push_back({Vector3(0.015, 0, 0), Vector3::UnitX()});
    Simulation simulation = simulate(scene);
    RandomStroke stroke{random};
    for (int tick = 0; tick < 400; ++tick) {
      stroke.step(tick);
      simulation.advance({{stroke.at, Quaternion::Identity()}, true, 0.0});
    }
    for (int n = 0; n < simulation.lattice().mesh().node_count(); ++n)
      ASSERT_LT(simulation.lattice().displacement(n).norm(), 0.2) << "trial " << trial;
  }
}

TEST(Simulation, AdvanceAllocatesNothing) {
  Simulation simulation = simulate(small_handle());
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
  simulation.advance(above(0.05, 0.02));
  const std::size_t before = allocation_count();
  push(simulation, 0.05, 0.002, 200);
  push(simulation, 0.05, 0.002, 200, true);
  EXPECT_EQ(allocation_count(), before);

  Tool smoothing = simulation.scene().tool;
  smoothing.action = ToolAction::smooth;
  ASSERT_TRUE(simulation.apply(SetTool{smoothing}).ok());
  const std::size_t then = allocation_count();
  push(simulation, 0.05, 0.002, 200);
  EXPECT_EQ(allocation_count(), then);
}

}  // namespace
}  // namespace spoonbill
