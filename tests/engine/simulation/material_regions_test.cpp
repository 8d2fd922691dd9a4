// Tests bodies with regions of different material or friction.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"
#include "tests/engine/refusal.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

Material elastic(const char* name, double youngs_modulus_pa, double friction = 0.0) {
  Material material;
  material.name = name;
  material.source = "test";
  material.youngs_modulus_pa = youngs_modulus_pa;
  material.poissons_ratio = 0.4;
  material.density_kg_per_m3 = 1100.0;
  material.damping_time_s = 2.2e-5;
  material.friction = friction;
  return material;
}

MaterialRegion far_half_of(const Material& material) {
  MaterialRegion region;
  region.region.along = {0.5, 1.0};
  region.material = material;
  return region;
}

// Returns a scene with a handle that is fixed at both ends.
Scene handle_with_regions(const Material& own, const std::vector<MaterialRegion>& regions) {
  Scene scene = small_handle();
  scene.bodies[0].material = own;
  scene.bodies[0].regions = regions;
  scene.planes.push_back({Vector3(0.006, 0, 0), Vector3::UnitX()});
  scene.planes.push_back({Vector3(0.054, 0, 0), -Vector3::UnitX()});
  scene.tool.substeps = 1;
  scene.sculpting.drag_per_s = 40.0;
  return scene;
}

TEST(MaterialRegions, WhatStepsABodyIsChosenByAllOfThem) {
  const auto implicit_nodes = [](const Material& own, const Material& other) {
    Simulation simulation = simulate(handle_with_regions(own, {far_half_of(other)}));
    Snapshot snapshot;
    simulation.write_snapshot(snapshot);
    return snapshot.bodies[0].material.implicit_nodes;
  };
  Material clay = small_handle().bodies[0].material;
  EXPECT_EQ(implicit_nodes(elastic("gel", 1e4), elastic("rubber", 1e5)), 0);
  EXPECT_GT(implicit_nodes(elastic("gel", 1e4), elastic("wood", 1e9)), 0);
  EXPECT_EQ(implicit_nodes(clay, elastic("wood", 1e9)), 0);
}

// All nodes of a lattice share one inertia scale, with which even the stiffest material is stable in a
// substep.
TEST(MaterialRegions, ShareTheInertiaScaleOfTheStiffestOne) {
  const Material clay = small_handle().bodies[0].material;
  const Material wood = elastic("wood", 100.0 * clay.youngs_modulus_pa);
  Simulation simulation = simulate(handle_with_regions(clay, {far_half_of(wood)}));
  Snapshot snapshot;
  for (int tick = 0; tick < 20; ++tick) simulation.advance(above(0.03, 0.02));
  simulation.write_snapshot(snapshot);
  EXPECT_EQ(snapshot.substeps, 1);
  EXPECT_EQ(snapshot.flags & tick_flag_nodes_slowed, 0u);
  // The scale is about that of a body of wood alone. Cells at the join to the heavier and softer clay change
  // it.
  SpringLattice alone =
      SpringLattice::make(simulation.lattice().mesh(), wood, InstructionSet::baseline).value();
  EXPECT_NEAR(alone.find_inertia_scale(tick_s) / simulation.inertia_scale(), 1.0, 0.35);
}

TEST(MaterialRegions, TheSofterHalfIsDentedDeeper) {
  const auto dent_m = [](double x_m, const Material& near, const Material& far) {
    Simulation simulation = simulate(handle_with_regions(near, {far_half_of(far)}));
    Reaction reaction;
    for (int tick = 0; tick < 400; ++tick) {
      ToolInput input = above(x_m, 0.0085 - 2e-3 * std::min(1.0, tick / 200.0));
      input.coupling_n_per_m = 300.0;
      reaction = simulation.advance(input);
    }
    EXPECT_TRUE(reaction.touching);
    return 0.0085 - reaction.proxy.position_m.y();
  };
  const Material soft = elastic("soft", 5e4), hard = elastic("hard", 5e5);
  EXPECT_GT(dent_m(0.018, soft, hard), 1.3 * dent_m(0.042, soft, hard));
  EXPECT_GT(dent_m(0.042, hard, soft), 1.3 * dent_m(0.018, hard, soft));
}

// Returns the parameter v on the handle's top at which the deformed surface is at x.
double top_at(const Simulation& simulation, double x_m) {
  double low = 0.0, high = 0.06;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (evaluate(simulation.surface(), 11.0 / 12.0, middle).position_m.x() < x_m ? low : high) = middle;
  }
  return low;
}

// Returns how far the tool slips over the surface point below it when the hand moves by half a millimetre
// along x.
double slip_m(Simulation& simulation, double x_m) {
  const auto press = [&](double moved_m, int ticks) {
    Reaction reaction;
    for (int tick = 0; tick < ticks; ++tick) {
      ToolInput input = above(x_m + moved_m * (tick + 1) / ticks, 0.0075);
      input.coupling_n_per_m = 700.0;
      reaction = simulation.advance(input);
    }
    EXPECT_TRUE(reaction.touching);
    return reaction.proxy.position_m.x();
  };
  for (int tick = 0; tick < 100; ++tick) {
    ToolInput input = above(x_m, 0.0095 - 2e-5 * tick);
    input.coupling_n_per_m = 700.0;
    simulation.advance(input);
  }
  const double tool = press(0.0, 200), below = top_at(simulation, tool);
  const auto place = [&] { return evaluate(simulation.surface(), 11.0 / 12.0, below).position_m.x(); };
  const double surface = place();
  return (press(0.5e-3, 300) - tool) - (place() - surface);
}

TEST(MaterialRegions, AToolSticksToOneHalfAndSlidesOnTheOther) {
  MaterialRegion rough;
  rough.region.along = {0.5, 1.0};
  rough.friction = 3.0;
  const Scene scene = handle_with_regions(elastic("rubber", 1e5, 0.02), {rough});
  Simulation smooth_side = simulate(scene), rough_side = simulate(scene);
  const double slid = slip_m(smooth_side, 0.02), stuck = slip_m(rough_side, 0.04);
  EXPECT_GT(slid, 0.4e-3);
  // The bound is a tenth of the tool's movement rather than 0, because the skin deforms between the fixed
  // nodes.
  EXPECT_LT(stuck, 0.05e-3);
}

// Coulomb friction: the drag on a moving tool is the friction coefficient of the region times the push.
TEST(MaterialRegions, ADraggedToolFeelsTheFrictionOfTheRegion) {
  MaterialRegion rough;
  rough.region.along = {0.5, 1.0};
  rough.friction = 0.5;
  Simulation simulation = simulate(handle_with_regions(elastic("rubber", 1e5, 0.1), {rough}));
  for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.015, 0.0095 - 1e-5 * tick));
  // Averaging a movement back and forth over the same points cancels the effect of the surface's inclination.
  double drag[2] = {}, push[2] = {};
  constexpr int way = 1500;
  for (int tick = 0; tick < 2 * way; ++tick) {
    const bool back = tick >= way;
    const double x = 0.015 + 2e-5 * (back ? 2 * way - tick : tick);
    const Reaction reaction = simulation.advance(above(x, 0.0075));
    const bool on_smooth = x > 0.018 && x < 0.026;
    const bool on_rough = x > 0.034 && x < 0.042;
    if (!on_smooth && !on_rough) continue;
    drag[on_rough] += (back ? 1.0 : -1.0) * reaction.force_n.x();
    push[on_rough] += reaction.force_n.y();
  }
  EXPECT_NEAR(drag[0] / push[0], 0.1, 0.03);
  EXPECT_NEAR(drag[1] / push[1], 0.5, 0.05);
}

TEST(MaterialRegions, ANewMaterialIsOfTheRestOfTheBody) {
  Simulation simulation =
      simulate(handle_with_regions(elastic("gel", 1e4), {far_half_of(elastic("rubber", 1e5))}));
  ASSERT_TRUE(simulation.apply(SetMaterial{elastic("other", 3e4, 0.7)}).ok());
  const LatticeMaterials& materials = simulation.lattice().materials();
  ASSERT_EQ(materials.materials.size(), 2u);
  EXPECT_EQ(materials.materials[0].name, "other");
  EXPECT_EQ(materials.materials[1].name, "rubber");
  EXPECT_EQ(simulation.scene().bodies[0].regions.size(), 1u);
  Material cork = elastic("cork", 1e4);
  cork.poissons_ratio = 0.0;
  Simulation clay =
      simulate(handle_with_regions(small_handle().bodies[0].material, {far_half_of(elastic("gel", 1e4))}));
  EXPECT_FALSE(clay.apply(SetMaterial{[&] {
                     Material plastic_cork = cork;
                     plastic_cork.plastic = true;
                     plastic_cork.yield_strain = 0.01;
                     return plastic_cork;
                   }()})
                   .ok());
  EXPECT_EQ(clay.lattice().materials().own().name, "clay");
}

// A body keeps its materials when its bent shape becomes its rest shape, because materials belong to cells.
TEST(MaterialRegions, StayWhereTheyAreWhenAShapeIsKept) {
  const Material clay = small_handle().bodies[0].material;
  Simulation simulation = simulate(handle_with_regions(clay, {far_half_of(elastic("rubber", 1e5))}));
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(0.02, 0.0095 - 1e-5 * tick));
  const std::vector<std::uint8_t> before = simulation.lattice().materials().material_index;
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  EXPECT_EQ(simulation.lattice().materials().material_index, before);
}

TEST(MaterialRegions, WrongOnesAreRefused) {
  Scene scene = handle_with_regions(elastic("gel", 1e4), {far_half_of(elastic("rubber", 1e5))});
  scene.bodies[0].regions[0].region.along = {0.9, 0.1};
  EXPECT_EQ(Refusal(Simulation::make(scene, InstructionSet::baseline)),
            Refusal(ErrorCode::inconsistent, "along"));
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[0].regions.clear();
  scene.bodies[1].name = "other";
  EXPECT_EQ(Simulation::make(scene, InstructionSet::baseline).error().message,
            "body \"other\": regions[0].along is [0.9, 0.1], must run from the lower to the higher");
}

// The reported elasticity is that of the cells with which the body is simulated: springs or hexahedra.
// Hexahedra achieve the requested values, because they pass the patch test in any shape.
TEST(MaterialRegions, WhatABodyAchievesIsReportedOfWhatStepsIt) {
  Simulation wood = simulate(handle_with_regions(elastic("gel", 1e4), {far_half_of(elastic("wood", 1e9))}));
  Simulation gel = simulate(handle_with_regions(elastic("gel", 1e4), {}));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(wood.report().youngs_modulus_ratio[axis], 1.0, 1e-9);
    EXPECT_NEAR(wood.report().poissons_ratio[axis], 0.4, 1e-9);
    EXPECT_NEAR(gel.report().youngs_modulus_ratio[axis], 1.0, 0.1);
    EXPECT_NE(gel.report().youngs_modulus_ratio[axis], 1.0);
  }
  EXPECT_NEAR(gel.report().wanted_poissons_ratio, 0.4, 1e-12);
}

Material random_material(Random& random, bool plainly_elastic) {
  Material material = elastic("random", std::pow(10.0, random.uniform(2.5, 10.0)), random.uniform(0.0, 2.0));
  material.density_kg_per_m3 = std::pow(10.0, random.uniform(2.5, 3.9));
  material.damping_time_s = random.uniform(damping_time_range_s.low, damping_time_range_s.high);
  material.poissons_ratio = random.uniform(plainly_elastic ? 0.0 : 0.2, 0.49);
  if (plainly_elastic) return material;
  material.plastic = random.integer(0, 1) == 1;
  material.yield_strain = std::pow(10.0, random.uniform(-3.0, -0.5));
  material.flow_rate_per_s = random.uniform(0.0, 3000.0);
  material.hardening = random.uniform(0.0, 1.0);
  material.stiffening = random.uniform(-50.0, 50.0);
  material.relaxing_fraction = material.plastic ? 0.0 : random.uniform(0.0, 1.0);
  return material;
}

// With random materials in random regions and strokes at up to 5 m/s, all values stay finite and all nodes
// stay near their initial positions.
TEST(MaterialRegions, NoStrokeBlowsThemUp) {
  const int trials = random_cases(is_full_run() ? 12 : 4, 100);
  Random random(31);
  for (int trial = 0; trial < trials; ++trial) {
    const bool plainly_elastic = random.integer(0, 2) == 0;
    MaterialRegion half = far_half_of(random_material(random, plainly_elastic)), skin;
    skin.region.depth_m = {0.0, 0.0012};
    // The region is wide enough to contain nodes of the surface, and sometimes crosses the seam.
    const double from = random.uniform(0.0, 1.0), to_share = from + random.uniform(0.3, 0.9);
    skin.region.around = {from, to_share - std::floor(to_share)};
    skin.friction = random.uniform(0.0, 2.0);
    Scene scene = handle_with_regions(random_material(random, plainly_elastic), {half, skin});
    scene.planes.pop_back();
    scene.tool.action = random.integer(0, 1) == 0 ? ToolAction::push : ToolAction::pull;
    scene.tool.substeps = random.integer(1, 8);
    Simulation simulation = simulate(scene);
    Vector3 at(0.05, 0.02, 0.0), to = at;
    for (int tick = 0; tick < 400; ++tick) {
      if (tick % 20 == 0) {
        to = Vector3(random.uniform(0.0, 0.07), random.uniform(-0.03, 0.03), random.uniform(-0.02, 0.02));
      }
      const Vector3 way = to - at;
      at += way.norm() > 5e-3 ? Vector3(way * (5e-3 / way.norm())) : way;
      const Reaction reaction = simulation.advance({{at, Quaternion::Identity()}, tick % 50 > 5, 0.0});
      ASSERT_TRUE(reaction.force_n.allFinite()) << "trial " << trial << " tick " << tick;
    }
    for (int n = 0; n < simulation.lattice().mesh().node_count(); ++n) {
      const Vector3 d = simulation.lattice().displacement(n);
      ASSERT_TRUE(d.allFinite()) << "trial " << trial;
      ASSERT_LT(d.norm(), 0.2) << "trial " << trial;
    }
  }
}

TEST(MaterialRegions, TicksAllocateNothing) {
  const Material clay = small_handle().bodies[0].material;
  for (const double youngs : {1e4, 1e9}) {
    for (const Material& own : {clay, elastic("rubber", 1e5)}) {
      Simulation simulation =
          simulate(handle_with_regions(own, {far_half_of(elastic("other", youngs, 0.5))}));
      simulation.advance(above(0.03, 0.02));
      const std::size_t before = allocation_count();
      for (int tick = 0; tick < 100; ++tick) simulation.advance(above(0.03, 0.0095 - 2e-5 * tick));
      EXPECT_EQ(allocation_count(), before);
    }
  }
}

TEST(MaterialRegions, EveryInstructionSetGivesTheSameBits) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Material clay = small_handle().bodies[0].material;
  MaterialRegion rough;
  rough.region.along = {0.3, 0.6};
  rough.friction = 0.8;
  for (const Material& other : {elastic("gel", 1e4), elastic("wood", 1e9)}) {
    for (const Material& own : {clay, elastic("rubber", 1e5)}) {
      const auto hash_of = [&](InstructionSet set) {
        Simulation simulation = simulate(handle_with_regions(own, {far_half_of(other), rough}), set);
        for (int tick = 0; tick < 100; ++tick) {
          simulation.advance(above(0.025 + 1e-4 * tick, 0.0085 - 2e-5 * tick));
        }
        return simulation.state_hash();
      };
      const std::uint64_t expected = hash_of(InstructionSet::baseline);
      for (const InstructionSet set : available_instruction_sets()) {
        EXPECT_EQ(hash_of(set), expected) << name_of(set);
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
