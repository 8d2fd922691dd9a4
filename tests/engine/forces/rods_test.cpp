// Tests that rods and handles under tension have the Young's modulus of their material, in the springs and in
// the implicit solver's block.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/statics/static_solver.h"
#include "engine/simulation/body_state.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// Returns the mean position of the nodes of a slice, displaced by `displacement_m`.
Vector3 mean_of_slice(const LatticeMesh& mesh, int k, const std::vector<Vector3>& displacement_m) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j)
      sum += displacement_m[static_cast<std::size_t>(mesh.index(i, j, k))];
  }
  return sum / (mesh.count[0] * mesh.count[1]);
}

// Returns Young's modulus of a rod along y that is pulled by a force, from the strain between a third and two
// thirds of its length, where the stress is uniform.
double measured_modulus_pa(const LatticeMesh& mesh, const Material& material, CellKind kind,
                           double section_m2) {
  const int last = mesh.count[2] - 1, from = last / 3, to = last - last / 3;
  const double force_n = 1e-4 * material.youngs_modulus_pa * section_m2;
  std::vector<FixedAxis> fixed;
  StaticLoads loads;
  const int ends = mesh.count[0] * mesh.count[1];
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      fix_node(mesh.index(i, j, 0), Vector3::Zero(), fixed);
      loads.forces.push_back({mesh.index(i, j, last), {0.0, force_n / ends, 0.0}});
    }
  }
  const StaticBody body = StaticBody::make(mesh, material, kind).value();
  const std::vector<Vector3> moved = rest_under_load(body, loads, fixed).value().displacement_m;
  const double longer = (mean_of_slice(mesh, to, moved) - mean_of_slice(mesh, from, moved)).y();
  const double length = (mean_of_slice(mesh, to, mesh.nodes) - mean_of_slice(mesh, from, mesh.nodes)).y();
  std::printf("%s E ratio %.5f\n", kind == CellKind::springs ? "springs" : "hexa",
              force_n / section_m2 * length / longer / material.youngs_modulus_pa);
  return force_n / section_m2 * length / longer;
}

Body rod(const std::string& material, const CylinderSize& size, int budget) {
  Body body;
  body.name = "rod";
  body.surface = stock_surface(size);
  body.material = made_elastic(bundled_material(material));
  body.lattice.node_budget = budget;
  return body;
}

class Rods : public testing::TestWithParam<const char*> {};

TEST_P(Rods, HaveTheirYoungsModulusInTension) {
  const CylinderSize size{0.005, 0.08, 0.0005};
  const double section_m2 = std::numbers::pi * size.radius_m * size.radius_m;
  const Body body = rod(GetParam(), size, 1000);
  const BodyState state = make_body_state(body, {}, InstructionSet::baseline).value();
  const double wanted_pa = body.material.youngs_modulus_pa;
  const LatticeMesh& mesh = state.lattice.mesh();
  std::printf("report springs %.5f %.5f %.5f nu %f misfit %f\n",
              state.lattice.report().youngs_modulus_ratio[0], state.lattice.report().youngs_modulus_ratio[1],
              state.lattice.report().youngs_modulus_ratio[2], state.lattice.report().poissons_ratio[1],
              state.lattice.report().worst_cell_misfit);
  EXPECT_NEAR(measured_modulus_pa(mesh, body.material, CellKind::springs, section_m2) / wanted_pa, 1.0, 0.01);
  EXPECT_NEAR(measured_modulus_pa(mesh, body.material, CellKind::hexahedra, section_m2) / wanted_pa, 1.0,
              0.01);
  if (!state.implicit_solver) return;
  const LatticeMesh& block = state.implicit_solver->mesh();
  EXPECT_NEAR(measured_modulus_pa(block, body.material, CellKind::hexahedra, section_m2) / wanted_pa, 1.0,
              0.01);
}

INSTANTIATE_TEST_SUITE_P(, Rods, testing::Values("steel-304", "abs", "gelatin-20-1", "silicone-00-30"));

}  // namespace
}  // namespace spoonbill
