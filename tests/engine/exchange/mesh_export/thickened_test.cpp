#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

std::size_t unbalanced_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++uses[{corners[k], corners[(k + 1) % 3]}];
      --uses[{corners[(k + 1) % 3], corners[k]}];
    }
  }
  std::size_t unmatched = 0;
  for (const auto& [edge, count] : uses) unmatched += count == 0 ? 0 : 1;
  return unmatched;
}

// Returns the part of a cylinder about z that spans `angle` and is `length_m` long. Its normals point away
// from the axis.
TriangleMesh cylinder(double radius_m, double length_m, double angle, int around, int along) {
  TriangleMesh mesh;
  for (int i = 0; i <= around; ++i) {
    const double turn = angle * i / around;
    for (int j = 0; j <= along; ++j) {
      mesh.vertices_m.emplace_back(radius_m * std::cos(turn), radius_m * std::sin(turn),
                                   length_m * j / along);
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (along + 1) + j); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Thickened, APlateIsABoxWithoutAnOpenEdge) {
  TriangleMesh plate;
  plate.vertices_m = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.06, 0}, {0, 0.06, 0}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto shell = thicken_mesh(plate, 0.003);
  ASSERT_TRUE(shell) << shell.error().message;
  EXPECT_EQ(unbalanced_edges(shell.value()), 0U);
  EXPECT_EQ(shell->triangles.size(), 12U);
  EXPECT_NEAR(enclosed_volume_m3(shell.value()), 0.1 * 0.06 * 0.003, 1e-15);
}

// The volume of the shell is that between two cylinders. The walls along the edges lean by half of a chord's
// turn, a quarter of a degree, which changes the volume by the fraction 2e-4. Chords instead of arcs reduce
// the volume by less than 2e-5.
TEST(Thickened, ACurvedShellHasItsVolume) {
  constexpr double angle = std::numbers::pi / 2.0, radius_m = 0.05, thickness_m = 0.004, length_m = 0.03;
  const auto shell = thicken_mesh(cylinder(radius_m, length_m, angle, 180, 4), thickness_m);
  ASSERT_TRUE(shell) << shell.error().message;
  EXPECT_EQ(unbalanced_edges(shell.value()), 0U);
  const double inner_m = radius_m - thickness_m;
  const double volume = 0.5 * angle * (radius_m * radius_m - inner_m * inner_m) * length_m;
  EXPECT_NEAR(enclosed_volume_m3(shell.value()) / volume, 1.0, 4e-4);
}

TEST(Thickened, WhatIsThickerThanItIsCurvedIsRefused) {
  const auto shell = thicken_mesh(cylinder(0.005, 0.03, std::numbers::pi / 2.0, 40, 4), 0.006);
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().code, ErrorCode::self_intersecting) << shell.error().message;
}

}  // namespace
}  // namespace spoonbill
