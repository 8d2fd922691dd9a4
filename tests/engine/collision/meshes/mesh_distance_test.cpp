#include "engine/collision/meshes/mesh_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "engine/collision/meshes/triangle.h"
#include "tests/engine/allocations.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Returns a random point; every second point is near the surface, where sign errors are likely.
Vector3 point_about(Random& random, const TriangleMesh& mesh, int index) {
  if (index % 2 == 0) return random_point(random, 1.8);
  const auto vertex = random.integer(0, static_cast<int>(mesh.vertices_m.size()) - 1);
  return mesh.vertices_m[static_cast<std::size_t>(vertex)] + random_point(random, 0.1);
}

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

TriangleMesh with_hole(const TriangleMesh& mesh) {
  return without(mesh, 40, 2);
}

// Returns two pyramids whose tips are the same vertex.
TriangleMesh hourglass() {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}};
  for (const double y : {1.0, -1.0}) {
    for (int k = 0; k < 3; ++k) {
      mesh.vertices_m.emplace_back(0.8 * std::cos(2.1 * k), y, 0.8 * std::sin(2.1 * k));
    }
  }
  for (const std::uint32_t first : {1U, 4U}) {
    mesh.triangles.push_back({0, first, first + 1});
    mesh.triangles.push_back({0, first + 1, first + 2});
    mesh.triangles.push_back({0, first + 2, first});
    mesh.triangles.push_back({first, first + 2, first + 1});
  }
  for (std::size_t t = 4; t < 8; ++t) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  return mesh;
}

std::vector<NamedMesh> named_solids() {
  return {{"box", box_of_triangles({-0.5, -0.7, -0.9}, {0.5, 0.7, 0.9})},
          {"ball", ball_mesh(12, 20, 0.9)},
          {"torus", torus_mesh(24, 12, 0.8, 0.35)},
          {"slender box", box_of_triangles({-1, -1e-5, -0.2}, {1, 1e-5, 0.2})},
          {"needles", ball_mesh(3, 400, 0.9)},
          {"hourglass", hourglass()},
          {"boxes with a common edge",
           joined(box_of_triangles({-1, -1, 0}, {0, 0, 1}), box_of_triangles({0, 0, 0}, {1, 1, 1}))},
          {"hollow box", joined(turned(box_of_triangles({-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3})),
                                box_of_triangles({-1, -1, -1}, {1, 1, 1}))}};
}

TEST(MeshDistance, AgreesWithAllTrianglesAndWithRays) {
  for (const NamedMesh& solid : named_solids()) {
    SCOPED_TRACE(solid.name);
    const MeshDistance distance(cleaned(soup(solid.mesh)));
    Random random(17);
    for (int k = 0; k < random_point_count(400); ++k) {
      const Vector3 at = point_about(random, solid.mesh, k);
      const double expected = brute_distance(solid.mesh, at);
      const double found = distance.at(at).distance_m;
      // The tolerance covers the rounding of coordinates near 1.
      ASSERT_NEAR(std::abs(found), expected, 1e-13) << at.transpose();
      if (expected > 1e-9) {
        ASSERT_EQ(found < 0.0, brute_inside(solid.mesh, at, random)) << at.transpose();
      }
    }
  }
}

TEST(MeshDistance, OfABoxIsTheClosedForm) {
  const Vector3 half(0.5, 0.7, 0.9);
  const MeshDistance distance(cleaned(turned(box_of_triangles(-half, half))));
  Random random(4);
  for (int k = 0; k < random_point_count(2000); ++k) {
    const Vector3 at = random_point(random, 1.5);
    const Vector3 beyond = at.cwiseAbs() - half;
    const double expected = beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
    ASSERT_NEAR(distance.at(at).distance_m, expected, 1e-14);
  }
  EXPECT_NEAR(distance.at({0.5, 0.7, 0.9}).gradient.minCoeff(), std::sqrt(1.0 / 3.0), 1e-12);
  EXPECT_EQ(distance.at({0.0, 0.7, 0.1}).gradient, Vector3(0, 1, 0));
}

std::vector<NamedMesh> everything() {
  std::vector<NamedMesh> all = named_solids();
  all.push_back({"sheet", sheet_mesh(8, 0.4)});
  all.push_back({"moebius strip", moebius_strip(30)});
  all.push_back({"ball with a hole", with_hole(ball_mesh(12, 20, 0.9))});
  all.push_back({"half a ball", without(ball_mesh(12, 20, 0.9), 0, 220)});
  all.push_back({"torus through itself", torus_mesh(24, 12, 0.4, 0.7)});
  all.push_back({"tube through itself", crossing_tube(40, 12)});
  all.push_back(
      {"overlapping balls", joined(ball_mesh(8, 12, 0.7, {0.4, 0, 0}), ball_mesh(8, 12, 0.7, {-0.4, 0, 0}))});
  all.push_back({"ball and sheet", joined(ball_mesh(8, 12, 0.4), sheet_mesh(4, 0.1))});
  TriangleMesh split = box_of_triangles({-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8});
  split.triangles.push_back({0, 1, 7});  // a triangle across the interior
  split.triangles.push_back({0, 7, 6});
  all.push_back({"box with a wall", split});
  return all;
}

// The distance is continuous, and it never changes by more than the point moves: across every surface and
// hole, near and far.
TEST(MeshDistance, ChangesByNoMoreThanTheWayMoved) {
  for (const NamedMesh& shape : everything()) {
    SCOPED_TRACE(shape.name);
    const MeshDistance distance(cleaned(shape.mesh), 0.04);
    Random random(29);
    for (int k = 0; k < random_point_count(1000); ++k) {
      const Vector3 a = point_about(random, shape.mesh, k);
      const Vector3 b = a + random_point(random, k % 3 == 0 ? 1.0 : k % 3 == 1 ? 0.05 : 1e-4);
      const double change = std::abs(distance.at(a).distance_m - distance.at(b).distance_m);
      ASSERT_LE(change, (b - a).norm() + 1e-13) << a.transpose() << " to " << b.transpose();
    }
  }
}

// A point reaches the surface if it moves along the negative gradient by its signed distance. This follows
// from the definition of a distance.
TEST(MeshDistance, TheGradientLeadsToTheSurface) {
  for (const NamedMesh& shape : everything()) {
    SCOPED_TRACE(shape.name);
    const CleanMesh clean = cleaned(shape.mesh);
    // Inside a plate, or where parts overlap, the depth is not the distance to the outside.
    const bool depth_is_distance =
        clean.report.sheets == 0 && shape.name.find("overlapping") == std::string::npos;
    const MeshDistance distance(clean, 0.04);
    Random random(31);
    for (int k = 0; k < random_point_count(300); ++k) {
      const Vector3 a = point_about(random, shape.mesh, k);
      const DistanceSample sample = distance.at(a);
      ASSERT_NEAR(sample.gradient.norm(), 1.0, 1e-12);
      if (!depth_is_distance && sample.distance_m < 0.0) continue;
      const Vector3 foot = a - sample.distance_m * sample.gradient;
      ASSERT_NEAR(distance.at(foot).distance_m, 0.0, 1e-12) << a.transpose();
    }
  }
}

TEST(MeshDistance, ASheetIsAPlateOfItsThickness) {
  const MeshDistance distance(cleaned(sheet_mesh(5, 0.0)), 0.04);
  EXPECT_NEAR(distance.at({0.5, 0.5, 0.3}).distance_m, 0.28, 1e-15);
  EXPECT_NEAR(distance.at({0.5, 0.5, -0.3}).distance_m, 0.28, 1e-15);
  EXPECT_NEAR(distance.at({0.5, 0.5, 0.0}).distance_m, -0.02, 1e-15);
  EXPECT_NEAR(distance.at({1.5, 0.5, 0.0}).distance_m, 0.48, 1e-15);
  EXPECT_EQ(distance.bounds().low, Vector3(-0.02, -0.02, -0.02));
  EXPECT_EQ(distance.bounds().high, Vector3(1.02, 1.02, 0.02));
}

TEST(MeshDistance, AFilledHoleIsAsSolidAsTheRest) {
  const TriangleMesh ball = ball_mesh(12, 20, 0.9);
  const MeshDistance whole(cleaned(ball)), holed(cleaned(with_hole(ball)));
  Random random(6);
  for (int k = 0; k < random_point_count(500); ++k) {
    const Vector3 at = random_point(random, 1.2);
    // A fan of triangles closes the hole, which is one square of the ball mesh. The fan differs from the ball
    // by less than the ball bulges over the square.
    ASSERT_NEAR(holed.at(at).distance_m, whole.at(at).distance_m, 0.03);
  }
}

TEST(MeshDistance, WhatOverlapsIsOneBody) {
  const MeshDistance balls(
      cleaned(joined(ball_mesh(40, 80, 0.7, {0.4, 0, 0}), ball_mesh(40, 80, 0.7, {-0.4, 0, 0}))));
  EXPECT_NEAR(balls.at({0.0, 0.0, 0.0}).distance_m, -0.3, 2e-3);
  // The point is deep inside one ball. It is on the surface of the other ball, up to the error of the mesh.
  EXPECT_NEAR(balls.at({-0.3, 0.0, 0.0}).distance_m, -0.6, 2e-3);
  const MeshDistance spindle(cleaned(torus_mesh(60, 60, 0.4, 0.7)));
  // The surface winds around this point once in each orientation. The winding number is therefore 0, and the
  // point is outside.
  EXPECT_GT(spindle.at({0.0, 0.0, 0.0}).distance_m, 0.2);
  EXPECT_LT(spindle.at({0.5, 0.0, 0.0}).distance_m, -0.1);
  EXPECT_GT(spindle.at({0.0, 0.65, 0.0}).distance_m, 0.01);  // a point in the dimple of the spindle
  const MeshDistance crossing(cleaned(crossing_tube(60, 24)));
  // The surface winds around this point twice.
  EXPECT_NEAR(crossing.at({0.0, 0.0, 0.0}).distance_m, -0.2, 0.01);
  EXPECT_LT(crossing.at({1.0, 0.0, 0.0}).distance_m, -0.15);
  EXPECT_GT(crossing.at({0.6, 0.0, 0.0}).distance_m, 0.1);
}

TEST(MeshDistance, AHollowIsOutside) {
  const MeshDistance hollow(cleaned(joined(box_of_triangles({-1, -1, -1}, {1, 1, 1}),
                                           turned(box_of_triangles({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})))));
  EXPECT_NEAR(hollow.at({0, 0, 0}).distance_m, 0.5, 1e-15);
  EXPECT_NEAR(hollow.at({0.6, 0, 0}).distance_m, -0.1, 1e-15);
  EXPECT_NEAR(hollow.at({1.5, 0, 0}).distance_m, 0.5, 1e-15);
  EXPECT_FALSE(hollow.is_convex());
}

TEST(MeshDistance, KnowsWhatIsConvex) {
  TriangleMesh dented = box_of_triangles({-1, -1, -1}, {1, 1, 1});
  dented.vertices_m[7] = Vector3(0.999, 0.999, 0.999);
  const std::vector<std::pair<TriangleMesh, bool>> cases = {
      {box_of_triangles({-1, -1, -1}, {1, 1, 1}), true},
      {turned(soup(ball_mesh(12, 20, 0.9))), true},
      {dented, false},
      {torus_mesh(24, 12, 0.8, 0.35), false},
      {torus_mesh(24, 12, 0.4, 0.7), false},
      {sheet_mesh(3, 0.0), false},
      {joined(box_of_triangles({-1, -1, 0}, {0, 0, 1}), box_of_triangles({0, 0, 0}, {1, 1, 1})), false}};
  for (const auto& [mesh, convex] : cases) EXPECT_EQ(MeshDistance(cleaned(mesh)).is_convex(), convex);

  const TriangleMesh ball = ball_mesh(12, 20, 0.9);
  const MeshDistance distance(cleaned(ball));
  Random random(11);
  for (int k = 0; k < random_point_count(1000); ++k) {
    const Vector3 a = point_about(random, ball, k), b = random_point(random, 1.5);
    const DistanceSample sample = distance.at(a);
    // Some adjacent triangles of the ball are in one plane only up to rounding.
    ASSERT_LE(sample.distance_m + sample.gradient.dot(b - a), distance.at(b).distance_m + 1e-12);
  }
}

TEST(MeshDistance, TheWindingNumberIsThatOfAllTriangles) {
  for (const TriangleMesh& given : {torus_mesh(60, 40, 0.4, 0.7), ball_mesh(3, 400, 0.9)}) {
    TriangleMesh mesh = given;
    std::vector<Box> boxes;
    const auto bounding_box = [&](const TriangleCorners& t) {
      const Vector3 &a = mesh.vertices_m[t[0]], &b = mesh.vertices_m[t[1]], &c = mesh.vertices_m[t[2]];
      return Box{a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
    };
    for (const TriangleCorners& corners : mesh.triangles) boxes.push_back(bounding_box(corners));
    const BoxTree tree(boxes, 4);
    for (std::size_t k = 0; k < tree.order().size(); ++k)
      mesh.triangles[k] = given.triangles[tree.order()[k]];
    const WindingNumber winding(mesh.vertices_m, mesh.triangles, tree);
    Random random(2);
    for (int k = 0; k < random_point_count(400); ++k) {
      const Vector3 at = point_about(random, mesh, k);
      double sum = 0.0;
      for (const auto& [a, b, c] : mesh.triangles) {
        sum += solid_angle(mesh.vertices_m[a] - at, mesh.vertices_m[b] - at, mesh.vertices_m[c] - at);
      }
      ASSERT_NEAR(winding.at(at), sum / full_solid_angle, 0.1);
    }
  }
}

TEST(MeshDistance, AllocatesNothing) {
  for (const NamedMesh& shape : everything()) {
    const MeshDistance distance(cleaned(shape.mesh));
    Random random(1);
    double sum = 0.0;
    const std::size_t before = allocation_count();
    for (int k = 0; k < 100; ++k) sum += distance.at(random_point(random, 1.5)).distance_m;
    EXPECT_EQ(allocation_count(), before) << shape.name << sum;
  }
}

}  // namespace
}  // namespace spoonbill
