#include "engine/collision/meshes/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/collision/meshes/mesh_parts.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

const Vector3 low(-0.01, -0.02, -0.03), high(0.01, 0.02, 0.03);

double volume(const CleanMesh& clean) {
  double sum = 0.0;
  for (const MeshPart& part : clean.parts) sum += part.closed ? signed_volume(clean.mesh, part) : 0.0;
  return sum;
}

TEST(TriangleMesh, ASoupOfTrianglesBecomesABox) {
  const CleanMesh clean = cleaned(soup(box_of_triangles(low, high)));
  EXPECT_EQ(clean.report.vertices_read, 36u);
  EXPECT_EQ(clean.report.triangles_read, 12u);
  EXPECT_EQ(clean.report.vertices_joined, 28u);
  EXPECT_EQ(clean.mesh.vertices_m.size(), 8u);
  EXPECT_EQ(clean.mesh.triangles.size(), 12u);
  ASSERT_EQ(clean.parts.size(), 1u);
  EXPECT_TRUE(clean.parts[0].closed);
  EXPECT_EQ(clean.report.open_edges + clean.report.branching_edges + clean.report.holes_filled, 0u);
  EXPECT_EQ(clean.report.triangles_flipped + clean.report.parts_flipped, 0u);
  EXPECT_LT((clean.report.size_m - (high - low)).norm(), 1e-15);
  EXPECT_NEAR(volume(clean), 0.02 * 0.04 * 0.06, 1e-17);
}

TEST(TriangleMesh, VerticesAHairApartAreOne) {
  Random random(3);
  TriangleMesh mesh = soup(ball_mesh(12, 24, 0.02));
  // The vertices move by less than the distance of 7e-8 m up to which vertices are joined.
  for (Vector3& vertex : mesh.vertices_m) vertex += random_point(random, 4e-9);
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.mesh.vertices_m.size(), 11u * 24u + 2u);
  EXPECT_EQ(clean.report.closed_parts, 1u);
  EXPECT_EQ(clean.report.open_edges, 0u);
}

TEST(TriangleMesh, InsideOutIsTurnedRound) {
  const CleanMesh clean = cleaned(turned(box_of_triangles(low, high)));
  EXPECT_EQ(clean.report.parts_flipped, 1u);
  EXPECT_EQ(clean.report.triangles_flipped, 0u);
  EXPECT_GT(volume(clean), 0.0);
}

TEST(TriangleMesh, TrianglesAgreeWithMostOfTheirPart) {
  Random random(8);
  TriangleMesh mesh = ball_mesh(10, 20, 0.02);
  std::size_t turned_round = 0;
  for (TriangleCorners& corners : mesh.triangles) {
    if (random.integer(0, 3) != 0) continue;
    std::swap(corners[1], corners[2]);
    ++turned_round;
  }
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.report.triangles_flipped, turned_round);
  EXPECT_EQ(clean.report.parts_flipped, 0u);
  EXPECT_NEAR(volume(clean), volume(cleaned(ball_mesh(10, 20, 0.02))), 1e-18);
}

TEST(TriangleMesh, WhatIsCleanIsCleanedIntoItself) {
  TriangleMesh mesh = ball_mesh(10, 20, 0.02);
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  std::swap(mesh.triangles[77][0], mesh.triangles[77][2]);
  mesh.triangles.erase(mesh.triangles.begin() + 120);
  for (const TriangleMesh& given : {mesh, turned(mesh), turned(box_of_triangles(low, high))}) {
    const CleanMesh once = cleaned(given), twice = cleaned(once.mesh);
    EXPECT_EQ(twice.mesh.triangles, once.mesh.triangles);
    EXPECT_EQ(twice.mesh.vertices_m, once.mesh.vertices_m);
  }
}

TEST(TriangleMesh, DegenerateAndRepeatedTrianglesAreDropped) {
  TriangleMesh mesh = box_of_triangles(low, high);
  mesh.vertices_m.emplace_back(0.5 * (mesh.vertices_m[0] + mesh.vertices_m[7]));
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 8, 7});          // three vertices on a line
  mesh.triangles.push_back(mesh.triangles[2]);  // a triangle repeated
  mesh.triangles.push_back({mesh.triangles[3][1], mesh.triangles[3][0], mesh.triangles[3][2]});
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.report.degenerate_dropped, 2u);
  EXPECT_EQ(clean.report.duplicates_dropped, 2u);
  EXPECT_EQ(clean.mesh.triangles.size(), 12u);
  EXPECT_EQ(clean.report.closed_parts, 1u);
}

TEST(TriangleMesh, TwoBoxesWithACommonEdgeAreTwoParts) {
  const TriangleMesh mesh =
      joined(box_of_triangles({0, 0, 0}, {1, 1, 1}), box_of_triangles({1, 1, 0}, {2, 2, 1}));
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.report.vertices_joined, 2u);
  EXPECT_EQ(clean.report.branching_edges, 1u);
  EXPECT_EQ(clean.report.closed_parts, 2u);
  EXPECT_NEAR(volume(clean), 2.0, 1e-15);
}

TEST(TriangleMesh, AMoebiusStripIsASheet) {
  const CleanMesh clean = cleaned(moebius_strip(40));
  EXPECT_EQ(clean.report.sheets, 1u);
  EXPECT_EQ(clean.report.closed_parts, 0u);
  EXPECT_EQ(clean.report.open_edges, 80u);
}

TEST(TriangleMesh, SmallHolesAreFilledAndLargeOnesMakeASheet) {
  const TriangleMesh ball = ball_mesh(20, 40, 0.02);
  const CleanMesh whole = cleaned(ball);
  // The missing triangles are in two squares that are not neighbours, so they leave two holes.
  const CleanMesh holes = cleaned(without(without(ball, 101, 2), 11, 2));
  EXPECT_EQ(holes.report.holes_filled, 2u);
  EXPECT_EQ(holes.report.open_edges, 8u);
  EXPECT_EQ(holes.report.closed_parts, 1u);
  EXPECT_NEAR(volume(holes), volume(whole), 1e-3 * volume(whole));
  // Each of the two holes was made by removing 2 triangles and is filled by 4.
  EXPECT_EQ(holes.mesh.triangles.size(), ball.triangles.size() + 4u);

  const CleanMesh half = cleaned(without(ball, 0, 760));
  EXPECT_EQ(half.report.sheets, 1u);
  EXPECT_EQ(half.report.holes_filled, 0u);
}

TEST(TriangleMesh, AFinOnASolidIsDropped) {
  TriangleMesh mesh = box_of_triangles({0, 0, 0}, {1, 1, 1});
  mesh.vertices_m.emplace_back(1.001, 1.001, 0.5);
  mesh.triangles.push_back({3, 7, 8});
  mesh.triangles.push_back({7, 3, 8});  // the same triangle with the opposite orientation
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.report.duplicates_dropped, 1u);
  EXPECT_EQ(clean.report.branching_edges, 1u);
  EXPECT_EQ(clean.report.specks_dropped, 1u);
  EXPECT_EQ(clean.report.closed_parts, 1u);
  EXPECT_EQ(clean.report.sheets, 0u);
  EXPECT_EQ(clean.mesh.vertices_m.size(), 8u);
}

// The top of a box has a vertex in the middle of one edge, and the side at this edge has none. The crack
// between them has no area and needs no triangle.
TEST(TriangleMesh, ACrackWithoutAreaLeavesABoxClosed) {
  TriangleMesh mesh = box_of_triangles({0, 0, 0}, {1, 1, 1});
  mesh.vertices_m.emplace_back(0.5, 1.0, 0.0);  // a vertex on the edge from vertex 2 to vertex 3
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriangleCorners corners = mesh.triangles[t];
    if (corners != TriangleCorners{2, 7, 3}) continue;
    mesh.triangles[t] = {2, 7, 8};
    mesh.triangles.push_back({8, 7, 3});
  }
  ASSERT_EQ(mesh.triangles.size(), 13u);
  const CleanMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.report.open_edges, 3u);
  EXPECT_EQ(clean.report.closed_parts, 1u);
  EXPECT_EQ(clean.mesh.triangles.size(), 13u);
}

TEST(TriangleMesh, ACavityStaysOneAndASolidInASolidIsNone) {
  const TriangleMesh outer = box_of_triangles({0, 0, 0}, {1, 1, 1});
  const TriangleMesh inner = box_of_triangles({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8});
  const CleanMesh hollow = cleaned(joined(turned(inner), outer));
  EXPECT_EQ(hollow.report.cavities, 1u);
  EXPECT_EQ(hollow.report.closed_parts, 1u);
  EXPECT_EQ(hollow.report.parts_flipped, 0u);
  EXPECT_NEAR(volume(hollow), 1.0 - 0.216, 1e-15);

  const CleanMesh inside_out = cleaned(turned(joined(turned(inner), outer)));
  EXPECT_EQ(inside_out.report.cavities, 1u);
  EXPECT_EQ(inside_out.report.parts_flipped, 2u);
  EXPECT_NEAR(volume(inside_out), 1.0 - 0.216, 1e-15);

  const CleanMesh both = cleaned(joined(inner, outer));
  EXPECT_EQ(both.report.cavities, 0u);
  EXPECT_EQ(both.report.closed_parts, 2u);

  // Two boxes are beside each other. The one that is inside out gets the opposite orientation.
  const CleanMesh beside = cleaned(joined(turned(box_of_triangles({2, 0, 0}, {2.5, 0.5, 0.5})), outer));
  EXPECT_EQ(beside.report.cavities, 0u);
  EXPECT_EQ(beside.report.parts_flipped, 1u);
}

void expect_refusal(const TriangleMesh& mesh, ErrorCode code, std::size_t limit = 100) {
  const auto clean = clean_mesh(mesh, "tool.stl", limit);
  ASSERT_FALSE(clean);
  EXPECT_TRUE(clean.error().message.starts_with("tool.stl: ")) << clean.error().message;
  EXPECT_EQ(clean.error().code, code) << clean.error().message;
  EXPECT_EQ(clean.error().message.find('\n'), std::string::npos);
}

TEST(TriangleMesh, RefusesWhatIsNoTool) {
  const TriangleMesh box = box_of_triangles(low, high);
  expect_refusal({}, ErrorCode::too_few);
  expect_refusal(box, ErrorCode::too_many, 11);
  TriangleMesh bad = box;
  bad.vertices_m[3].y() = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(bad, ErrorCode::out_of_range);
  bad.vertices_m[3].y() = -std::numeric_limits<double>::infinity();
  expect_refusal(bad, ErrorCode::out_of_range);
  bad.vertices_m[3].y() = 101.0;
  expect_refusal(bad, ErrorCode::out_of_range);
  bad = box;
  bad.triangles[5][2] = 8;
  expect_refusal(bad, ErrorCode::malformed);
  bad = box;
  for (Vector3& vertex : bad.vertices_m) vertex = Vector3(1, 2, 3);
  expect_refusal(bad, ErrorCode::degenerate);
  for (std::size_t k = 0; k < 8; ++k) bad.vertices_m[k] = Vector3(0.1 * static_cast<double>(k), 0, 0);
  expect_refusal(bad, ErrorCode::degenerate);
}

}  // namespace
}  // namespace spoonbill
