#include "engine/fitting/point_discs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace spoonbill {
namespace {

Scan level_grid(double spacing_m) {
  Scan cloud;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) cloud.points_m.push_back({i * spacing_m, 0.0, j * spacing_m});
  }
  return cloud;
}

// Circles around the points of a square grid cover it from a radius of sqrt(1/2) spacings on.
TEST(PointDiscs, CoverALevelGrid) {
  const TriangleMesh mesh = make_point_discs(level_grid(0.001), 1000);
  ASSERT_EQ(mesh.vertices_m.size(), 6u * 400u);
  ASSERT_EQ(mesh.triangles.size(), 4u * 400u);
  for (const Vector3& corner : mesh.vertices_m) EXPECT_NEAR(corner.y(), 0.0, 1e-9);
  const std::size_t inner = 6 * (10 * 20 + 10);
  const double radius_m = (mesh.vertices_m[inner] - Vector3(0.010, 0.0, 0.010)).norm();
  EXPECT_GT(radius_m, std::sqrt(0.5) * 0.001);
  EXPECT_LT(radius_m, 0.0011);
}

TEST(PointDiscs, LieAcrossTheNormalsOfTheCloud) {
  Scan cloud = level_grid(0.001);
  cloud.normals.assign(cloud.points_m.size(), Vector3::UnitX());
  const TriangleMesh mesh = make_point_discs(cloud, 1000);
  for (std::size_t v = 0; v < mesh.vertices_m.size(); ++v) {
    EXPECT_NEAR(mesh.vertices_m[v].x(), cloud.points_m[v / 6].x(), 1e-12);
  }
}

TEST(PointDiscs, AreAtMostAsManyAsAllowed) {
  EXPECT_LE(make_point_discs(level_grid(0.001), 150).triangles.size(), 4u * 150u);
  EXPECT_TRUE(make_point_discs(Scan{}, 150).triangles.empty());
}

TEST(PointDiscs, ShowPointsInOnePlace) {
  Scan cloud;
  cloud.points_m.assign(3, Vector3(0.01, 0.02, 0.03));
  for (const Vector3& corner : make_point_discs(cloud, 10).vertices_m) {
    EXPECT_NEAR((corner - cloud.points_m[0]).norm(), 1e-3, 2e-4);
  }
}

TEST(PointDiscs, AreNotLargeForStrayPoints) {
  Scan cloud = level_grid(0.001);
  cloud.points_m.push_back({0.01, 0.3, 0.01});
  const TriangleMesh mesh = make_point_discs(cloud, 1000);
  EXPECT_LT((mesh.vertices_m.back() - cloud.points_m.back()).norm(), 0.003);
}

}  // namespace
}  // namespace spoonbill
