#include "engine/exchange/mesh_export/tessellation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/surface_check.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/exchange/cad/cad_surfaces.h"
#include "tests/engine/exchange/cad/kept_part.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

// Returns the number of edges that violate the rule for a closed mesh: two triangles use each edge, in
// opposite directions.
std::size_t unmatched_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[{corners[k], corners[(k + 1) % 3]}];
  }
  std::size_t unmatched = 0;
  for (const auto& [edge, count] : uses) {
    const auto back = uses.find({edge.second, edge.first});
    if (count != 1 || back == uses.end() || back->second != 1) ++unmatched;
  }
  return unmatched;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[corners[0]];
    area += 0.5 * (mesh.vertices_m[corners[1]] - a).cross(mesh.vertices_m[corners[2]] - a).norm();
  }
  return area;
}

double distance_to_triangle(const Vector3& from, const Vector3& a, const Vector3& b, const Vector3& c) {
  // The closest point on a triangle is found as in Ericson 2005, section 5.1.5.
  const Vector3 ab = b - a, ac = c - a, ap = from - a, bp = from - b, cp = from - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return ap.norm();
  if (d3 >= 0 && d4 <= d3) return bp.norm();
  if (d6 >= 0 && d5 <= d6) return cp.norm();
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (from - (a + d1 / (d1 - d3) * ab)).norm();
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (from - (a + d2 / (d2 - d6) * ac)).norm();
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return (from - (b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b))).norm();
  }
  const double sum = va + vb + vc;
  return (from - (a + vb / sum * ab + vc / sum * ac)).norm();
}

double distance_to_mesh(const Vector3& from, const TriangleMesh& mesh) {
  double least = 1e30;
  for (const TriangleCorners& corners : mesh.triangles) {
    least = std::min(least, distance_to_triangle(from, mesh.vertices_m[corners[0]],
                                                 mesh.vertices_m[corners[1]], mesh.vertices_m[corners[2]]));
  }
  return least;
}

TEST(Tessellation, NoPointOfTheSurfaceIsFartherThanTheChordError) {
  Random random(5);
  for (const KnownSurface& known : known_surfaces()) {
    SCOPED_TRACE(known.surface.name);
    const Surface& surface = known.surface.surface;
    const double chord_m = known.closes ? 5e-4 : 0.02;
    const auto found = tessellate(surface, {}, chord_m);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LE(found->chord_error_m, chord_m);
    double farthest = 0.0;
    for (int k = 0; k < 60; ++k) {
      const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
      const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
      farthest = std::max(farthest, distance_to_mesh(position(surface, u, v), found->mesh));
    }
    EXPECT_LE(farthest, chord_m);
    EXPECT_LE(farthest, found->chord_error_m);
  }
}

TEST(Tessellation, BodiesThatCloseAreWatertightWithNormalsOutward) {
  for (const KnownSurface& known : known_surfaces()) {
    SCOPED_TRACE(known.surface.name);
    const auto found = tessellate(known.surface.surface, {}, known.closes ? 5e-5 : 0.02);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->closed, known.closes);
    EXPECT_EQ(unmatched_edges(found->mesh) == 0, known.closes);
    if (!known.closes) continue;
    const double volume = std::abs(volume_by_quadrature_m3(known.surface.surface));
    const double area = area_by_quadrature_m2(known.surface.surface);
    // The volumes of the mesh and of the surface differ by at most the chord error times the area.
    EXPECT_NEAR(enclosed_volume_m3(found->mesh), volume, 5e-5 * area);
    EXPECT_GT(enclosed_volume_m3(found->mesh), 0.0);
  }
}

// The control points at a pole become one vertex of the mesh if their distances are within the tolerance of
// find_closing().
TEST(Tessellation, WhatACheckCallsClosedIsWatertight) {
  for (const double apart_m : {1e-8, 0.9 * closing_tolerance_m}) {
    SCOPED_TRACE(apart_m);
    Surface tube = ellipsoid_tube(10, 10);
    tube.net.set_point(3, 0, tube.net.point(3, 0) + Vector3(apart_m, 0, 0));
    ASSERT_EQ(find_closing(tube).closedness, Closedness::solid);
    const auto made = tessellate(tube, {}, 1e-4);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(made->closed);
    EXPECT_EQ(unmatched_edges(made->mesh), 0u);
  }
  Surface open = ellipsoid_tube(10, 10);
  open.net.set_point(3, 0, open.net.point(3, 0) + Vector3(10.0 * closing_tolerance_m, 0, 0));
  EXPECT_FALSE(tessellate(open, {}, 1e-4)->closed);
}

TEST(Tessellation, AFlatSheetTakesTwoTrianglesAPiece) {
  ControlNet net(2, 2);
  net.set_point(1, 0, {1, 0, 0});
  net.set_point(0, 1, {0, 1, 0});
  net.set_point(1, 1, {1, 1, 0});
  const KnotVector line = KnotVector::clamped_uniform(1, 2).value();
  const auto flat = tessellate(make_surface(line, line, net).value(), {}, 1e-6);
  ASSERT_TRUE(flat);
  EXPECT_EQ(flat->mesh.triangles.size(), 2u);
  EXPECT_EQ(flat->mesh.vertices_m.size(), 4u);

  // The two triangles of a saddle deviate from it by |P00 - P10 - P01 + P11| / 4. Halving the cells in each
  // direction divides this deviation by four.
  net.set_point(1, 1, {1, 1, 0.4});
  const auto saddle = tessellate(make_surface(line, line, net).value(), {}, 0.026);
  ASSERT_TRUE(saddle);
  EXPECT_EQ(saddle->mesh.triangles.size(), 8u);
  EXPECT_NEAR(saddle->chord_error_m, 0.025, 1e-12);
}

TEST(Tessellation, ATrimmedSurfaceStaysTrimmed) {
  // The shapes are a plate of 1 by 1 m with a hole of known area, and a tube with a hole across its seam.
  ControlNet net(2, 2);
  net.set_point(1, 0, {1, 0, 0});
  net.set_point(0, 1, {0, 1, 0});
  net.set_point(1, 1, {1, 1, 0});
  const KnotVector line = KnotVector::clamped_uniform(1, 2).value();
  const Surface plate = make_surface(line, line, net).value();
  const auto holed = tessellate(plate, {round_loop(line, line, {0.4, 0.5}, 0.3, 12, true)}, 1e-3);
  ASSERT_TRUE(holed) << holed.error().message;
  EXPECT_FALSE(holed->closed);
  // The polygon is within 1e-5 of the loop, whose length is less than 2.
  EXPECT_NEAR(area_of(holed->mesh), 1.0 - round_loop_area(0.3, 12), 2e-5);

  // The reported deviation of a disc cut out of the plate must cover its true deviation, which is more than 0
  // although the plate is flat.
  const TrimLoop round = round_loop(line, line, {0.5, 0.5}, 0.4, 12, false);
  const auto disc = tessellate(plate, {round}, 1e-3);
  ASSERT_TRUE(disc) << disc.error().message;
  double farthest = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double share = k / 2000.0, start = round.knots.domain_start();
    const Eigen::Vector2d at = position(round, start + share * (round.knots.domain_end() - start));
    farthest = std::max(farthest, distance_to_mesh(position(plate, at.x(), at.y()), disc->mesh));
  }
  EXPECT_GT(farthest, 1e-6);
  EXPECT_LE(farthest, disc->chord_error_m);

  const Surface tube = ellipsoid_tube(10, 10);
  const auto loop = round_loop(tube.u, tube.v, {0.98, 0.5}, 0.15, 12, true);
  const auto whole = tessellate(tube, {}, 2e-5), cut = tessellate(tube, {loop}, 2e-5);
  ASSERT_TRUE(whole);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_LE(cut->chord_error_m, 2e-5);
  // The mesh is open only along the loop of the hole: every other edge has two triangles.
  EXPECT_FALSE(cut->closed);
  EXPECT_GT(unmatched_edges(cut->mesh), 10u);
  EXPECT_LT(unmatched_edges(cut->mesh), cut->mesh.triangles.size() / 4);
  CadSurface part;
  part.surface = tube;
  part.trims = {loop};
  EXPECT_NEAR(area_of(cut->mesh), kept_area_m2(part), 5e-3 * area_of(cut->mesh));
  EXPECT_LT(area_of(cut->mesh), 0.99 * area_of(whole->mesh));
}

double lowest_triangle_m(const TriangleMesh& mesh) {
  double lowest = 1e30;
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                  &c = mesh.vertices_m[corners[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    lowest = std::min(lowest, longest > 0.0 ? (b - a).cross(c - a).norm() / longest : 0.0);
  }
  return lowest;
}

// At its left and right ends, the disc has corners whose heights differ only in their last bits.
TEST(Tessellation, NoTriangleIsWithoutArea) {
  constexpr double radius_m = 0.01;
  ControlNet net(2, 2);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) net.set_point(i, j, {radius_m * (2 * i - 1), radius_m * (2 * j - 1), 0});
  }
  const KnotVector line = KnotVector::open(1, {-10, -10, 10, 10}).value();
  const Surface plate = make_surface(line, line, net).value();
  std::vector<Eigen::Vector2d> corners;
  constexpr int count = 300;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    corners.emplace_back(10.0 * std::cos(angle), 10.0 * std::sin(angle));
  }
  const auto cut = tessellate(plate, {polygon_loop(line, line, corners)}, 2e-5);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_GT(lowest_triangle_m(cut->mesh), 1e-9);
  // Only the rim is open, and every vertex of the mesh is a corner of the rim.
  EXPECT_EQ(unmatched_edges(cut->mesh), cut->mesh.vertices_m.size());
  EXPECT_EQ(cut->mesh.triangles.size(), cut->mesh.vertices_m.size() - 2);
  EXPECT_NEAR(area_of(cut->mesh), std::numbers::pi * radius_m * radius_m, 1e-3 * area_of(cut->mesh));
}

// The hole is small, so that the sign of the enclosed volume still shows whether the normals point outwards.
TEST(Tessellation, NormalsOfATrimmedBodyAreOutward) {
  const Surface tube = ellipsoid_tube(10, 10);
  for (const Surface& surface : {tube, reversed(tube, Direction::u)}) {
    const auto loop = round_loop(surface.u, surface.v, {0.5, 0.5}, 0.1, 12, true);
    const auto cut = tessellate(surface, {loop}, 1e-4);
    ASSERT_TRUE(cut) << cut.error().message;
    EXPECT_FALSE(cut->closed);
    EXPECT_GT(enclosed_volume_m3(cut->mesh), 0.0);
  }
}

TEST(Tessellation, MoreTrianglesThanTheLimitAreRefused) {
  const auto found = tessellate(ellipsoid_tube(8, 8), {}, 1e-7, 1000);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::too_many);
}

TEST(Tessellation, StopsWhenAskedTo) {
  const auto stopped =
      tessellate(ellipsoid_tube(8, 8), {}, 1e-4, 1000000, Progress([](double) { return false; }));
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  EXPECT_TRUE(tessellate(ellipsoid_tube(8, 8), {}, 1e-4, 1000000, Progress([](double) { return true; })));
}

TEST(Tessellation, ACubeOfTetrahedraHasItsVolume) {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_NEAR(enclosed_volume_m3(mesh), 1.0 / 6.0, 1e-15);
}

}  // namespace
}  // namespace spoonbill
