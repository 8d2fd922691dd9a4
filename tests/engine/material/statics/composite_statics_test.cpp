// Tests bodies of two materials at rest against the theory of composites.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/material/implicit/implicit_body.h"
#include "engine/material/statics/static_solver.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/composite.h"

namespace spoonbill {
namespace {

constexpr double strain = 1e-6;

// Returns the effective modulus of a bar that is stretched along z. The ends are free to slip, but the bar
// cannot slide or turn as a whole.
double youngs_modulus_along_z(const LatticeMesh& mesh, const LatticeMaterials& materials, CellKind kind) {
  Result<StaticBody> body = StaticBody::make(mesh, materials, kind);
  EXPECT_TRUE(body.ok()) << body.error().message;
  const int last = mesh.count[2] - 1;
  const Vector3 size_m = mesh.nodes.back() - mesh.nodes.front();
  std::vector<FixedAxis> held = {{mesh.index(0, 0, 0), 0, 0.0},
                                 {mesh.index(0, 0, 0), 1, 0.0},
                                 {mesh.index(mesh.count[0] - 1, 0, 0), 1, 0.0}};
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      held.push_back({mesh.index(i, j, 0), 2, 0.0});
      held.push_back({mesh.index(i, j, last), 2, strain * size_m.z()});
    }
  }
  const Result<StaticResult> result = rest_under_load(body.value(), {}, held);
  EXPECT_TRUE(result.ok()) << result.error().message;
  double force_n = 0.0;
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      force_n += result->reaction_n[static_cast<std::size_t>(mesh.index(i, j, last))].z();
    }
  }
  return force_n / (strain * size_m.x() * size_m.y());
}

const LatticeMesh& short_bar() {
  static const LatticeMesh mesh = box_mesh({0.008, 0.006, 0.02}, {5, 4, 11});
  return mesh;
}

bool in_series(const Vector3& at) {
  return at.z() > 0.012;
}
bool in_parallel(const Vector3& at) {
  return at.x() > 0.004;
}

// reuss() returns the modulus of a bar in series, voigt() that of a bar in parallel. `share` is the second
// material's fraction of the length or of the cross section.
double reuss(double first, double second, double share) {
  return 1.0 / ((1.0 - share) / first + share / second);
}
double voigt(double first, double second, double share) {
  return (1.0 - share) * first + share * second;
}

// If nu / E is the same in both parts, both narrow equally under the same stress. The stress is then uniform,
// and the modulus is exactly that of Reuss.
TEST(CompositeStatics, InSeriesABarIsAsSoftAsReussSays) {
  const Material first = elastic_material(1e6, 0.25, 1000.0), second = elastic_material(1.8e6, 0.45, 1000.0);
  for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
    const double achieved =
        youngs_modulus_along_z(short_bar(), composite(short_bar(), first, second, in_series), kind);
    // The bound allows for terms of second order at a strain of 1e-6.
    EXPECT_NEAR(achieved / reuss(1e6, 1.8e6, 0.4), 1.0, 1e-5);
  }
}

// If Poisson's ratio is the same in both parts, both narrow equally under the same strain. The modulus is
// then exactly that of Voigt.
TEST(CompositeStatics, InParallelABarIsAsStiffAsVoigtSays) {
  const Material first = elastic_material(1e6, 0.35, 1000.0), second = elastic_material(2e7, 0.35, 1000.0);
  for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
    const LatticeMaterials materials = composite(short_bar(), first, second, in_parallel);
    EXPECT_NEAR(youngs_modulus_along_z(short_bar(), materials, kind) / voigt(1e6, 2e7, 0.5), 1.0, 1e-5);
  }
}

// A part that hinders or increases the lateral contraction of its neighbour makes the bar stiffer than the
// mean of Reuss (in series) or of Voigt (in parallel; Hill 1964). The bar is at most as stiff as with fixed
// sides.
TEST(CompositeStatics, UnlikeNarrowingMakesABarALittleStiffer) {
  const Material first = elastic_material(1e6, 0.45, 1000.0), second = elastic_material(3e7, 0.3, 1000.0);
  for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
    const double series =
        youngs_modulus_along_z(short_bar(), composite(short_bar(), first, second, in_series), kind);
    const double parallel =
        youngs_modulus_along_z(short_bar(), composite(short_bar(), first, second, in_parallel), kind);
    EXPECT_GT(series, reuss(1e6, 3e7, 0.4));
    EXPECT_LT(series, 1.1 * reuss(1e6, 3e7, 0.4));
    EXPECT_GT(parallel, voigt(1e6, 3e7, 0.5));
    EXPECT_LT(parallel, 1.01 * voigt(1e6, 3e7, 0.5));
  }
}

// A cantilever along z with stiffer faces at its top and bottom, each a tenth of the height thick.
struct Sandwich {
  static constexpr double length_m = 0.1, width_m = 0.004, height_m = 0.01, face_m = 0.001, load_n = 0.01;
  static constexpr double core_pa = 1e8, faces_pa = 1e9, poisson = 0.0;

  static bool in_faces(const Vector3& at) { return at.y() < face_m || at.y() > height_m - face_m; }
  static double youngs_modulus_pa(double mass_offset_m) {
    return std::abs(mass_offset_m) > 0.5 * height_m - face_m ? faces_pa : core_pa;
  }
  static LatticeMaterials materials(const LatticeMesh& mesh) {
    return composite(mesh, elastic_material(core_pa, poisson, 1000.0),
                     elastic_material(faces_pa, poisson, 1000.0), in_faces);
  }

  // Returns the deflection of the composite cantilever. Its bending stiffness is the sum of E I. Its shear
  // flexibility follows from the energy of the shear stress t(y), which is V / (E I) times the first moment
  // of E beyond y, where V is the shear force (Jourawski).
  static double sinking_m() {
    constexpr int slices = 20000;
    const double thick = height_m / slices;
    double bending = 0.0, first_moment = 0.0, flexibility = 0.0;
    for (int s = 0; s < slices; ++s) {
      const double y = -0.5 * height_m + (s + 0.5) * thick;
      bending += youngs_modulus_pa(y) * y * y * width_m * thick;
    }
    for (int s = 0; s < slices; ++s) {
      const double y = -0.5 * height_m + (s + 0.5) * thick;
      first_moment -= youngs_modulus_pa(y) * y * thick;
      const double shear_pa = youngs_modulus_pa(y) / (2.0 * (1.0 + poisson));
      flexibility += std::pow(first_moment / bending, 2) / shear_pa * width_m * thick;
    }
    return load_n * (std::pow(length_m, 3) / (3.0 * bending) + length_m * flexibility);
  }
};

TEST(CompositeStatics, ASandwichSinksAsTheCompositeBeamSays) {
  const LatticeMesh mesh = box_mesh({Sandwich::width_m, Sandwich::height_m, Sandwich::length_m}, {2, 11, 41});
  const StaticBody body = StaticBody::make(mesh, Sandwich::materials(mesh), CellKind::hexahedra).value();
  std::vector<FixedAxis> held;
  StaticLoads loads;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 11; ++j) {
      fix_node(mesh.index(i, j, 0), Vector3::Zero(), held);
      loads.forces.push_back({mesh.index(i, j, 40), {0.0, -Sandwich::load_n / 22.0, 0.0}});
    }
  }
  const StaticResult result = rest_under_load(body, loads, held).value();
  const double sunk = -result.displacement_m[static_cast<std::size_t>(mesh.index(0, 5, 40))].y();
  EXPECT_NEAR(sunk / Sandwich::sinking_m(), 1.0, 0.005);
  // A beam of the core alone would sink more than four times as far: the faces carry most of the load.
  const double alone = 4.0 * Sandwich::load_n * std::pow(Sandwich::length_m / Sandwich::height_m, 3) /
                       (Sandwich::core_pa * Sandwich::width_m);
  EXPECT_LT(sunk, 0.25 * alone);
}

// The implicit solver simulates a stiff body as a coarse block. Here this block has one cell through the
// thickness, made from ten cells of the lattice.
TEST(CompositeStatics, OneCellOfABlockBendsAsItsLayersDo) {
  const Vector3 size_m(Sandwich::width_m, Sandwich::height_m, Sandwich::length_m);
  const LatticeMesh fine = box_mesh(size_m, {2, 11, 41}), block = box_mesh(size_m, {2, 2, 21});
  ImplicitBody body =
      ImplicitBody::make(block, make_block_materials(Sandwich::materials(fine), fine.count, block.count),
                         InstructionSet::baseline)
          .value();
  std::vector<std::uint8_t> held(static_cast<std::size_t>(block.node_count()), 0);
  for (int n = 0; n < 4; ++n) held[static_cast<std::size_t>(n)] = 1;
  body.fix_nodes(held);
  for (int n = 0; n < 4; ++n) {
    body.set_node_force(block.node_count() - 1 - n, {0.0, -Sandwich::load_n / 4.0, 0.0});
  }
  ImplicitStep step;
  step.drag_per_s = 40.0;
  for (int tick = 0; tick < 1500; ++tick) body.step(step);
  // The cell treats the shear as uniform through the thickness, in faces and core. Shear therefore accounts
  // for 1 % of its deflection, instead of 2.7 %.
  EXPECT_NEAR(-body.displacement(block.node_count() - 1).y() / Sandwich::sinking_m(), 1.0, 0.025);
}

TEST(CompositeStatics, MassesAreThoseOfTheParts) {
  const LatticeMesh fine = box_mesh({0.01, 0.01, 0.06}, {6, 6, 31}),
                    block = box_mesh({0.01, 0.01, 0.06}, {3, 3, 8});
  Material light = elastic_material(1e9, 0.3, 500.0), heavy = elastic_material(2e9, 0.3, 8000.0);
  const LatticeMaterials materials =
      composite(fine, light, heavy, [](const Vector3& at) { return at.z() > 0.04; });
  const ImplicitBody body =
      ImplicitBody::make(block, make_block_materials(materials, fine.count, block.count),
                         InstructionSet::baseline)
          .value();
  const SpringLattice lattice = SpringLattice::make(fine, materials, InstructionSet::baseline).value();
  double mass_kg = 0.0, moment = 0.0, lattice_moment = 0.0;
  for (int n = 0; n < body.node_count(); ++n) {
    mass_kg += body.mass_kg(n);
    moment += body.mass_kg(n) * block.nodes[static_cast<std::size_t>(n)].z();
  }
  for (int n = 0; n < fine.node_count(); ++n) {
    lattice_moment += lattice.mass(n) * fine.nodes[static_cast<std::size_t>(n)].z();
  }
  const double expected = 1e-4 * (0.04 * 500.0 + 0.02 * 8000.0);
  const double expected_moment = 1e-4 * (0.04 * 500.0 * 0.02 + 0.02 * 8000.0 * 0.05);
  EXPECT_NEAR(mass_kg / expected, 1.0, 1e-12);
  EXPECT_NEAR(lattice.mass_kg() / expected, 1.0, 1e-12);
  EXPECT_NEAR(moment / expected_moment, 1.0, 1e-12);
  EXPECT_NEAR(lattice_moment / expected_moment, 1.0, 1e-6);  // masses are in single precision
}

}  // namespace
}  // namespace spoonbill
