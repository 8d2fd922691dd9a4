#include "engine/collision/rigid/mesh_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/collision/meshes/triangle.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

constexpr double half_plate_m = 0.5 * sheet_thickness_m;

// segments_apart(), pierces(), corner_apart() and triangles_apart() compute the exact distance of two
// triangles. If the triangles do not cross, the nearest points are on a corner and a face, or on two sides.
double segments_apart(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 ab = b - a, cd = d - c;
  double least = 1e300;
  const auto at = [](double share) { return std::clamp(share, 0.0, 1.0); };
  for (const Vector3& end : {a, b}) {
    least = std::min(least, (c + at((end - c).dot(cd) / cd.squaredNorm()) * cd - end).norm());
  }
  for (const Vector3& end : {c, d}) {
    least = std::min(least, (a + at((end - a).dot(ab) / ab.squaredNorm()) * ab - end).norm());
  }
  const Vector3 across = ab.cross(cd), offset = c - a;
  if (across.squaredNorm() == 0.0) return least;
  const double along_ab = offset.cross(cd).dot(across) / across.squaredNorm();
  const double along_cd = offset.cross(ab).dot(across) / across.squaredNorm();
  if (along_ab < 0.0 || along_ab > 1.0 || along_cd < 0.0 || along_cd > 1.0) return least;
  return std::min(least, (c + along_cd * cd - a - along_ab * ab).norm());
}

bool pierces(const Vector3& from, const Vector3& to, const Triangle& triangle) {
  Eigen::Matrix3d columns;
  columns << triangle[1] - triangle[0], triangle[2] - triangle[0], from - to;
  if (columns.determinant() == 0.0) return false;
  const Vector3 at = columns.inverse() * (from - triangle[0]);
  return at.minCoeff() >= 0.0 && at.x() + at.y() <= 1.0 && at.z() <= 1.0;
}

double corner_apart(const Vector3& corner, const Triangle& triangle) {
  const TriangleMesh alone{{triangle[0], triangle[1], triangle[2]}, {{0, 1, 2}}};
  return brute_distance(alone, corner);
}

double triangles_apart(const Triangle& a, const Triangle& b) {
  double least = 1e300;
  for (int i = 0; i < 3; ++i) {
    if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return 0.0;
    least = std::min({least, corner_apart(a[i], b), corner_apart(b[i], a)});
    for (int j = 0; j < 3; ++j) {
      least = std::min(least, segments_apart(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
    }
  }
  return least;
}

Triangle triangle_of(const TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]};
}

double grown_of(const CleanMesh& mesh, std::size_t t) {
  for (const MeshPart& part : mesh.parts) {
    if (t >= part.first_triangle && t < part.end_triangle) return part.closed ? 0.0 : half_plate_m;
  }
  return 0.0;
}

// Computes the distance between two meshes from all pairs of triangles. It is negative if plates overlap.
double brute_gap(const CleanMesh& a, const CleanMesh& b) {
  double least = 1e300;
  for (std::size_t s = 0; s < a.mesh.triangles.size(); ++s) {
    const Triangle one = triangle_of(a.mesh, s);
    const Box box = bounding_box(one);
    for (std::size_t t = 0; t < b.mesh.triangles.size(); ++t) {
      const Triangle other = triangle_of(b.mesh, t);
      const double grown = grown_of(a, s) + grown_of(b, t);
      if (box.gap(bounding_box(other)) - grown >= least) continue;
      least = std::min(least, triangles_apart(one, other) - grown);
    }
  }
  return least;
}

TriangleMesh closed_part(const CleanMesh& mesh) {
  TriangleMesh closed{mesh.mesh.vertices_m, {}};
  for (const MeshPart& part : mesh.parts) {
    if (!part.closed) continue;
    closed.triangles.insert(closed.triangles.end(), mesh.mesh.triangles.begin() + part.first_triangle,
                            mesh.mesh.triangles.begin() + part.end_triangle);
  }
  return closed;
}

// Returns the depth of the deepest vertex of `of` in the closed part of `in`; 0 if no vertex is inside. An
// open sheet counts as a plate, so half the thickness of the plate is added to the depth of its vertices.
double brute_depth(const CleanMesh& of, const CleanMesh& in, Random& random) {
  const TriangleMesh closed = closed_part(in);
  if (closed.triangles.empty()) return 0.0;
  double deepest = 0.0;
  for (const MeshPart& part : of.parts) {
    for (std::uint32_t v = part.first_vertex; v < part.end_vertex; ++v) {
      const Vector3& vertex = of.mesh.vertices_m[v];
      if (!brute_inside(closed, vertex, random)) continue;
      deepest = std::max(deepest, brute_distance(closed, vertex) + (part.closed ? 0.0 : half_plate_m));
    }
  }
  return deepest;
}

CleanMesh posed(CleanMesh mesh, const Pose& pose) {
  for (Vector3& vertex : mesh.mesh.vertices_m) vertex = pose.orientation * vertex + pose.position_m;
  return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, double scale) {
  for (Vector3& vertex : mesh.vertices_m) vertex *= scale;
  return mesh;
}

// Returns a shape of about a metre: a solid, a shell around a hollow, an open sheet, or a solid beside a
// sheet.
TriangleMesh random_shape(Random& random) {
  switch (random.integer(0, 5)) {
    case 0:
      return box_of_triangles({-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3});
    case 1:
      return ball_mesh(6, 9, 0.6);
    case 2:
      return torus_mesh(9, 6, 0.6, 0.2);
    case 3:
      return scaled(sheet_mesh(4, 0.4), 1.2);
    case 4:
      return joined(ball_mesh(6, 8, 0.6), turned(ball_mesh(5, 7, 0.4)));
    default:
      return joined(box_of_triangles({-0.9, -0.3, -0.3}, {-0.3, 0.3, 0.3}), scaled(sheet_mesh(3, 0.3), 0.7));
  }
}

Pose random_pose(Random& random, double extent_m) {
  Pose pose;
  pose.position_m = random_point(random, extent_m);
  pose.orientation =
      Quaternion(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1))
          .normalized();
  return pose;
}

Pose at(double x, double y, double z) {
  Pose pose;
  pose.position_m = {x, y, z};
  return pose;
}

void expect_sound(const MeshPairResult& result, const CleanMesh& first, const CleanMesh& second) {
  ASSERT_EQ(result.touching, !result.contacts.empty());
  EXPECT_TRUE(result.complete);
  double last = 1e300;
  for (const MeshPairContact& contact : result.contacts) {
    EXPECT_LE(contact.depth_m, last);
    last = contact.depth_m;
    EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-9);
    // The vector from the first to the second point of a contact is along its normal and at most as long as
    // the depth. It is shorter than the depth if one mesh is completely inside the other.
    const Vector3 apart = contact.second_m - contact.first_m;
    EXPECT_LT(apart.cross(contact.normal).norm(), 2e-6);
    EXPECT_LT(apart.dot(contact.normal), contact.depth_m + 2e-6);
    // At least one of the two points is on the surface of its own mesh, or within half a plate's thickness of
    // this surface.
    EXPECT_LT(
        std::min(brute_distance(first.mesh, contact.first_m), brute_distance(second.mesh, contact.second_m)),
        half_plate_m + 1e-9);
  }
}

TEST(MeshPair, TwoHundredRandomPairsAreAsExactDistancesSay) {
  Random random(31);
  int touching = 0, contained = 0, apart = 0;
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE("pair " + std::to_string(k));
    const bool small = k % 4 == 0;
    const CleanMesh first = cleaned(random_shape(random));
    const CleanMesh second = cleaned(scaled(random_shape(random), small ? 0.15 : 1.0));
    const Pose pose = random_pose(random, small ? 0.4 : 1.3);
    const MeshPairResult result = collide_meshes(first, second, pose);
    const CleanMesh there = posed(second, pose);
    const double gap = brute_gap(first, there);
    const double depth = std::max(brute_depth(first, there, random), brute_depth(there, first, random));
    ASSERT_EQ(result.touching, gap <= 0.0 || depth > 0.0);
    ASSERT_EQ(result.contained, gap > 0.0 && depth > 0.0);
    expect_sound(result, first, there);
    touching += result.touching ? 1 : 0;
    contained += result.contained ? 1 : 0;
    if (result.touching) {
      EXPECT_GE(result.contacts.front().depth_m, depth - 1e-9);
      continue;
    }
    ++apart;
    EXPECT_NEAR(result.distance_m, gap, 1e-12);
    EXPECT_NEAR((result.nearest_second_m - result.nearest_first_m).norm(), gap, 1e-12);
    EXPECT_LT(brute_distance(first.mesh, result.nearest_first_m), half_plate_m + 1e-12);
    EXPECT_LT(brute_distance(there.mesh, result.nearest_second_m), half_plate_m + 1e-12);
  }
  EXPECT_GT(touching - contained, 40);
  EXPECT_GE(contained, 10);
  EXPECT_GT(apart, 40);
}

// FCL's triangle distance ignores faces whose normal is shorter than an absolute length.
TEST(MeshPair, SmallTrianglesAreNotForgotten) {
  for (const double scale : {1.0, 1e-3, 1e-5}) {
    SCOPED_TRACE(scale);
    const CleanMesh plane = cleaned(scaled(box_of_triangles({-1, -1, -1}, {1, 0, 1}), scale));
    // The lower pole of the ball points down onto the inside of a triangle.
    const CleanMesh tip = cleaned(scaled(ball_mesh(6, 9, 0.5), scale));
    const MeshPairResult result = collide_meshes(plane, tip, at(0.3 * scale, 0.8 * scale, 0.1 * scale));
    EXPECT_FALSE(result.touching);
    EXPECT_NEAR(result.distance_m, 0.3 * scale, 1e-9 * scale);
    EXPECT_LT((result.nearest_first_m - scale * Vector3(0.3, 0.0, 0.1)).norm(), 1e-9 * scale);
  }
}

TEST(MeshPair, BallsAreAsDeepAsTheirRadiiOverlap) {
  const CleanMesh ball = cleaned(ball_mesh(60, 120, 0.5));
  const double flatter = 0.5 * (1.0 - std::cos(3.15 / 60));
  const MeshPairResult apart = collide_meshes(ball, ball, at(0.0, 1.2, 0.0));
  EXPECT_NEAR(apart.distance_m, 0.2, 1e-12);  // the poles of the balls face each other
  const MeshPairResult deep = collide_meshes(ball, ball, at(0.7, 0.4, 0.5));
  ASSERT_EQ(deep.contacts.size(), 1U);
  EXPECT_FALSE(deep.contained);
  EXPECT_NEAR(deep.contacts[0].depth_m, 1.0 - Vector3(0.7, 0.4, 0.5).norm(), 2.0 * flatter);
  EXPECT_GT(-deep.contacts[0].normal.dot(Vector3(0.7, 0.4, 0.5).normalized()), 0.99);
}

TEST(MeshPair, CubesAreAsDeepAsTheirFacesOverlap) {
  const CleanMesh cube = cleaned(box_of_triangles({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
  EXPECT_NEAR(collide_meshes(cube, cube, at(1.25, 0.1, 0.2)).distance_m, 0.25, 1e-12);
  EXPECT_NEAR(collide_meshes(cube, cube, at(1.3, 1.4, 0.0)).distance_m, 0.5, 1e-12);

  // Each face of a cube consists of two triangles, and its deepest points are on the diagonal between them.
  const MeshPairResult deep = collide_meshes(cube, cube, at(0.9, 0.05, 0.05));
  ASSERT_EQ(deep.contacts.size(), 1U);
  EXPECT_NEAR(deep.contacts[0].depth_m, 0.1, 1e-9);
  EXPECT_NEAR(deep.contacts[0].normal.x(), -1.0, 1e-9);

  // Two edges cross near x = 0.5 sqrt 2. The cubes are turned so that no corner of one is inside the other.
  const double reach = std::sqrt(0.5);
  Pose edge = at(2.0 * reach - 0.02, 0.0, 0.0);
  const Quaternion upright(Eigen::AngleAxisd(M_PI / 4.0, Vector3::UnitZ()));
  const Quaternion lying(Eigen::AngleAxisd(M_PI / 4.0, Vector3::UnitY()));
  CleanMesh one = cube;
  for (Vector3& vertex : one.mesh.vertices_m) vertex = upright * vertex;
  edge.orientation = lying;
  const MeshPairResult crossing = collide_meshes(one, cube, edge);
  ASSERT_EQ(crossing.contacts.size(), 1U);
  // An edge that is 0.02 behind another edge is 0.02 cos 45 degrees behind each of the two faces that meet at
  // the other edge.
  EXPECT_NEAR(crossing.contacts[0].depth_m, 0.02 * std::sqrt(0.5), 1e-9);
}

TEST(MeshPair, ABarThroughABallIsFoundByItsEdges) {
  const CleanMesh ball = cleaned(ball_mesh(40, 80, 0.5));
  const CleanMesh bar = cleaned(box_of_triangles({-2.0, 0.3, -0.01}, {2.0, 1.3, 0.01}));
  // No corner of the bar is inside the ball. Corners of the ball are inside the bar, but less deep than the
  // bar's edge is in the ball.
  const MeshPairResult result = collide_meshes(bar, ball, Pose());
  ASSERT_EQ(result.contacts.size(), 1U);
  const double flatter = 0.5 * (1.0 - std::cos(3.15 / 40));
  EXPECT_NEAR(result.contacts[0].depth_m, 0.2, 2.0 * flatter);
}

TEST(MeshPair, ThoseThatAreFlushTouch) {
  const CleanMesh cube = cleaned(box_of_triangles({0.1, 0.1, 0.1}, {0.4, 0.4, 0.4}));
  for (const double x : {0.3, 0.3 + 1e-16, 0.4 - 0.1, 0.3 + 5e-7, 0.3 - 5e-7}) {
    const MeshPairResult result = collide_meshes(cube, cube, at(x, 0.0, 0.0));
    EXPECT_TRUE(result.touching) << x;
    EXPECT_FALSE(result.contained);
    ASSERT_EQ(result.contacts.size(), 1U);
    EXPECT_NEAR(result.contacts[0].depth_m, 0.0, 1e-6);
  }
}

TEST(MeshPair, OneInsideTheOtherLeavesThroughTheNearestWall) {
  const CleanMesh room = cleaned(box_of_triangles({-1, -1, -1}, {1, 1, 1}));
  const CleanMesh small = cleaned(box_of_triangles({-0.1, -0.2, -0.3}, {0.1, 0.2, 0.3}));
  const Pose pose = at(0.2, 0.0, -0.6);
  const MeshPairResult inside = collide_meshes(room, small, pose);
  EXPECT_TRUE(inside.touching);
  EXPECT_TRUE(inside.contained);
  ASSERT_EQ(inside.contacts.size(), 1U);
  EXPECT_NEAR(inside.contacts[0].depth_m, 0.1 + 0.6, 1e-12);
  EXPECT_NEAR(inside.contacts[0].normal.z(), 1.0, 1e-12);  // the room around the body moves up

  CleanMesh there = posed(small, pose);
  const MeshPairResult around = collide_meshes(there, room, Pose());
  EXPECT_TRUE(around.contained);
  EXPECT_NEAR(around.contacts[0].depth_m, 0.7, 1e-12);
  EXPECT_NEAR(around.contacts[0].normal.z(), -1.0, 1e-12);

  // A body inside a hollow is outside the solid.
  const CleanMesh hollow = cleaned(
      joined(box_of_triangles({-2, -2, -2}, {2, 2, 2}), turned(box_of_triangles({-1, -1, -1}, {1, 1, 1}))));
  const MeshPairResult free = collide_meshes(hollow, small, pose);
  EXPECT_FALSE(free.touching);
  EXPECT_NEAR(free.distance_m, 0.1, 1e-12);

  // One part is inside the box, and another is outside and nearer to the wall.
  const CleanMesh two = cleaned(joined(box_of_triangles({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}),
                                       box_of_triangles({1.01, 0.0, 0.0}, {1.2, 0.1, 0.1})));
  const MeshPairResult half = collide_meshes(room, two, Pose());
  EXPECT_TRUE(half.contained);
  EXPECT_NEAR(half.contacts[0].depth_m, 0.9 + 0.2, 1e-12);
}

TEST(MeshPair, SheetsArePlates) {
  const CleanMesh sheet = cleaned(scaled(sheet_mesh(4, 0.0), 0.1));
  EXPECT_NEAR(collide_meshes(sheet, sheet, at(0.0, 0.0, 3e-3)).distance_m, 2e-3, 1e-12);
  const MeshPairResult near = collide_meshes(sheet, sheet, at(0.0, 0.0, 0.4e-3));
  ASSERT_EQ(near.contacts.size(), 1U);
  EXPECT_NEAR(near.contacts[0].depth_m, 0.6e-3, 1e-9);
  EXPECT_NEAR(std::abs(near.contacts[0].normal.z()), 1.0, 1e-9);

  const CleanMesh ball = cleaned(ball_mesh(40, 80, 0.02));
  Pose over = at(0.05, 0.05, 0.0202);
  over.orientation = Quaternion(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitX()));  // turns a pole downwards
  const MeshPairResult resting = collide_meshes(sheet, ball, over);
  ASSERT_EQ(resting.contacts.size(), 1U);
  EXPECT_NEAR(resting.contacts[0].depth_m, 0.3e-3, 1e-9);
  EXPECT_NEAR(resting.contacts[0].normal.z(), -1.0, 1e-6);
}

TEST(MeshPair, EachRegionIsAContact) {
  // Two tines reach into the block, by 0.01 and by 0.02.
  const CleanMesh tines = cleaned(joined(box_of_triangles({0.0, -0.01, 0.0}, {0.01, 0.1, 0.01}),
                                         box_of_triangles({0.05, -0.02, 0.0}, {0.06, 0.1, 0.01})));
  const CleanMesh block = cleaned(box_of_triangles({-1, -1, -1}, {1, 0, 1}));
  const MeshPairResult result = collide_meshes(tines, block, Pose());
  ASSERT_EQ(result.contacts.size(), 2U);
  EXPECT_NEAR(result.contacts[0].depth_m, 0.02, 1e-9);
  EXPECT_NEAR(result.contacts[1].depth_m, 0.01, 1e-9);
  EXPECT_NEAR(result.contacts[0].normal.y(), 1.0, 1e-9);
}

TEST(MeshPair, NeedlesAndSliversAreTriangles) {
  TriangleMesh needles = ball_mesh(8, 12, 0.5);
  needles.triangles.push_back({0, 1, 1});
  needles.vertices_m.push_back(0.5 * (needles.vertices_m[0] + needles.vertices_m[1]));
  needles.triangles.push_back({0, static_cast<std::uint32_t>(needles.vertices_m.size()) - 1, 1});
  needles.vertices_m.emplace_back(0.9, 0.0, 0.0);
  const auto far = static_cast<std::uint32_t>(needles.vertices_m.size()) - 1;
  needles.vertices_m.emplace_back(0.9, 1e-7, 0.0);
  needles.vertices_m.emplace_back(1.4, 0.0, 0.0);
  needles.triangles.push_back({far, far + 1, far + 2});
  const CleanMesh mesh = cleaned(needles), cube = cleaned(box_of_triangles({2, -1, -1}, {3, 1, 1}));
  EXPECT_NEAR(collide_meshes(mesh, cube, Pose()).distance_m, brute_gap(mesh, cube), 1e-9);
}

}  // namespace
}  // namespace spoonbill
