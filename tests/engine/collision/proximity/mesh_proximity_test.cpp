#include "engine/collision/proximity/mesh_proximity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/collision/solids/implicit/support_function.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

int trials(int few) {
  return random_cases(few, 30 * few);
}

TriangleMesh moved(TriangleMesh mesh, const Quaternion& turn, const Vector3& shift) {
  for (Vector3& vertex : mesh.vertices_m) vertex = turn * vertex + shift;
  return mesh;
}

std::vector<int> each_its_own(std::size_t vertices) {
  std::vector<int> patches(vertices);
  std::iota(patches.begin(), patches.end(), 0);
  return patches;
}

struct Foot {
  double distance_m, u, v;
};

// Finds the nearest point of a surface from many samples, then from ever finer samples around the nearest
// one.
class BruteSurface {
 public:
  explicit BruteSurface(const Surface& surface) : surface_(surface) {
    for (int i = 0; i < around; ++i) {
      for (int j = 0; j <= along; ++j) {
        const double u = at(surface.u, i, around), v = at(surface.v, j, along);
        samples_.push_back({evaluate(surface, u, v).position_m, u, v});
      }
    }
  }

  Foot nearest(const Vector3& point) const {
    const auto first = std::min_element(samples_.begin(), samples_.end(), [&](const auto& a, const auto& b) {
      return (a.point - point).squaredNorm() < (b.point - point).squaredNorm();
    });
    Foot best{(first->point - point).norm(), first->u, first->v};
    double reach_u = (surface_.u.domain_end() - surface_.u.domain_start()) / around;
    double reach_v = (surface_.v.domain_end() - surface_.v.domain_start()) / along;
    for (int round = 0; round < 20; ++round) {
      const Foot middle = best;
      for (int i = -side; i <= side; ++i) {
        for (int j = -side; j <= side; ++j) {
          const double u = surface_.u.into_domain(middle.u + reach_u * i / side);
          const double v = surface_.v.into_domain(middle.v + reach_v * j / side);
          const double distance = (evaluate(surface_, u, v).position_m - point).norm();
          if (distance < best.distance_m) best = {distance, u, v};
        }
      }
      reach_u *= 0.5;
      reach_v *= 0.5;
    }
    return best;
  }

 private:
  static constexpr int around = 100, along = 200, side = 3;
  struct Sample {
    Vector3 point;
    double u, v;
  };
  static double at(const KnotVector& knots, int index, int count) {
    return knots.domain_start() + (knots.domain_end() - knots.domain_start()) * index / count;
  }
  const Surface& surface_;
  std::vector<Sample> samples_;
};

struct EllipsoidScene {
  Surface surface = ellipsoid_tube(12, 12);
  NestedGrid nested = make_nested_grid(surface.u, surface.v, 1).value();
};

// Returns a mesh whose centre is 2 to 12 mm outside a random point of the ellipsoid.
TriangleMesh placed_mesh(Random& random, int trial) {
  const TriangleMesh shapes[] = {box_of_triangles({-0.012, -0.007, -0.009}, {0.012, 0.007, 0.009}),
                                 ball_mesh(10, 14, 0.01), torus_mesh(18, 8, 0.012, 0.004)};
  const Vector3 way = random_point(random, 1.0).normalized();
  const Vector3 centre = way.cwiseProduct(Vector3(0.02, 0.01, 0.05)) + random.uniform(0.002, 0.012) * way;
  return moved(shapes[trial % 3], random_turn(random), centre);
}

TEST(MeshProximity, FindsEverySampleThatIsNear) {
  Random random(18);
  const EllipsoidScene scene;
  constexpr double margin = 1e-3;
  int found = 0;
  for (int trial = 0; trial < trials(12); ++trial) {
    const TriangleMesh triangles = placed_mesh(random, trial);
    MeshProximity proximity(scene.nested, each_its_own(triangles.vertices_m.size()));
    proximity.find(scene.surface, DeformingMesh(triangles), margin);
    EXPECT_FALSE(proximity.overflow());
    const Grid& grid = scene.nested.grid;
    std::set<int> told;
    for (const SampleNearMesh& near : proximity.surface_samples()) {
      EXPECT_TRUE(told.insert(near.sample).second) << "told once";
      EXPECT_LE(proximity.least_gap_m(), near.mesh.gap_m);
    }
    for (int sample = 0; sample < grid.rows() * grid.columns(); ++sample) {
      const Vector3 point = evaluate(scene.surface, grid.u.parameters[sample / grid.columns()],
                                     grid.v.parameters[sample % grid.columns()])
                                .position_m;
      const double distance = brute_distance(triangles, point);
      if (std::abs(distance - margin) < 1e-9) continue;
      EXPECT_EQ(told.count(sample) == 1, distance < margin) << distance;
    }
    for (const SampleNearMesh& near : proximity.surface_samples()) {
      const Vector3 point = evaluate(scene.surface, grid.u.parameters[near.sample / grid.columns()],
                                     grid.v.parameters[near.sample % grid.columns()])
                                .position_m;
      const double distance = brute_distance(triangles, point);
      EXPECT_NEAR(std::abs(near.mesh.gap_m), distance, 1e-12);
      if (distance > 1e-9) {
        EXPECT_EQ(near.mesh.gap_m < 0.0, brute_inside(triangles, point, random));
      }
      ++found;
    }
  }
  EXPECT_GT(found, effort(50));
}

TEST(MeshProximity, FindsEveryVertexThatIsNear) {
  Random random(12);
  const EllipsoidScene scene;
  const BruteSurface brute(scene.surface);
  constexpr double margin = 1e-3;
  int found = 0;
  for (int trial = 0; trial < trials(9); ++trial) {
    const TriangleMesh triangles = placed_mesh(random, trial);
    MeshProximity proximity(scene.nested, each_its_own(triangles.vertices_m.size()));
    proximity.find(scene.surface, DeformingMesh(triangles), margin);
    std::vector<const VertexNearSurface*> told(triangles.vertices_m.size(), nullptr);
    for (const VertexNearSurface& near : proximity.mesh_vertices()) {
      EXPECT_EQ(told[near.vertex], nullptr) << "told once";
      told[near.vertex] = &near;
    }
    for (std::size_t vertex = 0; vertex < triangles.vertices_m.size(); ++vertex) {
      const Vector3& point = triangles.vertices_m[vertex];
      const auto [distance, u, v] = brute.nearest(point);
      const Vector3 normal = unit_normal(scene.surface, u, v);
      const double gap =
          normal.dot(point - evaluate(scene.surface, u, v).position_m) < 0.0 ? -distance : distance;
      // A vertex may or may not be reported if its gap is near the margin, or if it is deeper than the
      // margin.
      if (std::abs(gap - margin) < 1e-6 || gap < 1e-6 - margin) continue;
      ASSERT_EQ(told[vertex] != nullptr, gap < margin) << gap;
      if (!told[vertex]) continue;
      ++found;
      // The brute-force point differs from the nearest point by about the square root of the brute-force
      // error in distance. The normals are therefore compared less strictly.
      EXPECT_NEAR(told[vertex]->gap_m, gap, 1e-9);
      EXPECT_LT((told[vertex]->normal - normal).norm(), 1e-3);
    }
  }
  EXPECT_GT(found, effort(50));
}

TEST(MeshProximity, TellsTheDeepestOfAPatch) {
  const EllipsoidScene scene;
  const TriangleMesh ball = ball_mesh(30, 40, 0.01, {0.0, 0.0195, 0.0});
  const DeformingMesh mesh(ball);
  MeshProximity all(scene.nested, each_its_own(ball.vertices_m.size()));
  MeshProximity one(scene.nested, std::vector<int>(ball.vertices_m.size(), 0));
  all.find(scene.surface, mesh, 1e-3);
  one.find(scene.surface, mesh, 1e-3);
  ASSERT_GT(all.mesh_vertices().size(), 5u);
  ASSERT_EQ(one.mesh_vertices().size(), 1u);
  double least = 1.0;
  for (const VertexNearSurface& near : all.mesh_vertices()) least = std::min(least, near.gap_m);
  EXPECT_LT(least, -2e-4);
  // The reported vertex is chosen by its depth below a tangent plane, which touches the surface at the point
  // nearest to another vertex. The two vertices are here up to 6 mm apart on a surface with a radius of about
  // 20 mm, so the reported vertex is only nearly the deepest.
  EXPECT_NEAR(one.mesh_vertices()[0].gap_m, least, 3e-4);
}

TEST(MeshProximity, AllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  const EllipsoidScene scene;
  const TriangleMesh ball = ball_mesh(30, 40, 0.01, {0.0, 0.0195, 0.0});
  const DeformingMesh mesh(ball);
  MeshProximity proximity(scene.nested, each_its_own(ball.vertices_m.size()));
  const std::size_t before = allocation_count();
  proximity.find(scene.surface, mesh, 1e-3);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_FALSE(proximity.surface_samples().empty());
}

}  // namespace
}  // namespace spoonbill
