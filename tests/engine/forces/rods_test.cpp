// Tests that rods and handles under tension have the Young's modulus of their material, in the springs and in
// the implicit solver's block.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice/layer_volumes.h"
#include "engine/material/statics/static_solver.h"
#include "engine/simulation/body_state.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// Returns the mean of a vector over the nodes of a slice.
Vector3 mean_of_slice(const LatticeMesh& mesh, int k, const std::vector<Vector3>& by_node) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) sum += by_node[static_cast<std::size_t>(mesh.index(i, j, k))];
  }
  return sum / (mesh.count[0] * mesh.count[1]);
}

// A force pulls a straight rod along an axis. Returns the ratio of the rod's Young's modulus to that of its
// material. The rod's modulus follows from the strain between a third and two thirds of the length, where the
// stress is uniform. `section_m2(k, length_m)` returns the area of the section of a layer.
template <class SectionOf>
double modulus_ratio(const LatticeMesh& mesh, const Material& material, CellKind kind, int axis,
                     const SectionOf& section_m2) {
  const int last = mesh.count[2] - 1, from = last / 3, to = last - last / 3;
  const double force_n = 1e-8 * material.youngs_modulus_pa;  // strains a section of 1 cm2 by 1e-4
  std::vector<FixedAxis> fixed;
  StaticLoads loads;
  const int ends = mesh.count[0] * mesh.count[1];
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      fix_node(mesh.index(i, j, 0), Vector3::Zero(), fixed);
      Vector3 pull = Vector3::Zero();
      pull[axis] = force_n / ends;
      loads.forces.push_back({mesh.index(i, j, last), pull});
    }
  }
  const StaticBody body = StaticBody::make(mesh, material, kind).value();
  const std::vector<Vector3> moved = rest_under_load(body, loads, fixed).value().displacement_m;
  const auto slice = [&](int k, const std::vector<Vector3>& by_node) {
    return mean_of_slice(mesh, k, by_node)[axis];
  };
  double expected_m = 0.0;
  for (int k = from; k < to; ++k) {
    const double length_m = slice(k + 1, mesh.nodes) - slice(k, mesh.nodes);
    expected_m += force_n * length_m / (material.youngs_modulus_pa * section_m2(k, length_m));
  }
  return expected_m / (slice(to, moved) - slice(from, moved));
}

void expect_modulus(const std::string& what, double ratio) {
  print_result("tension", what + ": E over the material's", ratio);
  EXPECT_NEAR(ratio, 1.0, 0.01) << what;
}

class Tension : public testing::TestWithParam<const char*> {};

TEST_P(Tension, OfARodHasItsYoungsModulus) {
  const CylinderSize size{0.005, 0.08, 0.0005};
  const Body body =
      stock_body("rod", size, Vector3::Zero(), made_elastic(bundled_material(GetParam())), 1000);
  const BodyState state = make_body_state(body, {}, InstructionSet::baseline).value();
  const auto section_m2 = [&](int, double) { return std::numbers::pi * size.radius_m * size.radius_m; };
  const std::string what = std::string("rod of ") + GetParam();
  const LatticeMesh& mesh = state.lattice.mesh();
  expect_modulus(what + ", springs", modulus_ratio(mesh, body.material, CellKind::springs, 1, section_m2));
  print_result("tension", what + ", reported", state.lattice.report().youngs_modulus_ratio[1]);
  EXPECT_NEAR(state.lattice.report().youngs_modulus_ratio[1], 1.0, 0.005);
  if (!state.implicit_solver) return;
  expect_modulus(what + ", block", modulus_ratio(state.implicit_solver->mesh(), body.material,
                                                 CellKind::hexahedra, 1, section_m2));
}

TEST_P(Tension, OfAHandleHasItsYoungsModulus) {
  Body body = bundled_scene("spoon-handle").bodies[0];
  body.material = made_elastic(bundled_material(GetParam()));
  const BodyState state = make_body_state(body, {}, InstructionSet::baseline).value();
  const std::string what = std::string("handle of ") + GetParam();
  const auto ratio = [&](const LatticeMesh& mesh, CellKind kind) {
    const std::vector<double> volumes_m3 = layer_volumes_m3(mesh);
    return modulus_ratio(mesh, body.material, kind, 0, [&](int k, double length_m) {
      return volumes_m3[static_cast<std::size_t>(k)] / length_m;
    });
  };
  expect_modulus(what + ", springs", ratio(state.lattice.mesh(), CellKind::springs));
  print_result("tension", what + ", reported", state.lattice.report().youngs_modulus_ratio[0]);
  EXPECT_NEAR(state.lattice.report().youngs_modulus_ratio[0], 1.0, 0.005);
  if (!state.implicit_solver) return;
  expect_modulus(what + ", block", ratio(state.implicit_solver->mesh(), CellKind::hexahedra));
}

INSTANTIATE_TEST_SUITE_P(, Tension, testing::Values("steel-304", "abs", "gelatin-20-1", "silicone-00-30"));

}  // namespace
}  // namespace spoonbill
