#include "engine/inspection/solid_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

SolidCheck checked(const TriangleMesh& mesh, double error_m = 0.0) {
  const auto check = check_solid(mesh, {}, error_m);
  EXPECT_TRUE(check.has_value());
  return check.value_or(SolidCheck());
}

// Returns a bar of 0.1 m along x whose section is a triangle or quadrangle, with the corners
// counter-clockwise seen from +x.
TriangleMesh prism(const std::vector<Vector3>& profile) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(profile.size());
  for (const double x : {0.0, 0.1}) {
    for (const Vector3& point : profile) mesh.vertices_m.push_back(point + Vector3(x, 0, 0));
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    mesh.triangles.push_back({k, next, next + n});
    mesh.triangles.push_back({k, next + n, k + n});
  }
  for (std::uint32_t k = 1; k + 1 < n; ++k) {
    mesh.triangles.push_back({0, k + 1, k});
    mesh.triangles.push_back({n, n + k, n + k + 1});
  }
  return mesh;
}

TEST(SolidCheck, ThicknessOfABoxIsItsLeastSide) {
  const SolidCheck check = checked(box_of_triangles({-0.02, 0.01, 0.0}, {0.01, 0.03, 0.004}));
  ASSERT_TRUE(check.thinnest);
  EXPECT_NEAR(check.thinnest->thickness_m, 0.004, 1e-12);
  EXPECT_NEAR((check.thinnest->position_m - check.thinnest->opposite_m).norm(), 0.004, 1e-12);
  EXPECT_TRUE(check.self_intersections.empty());
  EXPECT_TRUE(check.self_intersections_complete);
}

TEST(SolidCheck, ThicknessOfABallIsItsDiameterWithinItsChords) {
  constexpr int rings = 24, around = 48;
  const SolidCheck check = checked(ball_mesh(rings, around, 0.05));
  ASSERT_TRUE(check.thinnest);
  // The corners of a facet are within 5.4 degrees of its centre, half the diagonal of a cell.
  EXPECT_NEAR(check.thinnest->thickness_m, 0.1, 0.1 * (1.0 - std::cos(5.4 * pi / 180.0)));
}

TEST(SolidCheck, TheWallAboutACavityIsTheThickness) {
  // The cavity's walls are 2 to 6 mm from the faces of the box.
  const TriangleMesh hollow = joined(box_of_triangles({0, 0, 0}, {0.05, 0.04, 0.03}),
                                     turned(box_of_triangles({0.004, 0.003, 0.005}, {0.045, 0.034, 0.028})));
  const SolidCheck check = checked(hollow);
  ASSERT_TRUE(check.thinnest);
  EXPECT_NEAR(check.thinnest->thickness_m, 0.002, 1e-12);
  EXPECT_TRUE(check.self_intersections.empty());
}

// Faces with a draft of 3 degrees meet the bottom at 87 degrees. Near such an edge, lines from one face to
// the other can be arbitrarily short.
TEST(SolidCheck, EdgesOfADraftedBlockAreNotThin) {
  const double draft = 0.02 * std::tan(3.0 * pi / 180.0);
  const SolidCheck check =
      checked(prism({{0, 0, 0}, {0, 0.06, 0}, {0, 0.06 - draft, 0.02}, {0, draft, 0.02}}));
  ASSERT_TRUE(check.thinnest);
  EXPECT_NEAR(check.thinnest->thickness_m, 0.02, 1e-9);
}

TEST(SolidCheck, AKnifesEdgeIsThin) {
  const double half = 0.03 * std::tan(5.0 * pi / 180.0);
  const SolidCheck check = checked(prism({{0, 0, -half}, {0, 0.03, 0}, {0, 0, half}}));
  ASSERT_TRUE(check.thinnest);
  EXPECT_LT(check.thinnest->thickness_m, 1e-4);
}

// Returns a block with a dent in its top; the deepest point of the dent is `below_m` below the bottom.
TriangleMesh dented(double below_m) {
  TriangleMesh mesh = box_of_triangles({0, 0, 0}, {0.03, 0.02, 0.01});
  const auto deepest = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.emplace_back(0.014, 0.009, -below_m);
  std::vector<TriangleCorners> triangles;
  for (const TriangleCorners& t : mesh.triangles) {
    const auto is_top = [&](std::uint32_t corner) { return mesh.vertices_m[corner].z() > 0.009; };
    if (!(is_top(t[0]) && is_top(t[1]) && is_top(t[2]))) {
      triangles.push_back(t);
      continue;
    }
    // The diagonal shared by both triangles of the top is skipped.
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 side = mesh.vertices_m[t[(k + 1) % 3]] - mesh.vertices_m[t[k]];
      if (std::abs(side.x()) < 1e-9 || std::abs(side.y()) < 1e-9) {
        triangles.push_back({t[k], t[(k + 1) % 3], deepest});
      }
    }
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

TEST(SolidCheck, FacesThatPassThroughEachOtherAreFound) {
  const SolidCheck check = checked(dented(0.002), 1e-4);
  ASSERT_FALSE(check.self_intersections.empty());
  EXPECT_NEAR(check.self_intersections[0].depth_m, 0.002, 1e-9);
  EXPECT_NEAR(check.self_intersections[0].position_m.z(), 0.0, 1e-9);
  EXPECT_TRUE(checked(dented(-0.002), 1e-4).self_intersections.empty());
}

TEST(SolidCheck, WhatTheMeshMayHaveWrongIsNoMeeting) {
  EXPECT_TRUE(checked(dented(0.002), 1.1e-3).self_intersections.empty());
}

TEST(SolidCheck, StopsWhenAsked) {
  EXPECT_FALSE(
      check_solid(ball_mesh(12, 24, 0.05), {}, 0.0, Progress([](double share) { return share < 0.3; })));
}

}  // namespace
}  // namespace spoonbill
