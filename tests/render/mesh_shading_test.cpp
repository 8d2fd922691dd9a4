#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "render/tessellation/tessellated_surface.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

MeshSnapshot mesh_snapshot_of(const TriangleMesh& triangles) {
  MeshSnapshot mesh;
  mesh.triangles = std::make_shared<const std::vector<TriangleCorners>>(triangles.triangles);
  for (const Vector3& vertex : triangles.vertices_m) {
    mesh.x.push_back(static_cast<float>(vertex.x()));
    mesh.y.push_back(static_cast<float>(vertex.y()));
    mesh.z.push_back(static_cast<float>(vertex.z()));
  }
  return mesh;
}

struct Drawn {
  Eigen::Vector3f position, normal;
};

std::vector<Drawn> drawn(const TessellatedSurface& surface) {
  const GridSamples<float>& at = surface.samples();
  std::vector<Drawn> all;
  for (std::size_t v = 0; v < surface.vertex_count(); ++v) {
    all.push_back({{at.x[v], at.y[v], at.z[v]}, {at.nx[v], at.ny[v], at.nz[v]}});
  }
  return all;
}

TEST(MeshShading, KeepsTheEdgesOfABox) {
  TessellatedSurface surface;
  surface.update(mesh_snapshot_of(box_of_triangles({-1, -2, -3}, {1, 2, 3})));
  EXPECT_TRUE(surface.is_mesh());
  EXPECT_TRUE(surface.is_closed());
  EXPECT_EQ(surface.indices().size(), 36u);
  ASSERT_EQ(surface.vertex_count(), 24u) << "each corner once on each of its three sides";
  for (const Drawn& each : drawn(surface)) {
    EXPECT_NEAR(each.normal.cwiseAbs().maxCoeff(), 1.0f, 1e-6f);
    EXPECT_GT(each.normal.dot(each.position), 0.0f);
  }
}

TEST(MeshShading, IsSmoothOnABallAndFollowsItsShape) {
  const TriangleMesh ball = ball_mesh(16, 24, 1.0);
  MeshSnapshot mesh = mesh_snapshot_of(ball);
  TessellatedSurface surface;
  surface.update(mesh);
  ASSERT_EQ(surface.vertex_count(), ball.vertices_m.size());
  // Neighbouring rings and meridians of the ball's vertices are at most 15 degrees apart.
  for (const Drawn& each : drawn(surface)) EXPECT_GT(each.normal.dot(each.position), 0.995f);
  const std::uint64_t version = surface.topology_version();
  for (float& y : mesh.y) y *= 0.25f;
  surface.update(mesh);
  EXPECT_EQ(surface.topology_version(), version);
  for (const Drawn& each : drawn(surface)) {
    // `wanted` is the exact normal of the ellipsoid into which the ball has been squashed.
    const Eigen::Vector3f wanted =
        Eigen::Vector3f(each.position.x(), 16.0f * each.position.y(), each.position.z()).normalized();
    EXPECT_GT(each.normal.dot(wanted), 0.98f);
  }
  EXPECT_NEAR(surface.bounds().high.y(), 0.25, 1e-6);
}

}  // namespace
}  // namespace spoonbill
