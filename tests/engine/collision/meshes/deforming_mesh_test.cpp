#include "engine/collision/meshes/deforming_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "tests/engine/allocations.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Returns the mesh deformed in proportion to `much`. The deformed mesh does not intersect itself.
TriangleMesh bent(TriangleMesh mesh, double much) {
  for (Vector3& vertex : mesh.vertices_m) {
    const Vector3 at = vertex;
    vertex += much * Vector3(0.3 * at.y() * at.y(), 0.2 * std::sin(2.0 * at.x()), 0.25 * at.x() * at.y());
  }
  return mesh;
}

std::vector<TriangleMesh> deforming_solids() {
  return {box_of_triangles({-0.5, -0.7, -0.9}, {0.5, 0.7, 0.9}), ball_mesh(12, 20, 0.9),
          torus_mesh(24, 12, 0.8, 0.35)};
}

// Returns a random point. Every second point is near an edge or a face, where sign errors are likely.
Vector3 point_near(Random& random, const TriangleMesh& mesh, int index) {
  if (index % 2 == 0) return random_point(random, 1.5);
  const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(
      random.integer(0, static_cast<int>(mesh.triangles.size()) - 1))];
  const double weight = random.uniform(0.0, 1.0),
               rest = index % 4 == 1 ? 0.0 : random.uniform(0.0, 1.0 - weight);
  const Vector3 on =
      weight * mesh.vertices_m[a] + rest * mesh.vertices_m[b] + (1.0 - weight - rest) * mesh.vertices_m[c];
  return on + random_point(random, 0.05);
}

TEST(DeformingMesh, TellsTheNearestPointAndTheSideOfItAsBruteForceDoes) {
  Random random(5);
  for (const TriangleMesh& rest : deforming_solids()) {
    DeformingMesh mesh(rest);
    for (const double much : {0.0, 1.0}) {
      const TriangleMesh now = bent(rest, much);
      mesh.mutable_vertices_m() = now.vertices_m;
      mesh.refit();
      for (int p = 0; p < random_point_count(300); ++p) {
        const Vector3 point = point_near(random, now, p);
        const double distance = brute_distance(now, point);
        const auto nearest = mesh.nearest(point, 10.0);
        ASSERT_TRUE(nearest);
        EXPECT_NEAR(std::abs(nearest->gap_m), distance, 1e-12);
        // Three random rays decide on which side of the surface the point is. A point on the surface, up to
        // rounding, is not tested.
        if (distance > 1e-9) {
          EXPECT_EQ(nearest->gap_m < 0.0, brute_inside(now, point, random)) << distance;
        }
        Vector3 on = Vector3::Zero();
        for (std::size_t c = 0; c < 3; ++c)
          on += nearest->on.weight[c] * now.vertices_m[nearest->on.vertex[c]];
        EXPECT_NEAR((on + nearest->gap_m * nearest->normal - point).norm(), 0.0, 1e-10);
        EXPECT_NEAR(nearest->normal.norm(), 1.0, 1e-12);
        EXPECT_EQ(mesh.nearest(point, 0.5 * distance).has_value(), false);
      }
    }
  }
}

TEST(DeformingMesh, KnowsTheWayOutWhereAPointLiesOnItsCorner) {
  const TriangleMesh box = box_of_triangles({-1, -1, -1}, {1, 1, 1});
  const DeformingMesh mesh(box);
  const auto corner = mesh.nearest({1, 1, 1}, 1.0);
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->gap_m, 0.0);
  // The corner's normal is weighted by angles, here three right angles, so that it is the diagonal however
  // the squares are split into triangles.
  EXPECT_LT((corner->normal - Vector3(1, 1, 1).normalized()).norm(), 1e-7);
}

TEST(DeformingMesh, AllocatesNothingWhileItMoves) {
  DeformingMesh mesh(ball_mesh(12, 20, 0.9));
  const std::size_t before = allocation_count();
  for (Vector3& vertex : mesh.mutable_vertices_m()) vertex.x() += 0.1;
  mesh.refit();
  EXPECT_TRUE(mesh.nearest({1.1, 0, 0}, 0.5));
  EXPECT_EQ(allocation_count(), before);
}

double volume_of(const TriangleMesh& mesh) {
  MeshPart all;
  all.end_triangle = static_cast<std::uint32_t>(mesh.triangles.size());
  return signed_volume(mesh, all);
}

TEST(MeshRefinement, KeepsTheShapeAndShortensEveryEdge) {
  for (const TriangleMesh& mesh : deforming_solids()) {
    for (const double longest : {0.4, 0.11}) {
      const TriangleMesh fine = refine_edges(mesh, longest, 100000).value();
      double found = 0.0;
      for (const auto& [a, b, c] : fine.triangles) {
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
          found = std::max(found, (fine.vertices_m[from] - fine.vertices_m[to]).norm());
        }
      }
      EXPECT_LE(found, longest);
      EXPECT_GE(found, 0.4 * longest) << "no finer than asked for";
      const CleanMesh clean = cleaned(fine);
      EXPECT_EQ(clean.report.open_edges + clean.report.branching_edges, 0u);
      EXPECT_EQ(clean.report.triangles_flipped, 0u);
      EXPECT_NEAR(volume_of(fine) / volume_of(mesh), 1.0, 1e-12);
      for (std::size_t v = 0; v < mesh.vertices_m.size(); ++v) {
        EXPECT_EQ(fine.vertices_m[v], mesh.vertices_m[v]);
      }
    }
  }
}

TEST(MeshRefinement, RefusesMoreTrianglesThanAllowed) {
  const auto refused = refine_edges(ball_mesh(12, 20, 0.9), 0.01, 5000);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::too_many) << refused.error().message;
}

}  // namespace
}  // namespace spoonbill
