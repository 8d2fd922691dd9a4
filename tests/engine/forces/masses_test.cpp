// Tests that a body has the mass of its exact volume everywhere: in its lattice, in the implicit solver's
// block and in the information about the body.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "engine/inspection/mass_properties.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/layer_volumes.h"
#include "engine/simulation/body_state.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

class Masses : public testing::TestWithParam<std::string> {};

TEST_P(Masses, AreThoseOfTheExactVolume) {
  const bool is_quick = GetParam() == "spoon-handle" || GetParam() == "bowl";
  const std::string reason = find_skip_reason(is_quick ? ForceRun::always : ForceRun::full);
  if (!reason.empty()) GTEST_SKIP() << reason;
  for (Body body : bundled_scene(GetParam()).bodies) {
    if (!body.trims.empty()) continue;           // the lattice also covers what is trimmed away
    if (body.kind == BodyKind::fixed) continue;  // its lattice is a frame, whose mass has no effect
    const double exact_kg = compute_body_mass(body).value().mass_kg();
    const BodyState state = make_body_state(body, {}, InstructionSet::baseline).value();
    EXPECT_NEAR(state.lattice.mass_kg() / exact_kg, 1.0, 1e-3) << body.name;
    if (!body.regions.empty()) continue;
    body.material = bundled_material("steel-304");
    const BodyState steel = make_body_state(body, {}, InstructionSet::baseline).value();
    const double steel_kg = compute_body_mass(body).value().mass_kg();
    EXPECT_NEAR(steel.lattice.mass_kg() / steel_kg, 1.0, 1e-3) << body.name;
    ASSERT_TRUE(steel.implicit_solver.has_value());
    EXPECT_NEAR(
        sum(layer_volumes_m3(steel.implicit_solver->mesh())) * body.material.density_kg_per_m3 / steel_kg,
        1.0, 1e-3)
        << body.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Masses, testing::ValuesIn(bundled_model_names()), [](const auto& model) {
  std::string name = model.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(LayerVolumes, OfARodAreThoseOfItsSections) {
  const CylinderSize size{0.005, 0.08, 0.0005};
  const LatticeMesh mesh = solid_lattice(stock_surface(size), {1000, {}}).value();
  const std::vector<double> volumes = layer_volumes_m3(mesh);
  for (int k = 1; k + 2 < mesh.count[2]; ++k) {
    const double length = mesh.nodes[static_cast<std::size_t>(mesh.index(0, 0, k + 1))].y() -
                          mesh.nodes[static_cast<std::size_t>(mesh.index(0, 0, k))].y();
    const double section = std::numbers::pi * size.radius_m * size.radius_m;
    EXPECT_NEAR(volumes[static_cast<std::size_t>(k)] / (length * section), 1.0, 1e-3) << k;
  }
}

TEST(LayerVolumes, OfATorusAddUpToItsVolume) {
  const Surface torus = stock_surface(TorusSize{0.04, 0.01});
  const LatticeMesh mesh = solid_lattice(torus, {4000, {}}).value();
  EXPECT_NEAR(sum(layer_volumes_m3(mesh)) / compute_enclosed_mass(torus).volume_m3, 1.0, 1e-6);
}

TEST(LayerVolumes, FollowOtherLayersOfTheSameBody) {
  const std::vector<double> volumes = {1.0, 2.0, 4.0};
  EXPECT_EQ(redistribute_layers(volumes, 1), (std::vector<double>{7.0}));
  const std::vector<double> two = redistribute_layers(volumes, 2);
  EXPECT_NEAR(two[0], 2.0, 1e-12);
  EXPECT_NEAR(two[1], 5.0, 1e-12);
}

}  // namespace
}  // namespace spoonbill
