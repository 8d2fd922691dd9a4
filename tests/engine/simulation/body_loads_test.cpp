// Tests loads on the lattice of a body against closed forms and the static solver.
#include "engine/simulation/body_loads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/material/statics/static_solver.h"
#include "tests/engine/material/block.h"
#include "tests/engine/refusal.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/loaded_block.h"

namespace spoonbill {
namespace {

Material rubber(double youngs_modulus_pa, double poissons_ratio) {
  Material material = elastic_material(youngs_modulus_pa, poissons_ratio, 1000.0);
  material.damping_time_s = 1e-4;
  return material;
}

Support still(const BodyRegion& region) {
  return {region, {}};
}

// The strain of a volume under uniform pressure is 3 (1 - 2 nu) p / E. The tolerance of 5e-3 covers the
// nonlinearity at this strain and the accuracy of the springs.
TEST(BodyLoads, PressureAllAroundShrinksABodyAsItsBulkModulusSays) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    const double youngs = stepping == Stepping::springs ? 2e4 : 5e6, poisson = 0.35, share = 1e-3;
    LoadedBlock body({0.02, 0.02, 0.03}, {5, 5, 7}, rubber(youngs, poisson), stepping);
    body.load({PressureLoad{{}, share * youngs}});
    for (int tick = 0; tick < 600; ++tick) body.tick(60.0);
    const double change = body.lattice.volume_m3() / body.lattice.rest_volume_m3() - 1.0;
    EXPECT_NEAR(change / (-3.0 * (1.0 - 2.0 * poisson) * share), 1.0, 5e-3);
    Vector3 moved = Vector3::Zero();
    for (int n = 0; n < body.lattice.mesh().node_count(); ++n) {
      moved += body.lattice.displacement(n) / body.lattice.mesh().node_count();
    }
    // The pressure on a closed surface sums to zero, in single precision, so that the block stays.
    EXPECT_LT(moved.norm(), 1e-7);
  }
}

// Between slices 4 and 14 of 18, the fixed end has no influence: the strain is F / (E A).
TEST(BodyLoads, AForceOnTheEndStretchesABar) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    const double youngs = stepping == Stepping::springs ? 2e4 : 5e6, area = 0.01 * 0.01, share = 2e-3;
    LoadedBlock bar({0.01, 0.01, 0.06}, {4, 4, 19}, rubber(youngs, 0.3), stepping);
    bar.load({ForceLoad{block_end, Vector3(0, 0, share * youngs * area)}});
    bar.support({still(block_start)});
    for (int tick = 0; tick < 1500; ++tick) bar.tick(100.0);
    const double strain = (bar.slice_m(14) - bar.slice_m(4)).z() / (0.06 * 10.0 / 18.0);
    EXPECT_NEAR(strain / share, 1.0, 5e-3);
    EXPECT_NEAR(bar.support_force_n(0).z() / (-share * youngs * area), 1.0, 2e-3);
  }
}

// A force distributed by volume acts like a weight: both give the same rest shape.
TEST(BodyLoads, AForceSharedByVolumeIsAWeight) {
  LoadedBlock loaded({0.01, 0.01, 0.04}, {4, 4, 13}, rubber(2e4, 0.3), Stepping::springs);
  LoadedBlock hanging({0.01, 0.01, 0.04}, {4, 4, 13}, rubber(2e4, 0.3), Stepping::springs);
  loaded.support({still(block_start)});
  hanging.support({still(block_start)});
  const Vector3 gravity_m_per_s2(0, 0, 3.0);
  loaded.load({ForceLoad{{}, loaded.lattice.mass_kg() * gravity_m_per_s2, ForceDistribution::volume}});
  for (int tick = 0; tick < 800; ++tick) {
    loaded.tick(60.0);
    hanging.tick(60.0, gravity_m_per_s2);
  }
  EXPECT_GT(loaded.slice_m(12).z(), 1e-5);
  // The tolerance covers sums of displacements in single precision.
  EXPECT_NEAR(loaded.slice_m(12).z() / hanging.slice_m(12).z(), 1.0, 1e-4);
}

// A load on the whole body includes its part on the fixed nodes.
TEST(BodyLoads, ASupportBearsWhatIsPutOnItsOwnNodes) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    const double youngs = stepping == Stepping::springs ? 2e4 : 5e6, force_n = 1e-8 * youngs;
    LoadedBlock bar({0.01, 0.01, 0.04}, {4, 4, 13}, rubber(youngs, 0.3), stepping);
    bar.support({still({{0.0, 0.25}})});
    bar.load({ForceLoad{{}, Vector3(0, 0, force_n), ForceDistribution::volume}});
    for (int tick = 0; tick < 800; ++tick) bar.tick(60.0);
    // The tolerance covers the remaining motion.
    EXPECT_NEAR(bar.support_force_n(0).z() / -force_n, 1.0, 2e-3);
  }
}

StaticResult at_rest(const LatticeMesh& mesh, const Material& material, CellKind kind,
                     const std::vector<Load>& list, const Vector3& gravity_m_per_s2) {
  const BodyLoads made = BodyLoads::make(list, mesh, [](double, double) { return EmbeddedPoint(); }).value();
  std::vector<FixedAxis> held;
  for (int n = 0; n < mesh.count[0] * mesh.count[1]; ++n) fix_node(n, Vector3::Zero(), held);
  return rest_under_load(StaticBody::make(mesh, material, kind).value(),
                         {gravity_m_per_s2, made.forces(), made.pressures()}, held)
      .value();
}

// The dynamic solvers come to rest at the static solution within 1 %, under weight, a pressure on one side
// and a force on the end at once.
TEST(BodyLoads, ACantileverSettlesToItsStaticRest) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    const bool springs = stepping == Stepping::springs;
    const Material material = rubber(springs ? 2e4 : 2e6, 0.3);
    LoadedBlock beam({0.012, 0.012, 0.048}, springs ? std::array{5, 5, 17} : std::array{4, 4, 13}, material,
                     stepping);
    const double unit = material.youngs_modulus_pa * 1e-8;
    const std::vector<Load> list = {ForceLoad{block_end, Vector3(5 * unit, unit, 0)},
                                    PressureLoad{{{0.5, 1.0}}, 1e4 * unit}};
    beam.load(list);
    beam.support({still(block_start)});
    const Vector3 gravity_m_per_s2(springs ? 1.0 : 100.0, 0, 0);
    for (int tick = 0; tick < 3000; ++tick) beam.tick(30.0, gravity_m_per_s2);
    const LatticeMesh& mesh = springs ? beam.lattice.mesh() : beam.core->mesh();
    const StaticResult rest =
        at_rest(mesh, material, springs ? CellKind::springs : CellKind::hexahedra, list, gravity_m_per_s2);
    Vector3 tip = Vector3::Zero();
    const int slice = mesh.count[0] * mesh.count[1];
    for (int n = mesh.node_count() - slice; n < mesh.node_count(); ++n) {
      tip += rest.displacement_m[static_cast<std::size_t>(n)] / slice;
    }
    const Vector3 settled = beam.slice_m(beam.lattice.mesh().count[2] - 1);
    EXPECT_GT(tip.norm(), 2e-4);
    EXPECT_LT((settled - tip).norm(), 0.01 * tip.norm()) << settled.transpose() << " and " << tip.transpose();
  }
}

TEST(BodyLoads, RefuseARegionWithoutNodes) {
  const LatticeMesh mesh = box_mesh({0.01, 0.01, 0.04}, {4, 4, 13});
  const auto none = [](double, double) { return EmbeddedPoint(); };
  const auto refused = [&](const Load& load) {
    const std::vector<Load> loads(2, load);
    const auto made = BodyLoads::make(loads, mesh, none);
    return made.ok() ? Error(ErrorCode::internal, "") : made.error();
  };
  const Error no_face = refused(PressureLoad{{{0.50, 0.51}}, 10.0});
  EXPECT_EQ(no_face.code, ErrorCode::too_few);
  EXPECT_EQ(no_face.field, "region");
  EXPECT_EQ(no_face.message.substr(0, 10), "loads[0]: ");
  const Error no_node = refused(ForceLoad{{{0.51, 0.52}}, Vector3::Zero(), ForceDistribution::volume});
  EXPECT_EQ(no_node.code, ErrorCode::too_few);
  EXPECT_EQ(no_node.field, "region");
  EXPECT_EQ(no_node.message.substr(0, 10), "loads[0]: ");
  EXPECT_EQ(Refusal(refused(PressureLoad{{{0.5, 1.0}}, std::nan("")})),
            Refusal(ErrorCode::out_of_range, "pressure_pa"));
  EXPECT_EQ(Refusal(refused(PressureLoad{{{0.5, 1.5}}, 1.0})), Refusal(ErrorCode::out_of_range, "along"));
}

TEST(BodyLoads, RefuseAPointBesideTheSurface) {
  const auto refused = [](double u, double v) {
    Scene scene = small_handle();
    scene.bodies[0].loads = {PressureLoad{{}, 1.0}, PointLoad{u, v, Vector3(0, 1, 0)}};
    const auto made = Simulation::make(scene, InstructionSet::baseline);
    return Refusal(made);
  };
  EXPECT_EQ(refused(0.5, 0.03), Refusal());
  EXPECT_EQ(refused(0.5, 0.07), Refusal(ErrorCode::out_of_range, "v"));
  EXPECT_EQ(refused(0.5, 0.07).message, "loads[1]: v is 0.07, must be from 0 to 0.06");
  EXPECT_EQ(refused(std::nan(""), 0.03), Refusal(ErrorCode::out_of_range, "u"));
}

}  // namespace
}  // namespace spoonbill
