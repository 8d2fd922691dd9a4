// Tests moving spring lattices of two materials.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/base/processor.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice_solver.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/composite.h"

namespace spoonbill {
namespace {

SpringLattice make_composite_springs(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                     InstructionSet set = InstructionSet::baseline) {
  Result<SpringLattice> lattice = SpringLattice::make(mesh, materials, set);
  EXPECT_TRUE(lattice.ok()) << lattice.error().message;
  return std::move(lattice).value();
}

// Returns a bar along z with 4 x 4 x 24 cells of 3 mm.
const LatticeMesh& long_bar() {
  static const LatticeMesh mesh = box_mesh({0.012, 0.012, 0.072}, {5, 5, 25});
  return mesh;
}

bool in_far_half(const Vector3& at) {
  return at.z() > 0.036;
}
// Returns true for a point in the central four of the sixteen cells of a cross section.
bool in_middle(const Vector3& at) {
  return std::abs(at.x() - 0.006) < 0.003 && std::abs(at.y() - 0.006) < 0.003;
}

// Returns the mean of the z displacements in slice `k`.
double mean_displacement_m(const SpringLattice& lattice, int k) {
  double sum = 0.0;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) sum += lattice.displacement(lattice.mesh().index(i, j, k)).z() / 25.0;
  }
  return sum;
}

double strain_between(const SpringLattice& lattice, int from, int to) {
  const double apart_m = 0.003 * (to - from);
  return (mean_displacement_m(lattice, to) - mean_displacement_m(lattice, from)) / apart_m;
}

// Returns the bar at rest, fixed at z = 0 and pulled at the other end by a uniform stress.
SpringLattice drawn_bar(const LatticeMaterials& materials, double stress_pa) {
  SpringLattice lattice = make_composite_springs(long_bar(), materials);
  std::vector<std::uint8_t> held(static_cast<std::size_t>(long_bar().node_count()), 0);
  std::fill_n(held.begin(), 25, std::uint8_t{1});
  lattice.fix_nodes(held);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const double area = 9e-6 * (i % 4 == 0 ? 0.5 : 1.0) * (j % 4 == 0 ? 0.5 : 1.0);
      lattice.set_node_force(long_bar().index(i, j, 24), {0.0, 0.0, stress_pa * area});
    }
  }
  RelaxSettings settings;
  settings.time_s = lattice.stable_step_s(0.7);
  settings.drag_per_s = 60.0;
  for (; settings.tick < 1.2 / settings.time_s; ++settings.tick) {
    relax(std::array{RelaxedLattice{&lattice}}, settings, {});
  }
  return lattice;
}

// Away from the ends and from the interface between the halves, the strain of each half is the stress divided
// by its own modulus.
TEST(CompositeSprings, InSeriesEachHalfStretchesByItsOwnModulus) {
  const SpringLattice lattice = drawn_bar(composite(long_bar(), elastic_material(4e3, 0.3, 1000.0),
                                                    elastic_material(1.2e4, 0.4, 1000.0), in_far_half),
                                          20.0);
  // The bound allows for second-order terms of the springs at strains of 5e-3.
  EXPECT_NEAR(strain_between(lattice, 4, 9) / (20.0 / 4e3), 1.0, 0.01);
  EXPECT_NEAR(strain_between(lattice, 15, 21) / (20.0 / 1.2e4), 1.0, 0.01);
}

// The fastest mode of a damped body can be in another region than that of the undamped body. The inertia
// scale must agree with the mode that 1000 ticks at rest have tracked.
TEST(CompositeSprings, InertiaScaleIsThatOfTheFastestRegion) {
  constexpr double step_s = 1e-3;
  for (const double modulus_pa : {5e5, 1e6, 1.5e6, 2e6, 3e6, 5e6}) {
    Material first = elastic_material(1e6, 0.49, 1000.0), second = elastic_material(modulus_pa, 0.25, 1000.0);
    first.damping_time_s = second.damping_time_s = damping_time_range_s.high;
    SpringLattice lattice =
        make_composite_springs(long_bar(), composite(long_bar(), first, second, in_far_half));
    lattice.set_inertia(lattice.find_inertia_scale(step_s), step_s);
    RelaxSettings settings;
    for (; settings.tick < 1000; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    EXPECT_NEAR(lattice.stable_step_s(rest_stability_fraction) / step_s, 1.0, 0.03) << modulus_pa;
  }
}

// A bar in which a quarter of the section is ten times as stiff, with the same Poisson's ratio everywhere,
// has the mean modulus weighted by area.
TEST(CompositeSprings, InParallelABarStretchesAsVoigtSays) {
  const SpringLattice lattice = drawn_bar(composite(long_bar(), elastic_material(3e3, 0.35, 1000.0),
                                                    elastic_material(3e4, 0.35, 1000.0), in_middle),
                                          20.0);
  const double expected = 20.0 / (0.75 * 3e3 + 0.25 * 3e4);
  EXPECT_NEAR(strain_between(lattice, 9, 15) / expected, 1.0, 0.01);
}

void shake(SpringLattice& lattice, double speed_m_per_s, unsigned seed) {
  Random random(seed);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    lattice.set_velocity(
        n, speed_m_per_s * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
  }
}

// Returns two materials that differ in every property in which materials may differ.
LatticeMaterials all_different(const LatticeMesh& mesh) {
  Material clay = elastic_material(4e3, 0.4, 1500.0), gel = elastic_material(2e3, 0.22, 1000.0);
  clay.plastic = true;
  clay.yield_strain = 0.005;
  clay.flow_rate_per_s = 50.0;
  clay.hardening = 0.1;
  clay.damping_time_s = 5e-5;
  clay.stiffening = 2.0;
  gel.damping_time_s = 4e-4;
  gel.relaxing_fraction = 0.5;
  gel.relaxation_time_s = 0.2;
  gel.stiffening = -3.0;
  return composite(mesh, clay, gel, [&](const Vector3& at) { return at.z() > 0.5 * mesh.nodes.back().z(); });
}

const LatticeMesh& small_block() {
  static const LatticeMesh mesh = box_mesh({0.009, 0.009, 0.015}, {4, 4, 6});
  return mesh;
}

TEST(CompositeSprings, KeepTheirMomentum) {
  const DenormalsFlushed flushed;
  SpringLattice lattice = make_composite_springs(small_block(), all_different(small_block()));
  EXPECT_TRUE(lattice.is_damped_further());
  shake(lattice, 0.05, 5);
  const Momentum before = momentum_of(lattice);
  RelaxSettings settings;
  for (; settings.tick < 2000; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
  const Momentum after = momentum_of(lattice);
  EXPECT_LT((after.sum - before.sum).norm(), 1e-5 * before.size);
  EXPECT_LT(after.energy_j, 0.7 * before.energy_j);
}

// damp_further() exerts no force on a body that moves and turns as a whole.
TEST(CompositeSprings, RigidMotionsAreNotDampedFurther) {
  SpringLattice lattice = make_composite_springs(small_block(), all_different(small_block()));
  const Vector3 velocity(0.3, -0.2, 0.1), spin(2.0, 1.0, -3.0);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    lattice.set_velocity(n, velocity + spin.cross(lattice.position(n)));
  }
  const LatticeView view = lattice.view();
  lattice.kernels().linearise_springs(view, 0.0f, Linearised::tangents);
  const auto largest_force = [&] {
    double largest = 0.0;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      largest = std::max(largest, Vector3(view.fx[n], view.fy[n], view.fz[n]).norm());
    }
    return largest;
  };
  std::fill_n(view.fx, view.padded_count, 0.0f);
  std::fill_n(view.fy, view.padded_count, 0.0f);
  std::fill_n(view.fz, view.padded_count, 0.0f);
  lattice.kernels().damp_further(view);
  const double rigid = largest_force();
  // Random speeds that change the shape, about as large as those of the rigid motion above.
  shake(lattice, 0.3, 1);
  std::fill_n(view.fx, view.padded_count, 0.0f);
  std::fill_n(view.fy, view.padded_count, 0.0f);
  std::fill_n(view.fz, view.padded_count, 0.0f);
  lattice.kernels().damp_further(view);
  EXPECT_GT(largest_force(), 0.0);
  EXPECT_LT(rigid, 1e-5 * largest_force());  // the bound allows for rounding of single precision
}

// A material in a composite is damped as in a lattice of that material alone: each half of a bar rings down
// at its own rate.
TEST(CompositeSprings, EachMaterialIsDampedByItsOwnTime) {
  // The bar's halves hardly affect each other at first, so each rings by itself.
  const auto energy_left = [&](double first_time_s, double second_time_s, bool of_second) {
    Material first = elastic_material(4e3, 0.3, 1000.0), second = elastic_material(4e3, 0.3, 1000.0);
    first.damping_time_s = first_time_s;
    second.damping_time_s = second_time_s;
    SpringLattice lattice =
        make_composite_springs(long_bar(), composite(long_bar(), first, second, in_far_half));
    Random random(9);
    for (int n = 0; n < long_bar().node_count(); ++n) {
      const double z = long_bar().nodes[static_cast<std::size_t>(n)].z();
      const bool in_half = of_second ? z > 0.048 : z < 0.024;
      const Vector3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (in_half) lattice.set_velocity(n, 1e-3 * v);
    }
    const double before = momentum_of(lattice).energy_j;
    RelaxSettings settings;
    settings.time_s = 2e-4;
    for (; settings.tick < 20; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    return momentum_of(lattice).energy_j / before;
  };
  for (const bool of_second : {false, true}) {
    const double little = energy_left(2e-5, 2e-5, of_second), much = energy_left(3e-4, 3e-4, of_second);
    EXPECT_LT(much, 0.7 * little);
    const double mixed = energy_left(2e-5, 3e-4, of_second);
    // At the time of measurement, waves have not crossed the few cells between the moving nodes and the other
    // half.
    EXPECT_NEAR(mixed / (of_second ? much : little), 1.0, 0.05);
  }
}

// When the bar is stretched beyond its yield strain and released, the clay half stays longer and the elastic
// half does not.
TEST(CompositeSprings, OnlyThePlasticHalfKeepsItsLength) {
  Material clay = elastic_material(4e3, 0.4, 1000.0), rubber = elastic_material(4e3, 0.4, 1000.0);
  clay.plastic = true;
  clay.yield_strain = 0.005;
  clay.flow_rate_per_s = 50.0;
  clay.damping_time_s = rubber.damping_time_s = 1e-4;
  SpringLattice lattice =
      make_composite_springs(long_bar(), composite(long_bar(), clay, rubber, in_far_half));
  std::vector<std::uint8_t> held(static_cast<std::size_t>(long_bar().node_count()), 0);
  std::fill_n(held.begin(), 25, std::uint8_t{1});
  std::fill_n(held.end() - 25, 25, std::uint8_t{1});
  lattice.fix_nodes(held);
  for (int n = 0; n < long_bar().node_count(); ++n) {
    const Vector3& at = long_bar().nodes[static_cast<std::size_t>(n)];
    lattice.set_displacement(n, {0.0, 0.0, 0.05 * at.z()});
  }
  RelaxSettings settings;
  settings.drag_per_s = 60.0;
  const auto run = [&](std::uint64_t ticks) {
    for (std::uint64_t t = 0; t < ticks; ++t, ++settings.tick) {
      relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    }
  };
  run(500);
  std::fill(held.end() - 25, held.end(), std::uint8_t{0});
  lattice.fix_nodes(held);
  run(1500);
  EXPECT_GT(strain_between(lattice, 3, 9), 0.03);
  EXPECT_NEAR(strain_between(lattice, 15, 21), 0.0, 2e-3);
}

// A bar of two materials is held stretched, and its gel half creeps. In the end, the gel has lost half of its
// shear stress and none of its pressure. With K = E / 1.2 and half the shear modulus, G = E / 5.2, Young's
// modulus of the gel is then 9 K G / (3 K + G) = 0.536 E.
TEST(CompositeSprings, OnlyTheGelCreeps) {
  Material gel = elastic_material(4e3, 0.3, 1000.0), rubber = elastic_material(4e3, 0.3, 1000.0);
  gel.relaxing_fraction = 0.5;
  gel.relaxation_time_s = 0.2;
  gel.damping_time_s = rubber.damping_time_s = 1e-4;
  SpringLattice lattice = make_composite_springs(long_bar(), composite(long_bar(), gel, rubber, in_far_half));
  std::vector<std::uint8_t> held(static_cast<std::size_t>(long_bar().node_count()), 0);
  std::fill_n(held.begin(), 25, std::uint8_t{1});
  std::fill_n(held.end() - 25, 25, std::uint8_t{1});
  lattice.fix_nodes(held);
  for (int n = 0; n < long_bar().node_count(); ++n) {
    lattice.set_displacement(n, {0.0, 0.0, 0.02 * long_bar().nodes[static_cast<std::size_t>(n)].z()});
  }
  RelaxSettings settings;
  settings.drag_per_s = 60.0;
  for (; settings.tick < 4000; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
  const double of_gel = strain_between(lattice, 3, 9), of_rubber = strain_between(lattice, 15, 21);
  EXPECT_NEAR(of_gel / of_rubber, 1.0 / 0.536, 0.05);
}

// A tick chooses enough substeps to be stable for any two damping times. With the longest damping time,
// stability also requires the increased inertia of strained nodes.
TEST(CompositeSprings, StayStableHoweverTheyAreDamped) {
  const DenormalsFlushed flushed;
  for (const double first_time_s : {0.0, 1e-4, damping_time_range_s.high}) {
    for (const double second_time_s : {0.0, 1e-4, damping_time_range_s.high}) {
      for (const double softer : {1.0, 0.1, 1e-4}) {
        Material first = elastic_material(2e4, 0.3, 1000.0),
                 second = elastic_material(2e4 * softer, 0.4, 1000.0);
        first.damping_time_s = first_time_s;
        second.damping_time_s = second_time_s;
        SpringLattice lattice = make_composite_springs(
            small_block(),
            composite(small_block(), first, second, [](const Vector3& at) { return at.x() > 0.006; }));
        shake(lattice, 1e-3, 3);
        const double before = momentum_of(lattice).energy_j;
        RelaxSettings settings;
        for (; settings.tick < 1000; ++settings.tick) {
          relax(std::array{RelaxedLattice{&lattice}}, settings, {});
        }
        // Near the stability limit the energy of symplectic Euler oscillates by the factor 1 / (1 - w h / 2)
        // without growing.
        EXPECT_LT(momentum_of(lattice).energy_j, 10.0 * before)
            << first_time_s << ", " << second_time_s << ", " << softer;
      }
    }
  }
}

TEST(CompositeSprings, EveryInstructionSetGivesTheSameBits) {
  const auto shape_after = [&](InstructionSet set) {
    SpringLattice lattice = make_composite_springs(small_block(), all_different(small_block()), set);
    shake(lattice, 0.3, 7);
    RelaxSettings settings;
    for (; settings.tick < 100; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    return lattice.shape();
  };
  const std::vector<float> expected = shape_after(InstructionSet::baseline);
  for (const InstructionSet set : available_instruction_sets()) {
    EXPECT_EQ(shape_after(set), expected) << name_of(set);
  }
}

// A lattice whose two materials are equal behaves like one of that single material.
TEST(CompositeSprings, OneMaterialBehavesAsByItself) {
  const Material material = all_different(small_block()).materials[0];
  LatticeMaterials twice =
      composite(small_block(), material, material, [](const Vector3& at) { return at.x() > 0.006; });
  const auto shape_of = [&](const LatticeMaterials& materials) {
    SpringLattice lattice = make_composite_springs(small_block(), materials);
    shake(lattice, 0.1, 7);
    RelaxSettings settings;
    for (; settings.tick < 50; ++settings.tick) relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    return lattice.positions();
  };
  const std::vector<Vector3> one = shape_of(material), two = shape_of(twice);
  // The mass of a composite is summed in a different way, so that the last digits differ.
  for (std::size_t n = 0; n < one.size(); ++n) EXPECT_LT((one[n] - two[n]).norm(), 1e-8) << n;
}

TEST(CompositeSprings, StepsAllocateNothing) {
  SpringLattice lattice = make_composite_springs(small_block(), all_different(small_block()));
  shake(lattice, 0.1, 7);
  RelaxSettings settings;
  const std::array lattices{RelaxedLattice{&lattice}};
  const std::size_t before = allocation_count();
  for (; settings.tick < 30; ++settings.tick) relax(lattices, settings, {});
  EXPECT_EQ(allocation_count(), before);
}

// A block slides down an incline on its base, whose central part has a different friction. The mean of both
// frictions applies, because the weight is evenly distributed.
TEST(CompositeSprings, ABlockSlidesByTheFrictionsOfItsBase) {
  constexpr double tilt = 0.35, g = 9.81;
  const LatticeMesh mesh = box_mesh({0.02, 0.01, 0.024}, {5, 3, 7});
  Material smooth = elastic_material(2e4, 0.3, 1000.0);
  smooth.damping_time_s = 7e-5;
  smooth.friction = 0.1;
  for (const double rough : {0.1, 0.5, 1.2}) {
    // The region covers the central three of seven rows of nodes, which bear half of the weight.
    MaterialRegion middle;
    middle.region.along = {0.3, 0.7};
    middle.friction = rough;
    SpringLattice lattice =
        make_composite_springs(mesh, lattice_materials(mesh, smooth, {&middle, 1}).value());
    ContactConstraints contacts(35);
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.nodes[static_cast<std::size_t>(n)].y() > 1e-9) continue;
      EmbeddedPoint point;
      point.count = 1;
      point.node[0] = n;
      point.weight[0] = 1.0f;
      contacts.add_plane_push(0, lattice, point, Vector3::UnitY(), 0.0, n);
    }
    ToolState tool;
    RelaxSettings settings;
    const ToolMotion ground;
    const Vector3 gravity{g * std::sin(tilt), -g * std::cos(tilt), 0.0};
    const auto run = [&](int ticks) {
      for (int t = 0; t < ticks; ++t) {
        relax(std::array{RelaxedLattice{&lattice, gravity}}, settings,
              std::array{TouchingTool{ground, &tool, &contacts}});
      }
      return momentum_of(lattice).sum.x() / lattice.mass_kg();
    };
    const double before = run(200), gained = (run(400) - before) / 0.4;
    const double expected = std::max(0.0, g * (std::sin(tilt) - 0.5 * (0.1 + rough) * std::cos(tilt)));
    // The bound allows for remaining oscillations of the block.
    EXPECT_NEAR(gained, expected, 0.02 * g) << rough;
  }
}

}  // namespace
}  // namespace spoonbill
