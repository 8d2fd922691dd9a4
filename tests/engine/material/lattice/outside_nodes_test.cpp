// Tests how nodes outside a body continue its motion.
#include "engine/material/lattice/outside_nodes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "engine/material/lattice/box_lattice.h"
#include "tests/engine/collision/surfaces/sheets.h"

namespace spoonbill {
namespace {

double linear_field(const Vector3& at_m) {
  return 0.3 + 50.0 * at_m.x() - 20.0 * at_m.y() + 10.0 * at_m.z();
}

// The corners of the box about a ring are outside the body, and the middle of it too if the ring is thin.
TEST(OutsideNodes, ContinueALinearField) {
  for (const Surface& surface : {round_torus(0.02, 0.005), round_torus(0.011, 0.01)}) {
    const Result<LatticeMesh> mesh = surface_in_box(surface, {1000, {}});
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    const OutsideNodes outside(mesh.value());
    ASSERT_FALSE(outside.empty());
    std::vector<float> field, is_free(mesh->nodes.size(), 1.0f);
    for (std::size_t n = 0; n < mesh->nodes.size(); ++n) {
      const bool is_outside = mesh->node_locations[n] == NodeLocation::outside_body;
      field.push_back(is_outside ? 1e6f : static_cast<float>(linear_field(mesh->nodes[n])));
    }
    outside.continue_field(is_free.data(), field.data());
    for (std::size_t n = 0; n < mesh->nodes.size(); ++n) {
      // Values, of about 1, and weights are in single precision.
      EXPECT_NEAR(field[n], linear_field(mesh->nodes[n]), 1e-5) << n;
    }
  }
}

TEST(OutsideNodes, KeepTheirValuesIfTheyAreFixed) {
  const LatticeMesh mesh = surface_in_box(round_torus(0.02, 0.005), {500, {}}).value();
  const OutsideNodes outside(mesh);
  std::vector<float> field(mesh.nodes.size(), 2.0f), is_free(mesh.nodes.size(), 0.0f);
  for (std::size_t n = 0; n < field.size(); ++n) {
    if (mesh.node_locations[n] == NodeLocation::outside_body) field[n] = 1.0f;
  }
  const std::vector<float> before = field;
  outside.continue_field(is_free.data(), field.data());
  EXPECT_EQ(field, before);
}

TEST(OutsideNodes, AreSlowerThanTheSpeedCap) {
  const LatticeMesh mesh = surface_in_box(round_torus(0.02, 0.005), {500, {}}).value();
  const std::size_t count = mesh.nodes.size();
  const SpeedCap cap{2.0f, 3.0f, 0.0f, 0.0f};
  std::vector<float> vx(count, 10.0f), vy(count, 0.5f), vz(count, -1.0f), is_free(count, 1.0f);
  LatticeView view;
  view.vx = vx.data();
  view.vy = vy.data();
  view.vz = vz.data();
  view.free_node = is_free.data();
  OutsideNodes(mesh).limit_speeds(cap, view);
  for (std::size_t n = 0; n < count; ++n) {
    const bool is_outside = mesh.node_locations[n] == NodeLocation::outside_body;
    const Vector3 relative = Vector3(vx[n], vy[n], vz[n]) - Vector3(3.0, 0.0, 0.0);
    const Vector3 before(7.0, 0.5, -1.0);
    if (!is_outside) {
      EXPECT_EQ(relative, before) << n;
    } else {
      EXPECT_LT(relative.norm(), 2.0) << n;
      EXPECT_NEAR(relative.normalized().dot(before.normalized()), 1.0, 1e-6) << n;
    }
  }
}

TEST(OutsideNodes, AreNoneInAFullBlock) {
  EXPECT_TRUE(OutsideNodes(box_mesh({0.01, 0.01, 0.01}, {3, 3, 3})).empty());
}

}  // namespace
}  // namespace spoonbill
