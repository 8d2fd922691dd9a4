#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/render/sample_scene.h"
#include "tests/render/tessellated.h"

namespace spoonbill {
namespace {

// Merges vertices whose coordinates are equal after rounding to a tenth of a micrometre, because a pole is a
// row of vertices in one position.
std::vector<std::uint32_t> merged_by_place(const TessellatedSurface& surface) {
  std::map<std::tuple<long, long, long>, std::uint32_t> places;
  const auto rounded = [](float metres) { return std::lround(metres / 1e-7); };
  std::vector<std::uint32_t> merged(surface.vertex_count());
  const auto& s = surface.samples();
  for (std::uint32_t i = 0; i < merged.size(); ++i) {
    merged[i] = places.try_emplace({rounded(s.x[i]), rounded(s.y[i]), rounded(s.z[i])}, i).first->second;
  }
  return merged;
}

std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed_edges(const TessellatedSurface& surface) {
  const auto place = merged_by_place(surface);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t t = 0; t + 2 < surface.indices().size(); t += 3) {
    const std::uint32_t corner[3] = {place[surface.indices()[t]], place[surface.indices()[t + 1]],
                                     place[surface.indices()[t + 2]]};
    const bool collapsed = corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
    if (collapsed) continue;
    for (int i = 0; i < 3; ++i) ++edges[{corner[i], corner[(i + 1) % 3]}];
  }
  return edges;
}

TEST(Tessellation, ATubeWithPolesIsWatertight) {
  const auto surface = tessellated(sample_scene({.bend_rad = 0.5}).bodies[0].surface, 6000.0);
  EXPECT_TRUE(surface.is_closed());
  const auto edges = directed_edges(surface);
  ASSERT_GT(edges.size(), 1000u);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first})) << "an edge with a triangle on one side only";
  }
}

TEST(Tessellation, NormalsAreOutwardAndAgreeWithTheTriangles) {
  for (const bool mirrored : {false, true}) {
    SurfaceSnapshot snapshot = sample_scene().bodies[0].surface;
    if (mirrored) {
      for (float& z : snapshot.z) z = -z;
    }
    const auto surface = tessellated(snapshot, 6000.0);
    const Vector3 axis_middle(0.05, 0.0025, 0.0);
    for (std::size_t t = 0; t + 2 < surface.indices().size(); t += 3) {
      const std::uint32_t* corner = surface.indices().data() + t;
      const Vector3 a = vertex(surface, corner[0]), b = vertex(surface, corner[1]),
                    c = vertex(surface, corner[2]);
      const Vector3 face = (b - a).cross(c - a);
      // Slivers at a pole are skipped: their area is as small as the rounding error of single precision.
      if (face.norm() < 1e-10) continue;
      const auto& s = surface.samples();
      const Vector3 normal(s.nx[corner[0]], s.ny[corner[0]], s.nz[corner[0]]);
      ASSERT_NEAR(normal.norm(), 1.0, 1e-4);
      ASSERT_GT(normal.dot(face.normalized()), 0.0);
      ASSERT_GT(face.dot(a - axis_middle), 0.0) << "a convex body's faces look away from its middle";
    }
  }
}

TEST(Tessellation, ChordsStayWithinTheTarget) {
  const SurfaceSnapshot snapshot = sample_scene({.bend_rad = 0.6}).bodies[0].surface;
  const double pixels_per_metre = 6000.0;
  const SamplingTarget target;
  const auto surface = tessellated(snapshot, pixels_per_metre);
  Surface exact{snapshot.u, snapshot.v,
                ControlNet(snapshot.u.control_point_count(), snapshot.v.control_point_count())};
  std::copy(snapshot.x.begin(), snapshot.x.end(), exact.net.x.begin());
  std::copy(snapshot.y.begin(), snapshot.y.end(), exact.net.y.begin());
  std::copy(snapshot.z.begin(), snapshot.z.end(), exact.net.z.begin());
  const auto u = drawing_parameters(snapshot.u, surface.level().u_pieces);
  const auto v = drawing_parameters(snapshot.v, surface.level().v_pieces);
  ASSERT_EQ(u.size() * v.size(), surface.vertex_count());
  double worst_px = 0.0;
  for (const double row : u) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const Vector3 a = evaluate(exact, row, v[j]).position_m, b = evaluate(exact, row, v[j + 1]).position_m;
      const Vector3 middle = evaluate(exact, row, 0.5 * (v[j] + v[j + 1])).position_m;
      const Vector3 way = (b - a).norm() > 0.0 ? Vector3((b - a).normalized()) : Vector3::Zero();
      const Vector3 off = (middle - a) - way * way.dot(middle - a);
      worst_px = std::max(worst_px, off.norm() * pixels_per_metre);
    }
  }
  EXPECT_LT(worst_px, 2.0 * target.largest_sagitta_px);
}

TEST(Tessellation, RebuildsOnlyWhenKnotsOrLevelChange) {
  SurfaceSnapshot snapshot = sample_scene().bodies[0].surface;
  TessellatedSurface surface;
  const SamplingLevel level = choose_sampling_level(snapshot, 6000.0, {});
  ASSERT_TRUE(surface.update(snapshot, level).ok());
  const auto version = surface.topology_version();
  for (float& y : snapshot.y) y += 0.001f;
  ASSERT_TRUE(surface.update(snapshot, level).ok());
  EXPECT_EQ(surface.topology_version(), version);
  ASSERT_TRUE(surface.update(snapshot, uniform_sampling_level(snapshot, 2)).ok());
  EXPECT_EQ(surface.topology_version(), version + 1);
}

TEST(Tessellation, TheLevelFollowsTheScreenButNotEveryPixel) {
  const SurfaceSnapshot snapshot = sample_scene().bodies[0].surface;
  const SamplingLevel far = choose_sampling_level(snapshot, 1000.0, {});
  const SamplingLevel near = choose_sampling_level(snapshot, 40000.0, {});
  const auto cells = [](const std::vector<int>& pieces) {
    return std::accumulate(pieces.begin(), pieces.end(), 0);
  };
  EXPECT_GT(cells(near.u_pieces), 2 * cells(far.u_pieces));
  EXPECT_GT(cells(near.v_pieces), 2 * cells(far.v_pieces));

  // A zoom that varies by a few percent settles on one level.
  SamplingLevel level = choose_sampling_level(snapshot, 6000.0, {});
  level = choose_sampling_level(snapshot, 6300.0, level);
  const SamplingLevel settled = level;
  for (const double pixels_per_metre : {6000.0, 6300.0, 6100.0, 6250.0}) {
    level = choose_sampling_level(snapshot, pixels_per_metre, level);
    EXPECT_EQ(level, settled);
  }
}

// A sheet 1 m wide with 100 x 100 control points is looked at from a few millimetres away.
TEST(Tessellation, NoMoreCellsAreAskedForThanCanBeDrawn) {
  constexpr int points = 100;
  SurfaceSnapshot sheet;
  sheet.u = sheet.v = KnotVector::clamped_uniform(3, points).value();
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points; ++j) {
      sheet.x.push_back(static_cast<float>(i) / points);
      sheet.y.push_back(0.001F * static_cast<float>((i + j) % 2));
      sheet.z.push_back(static_cast<float>(j) / points);
    }
  }
  const auto cells = [](const SamplingLevel& level) {
    return std::accumulate(level.u_pieces.begin(), level.u_pieces.end(), std::int64_t{0}) *
           std::accumulate(level.v_pieces.begin(), level.v_pieces.end(), std::int64_t{0});
  };
  const SamplingLevel level = choose_sampling_level(sheet, 1e6, {});
  EXPECT_LE(cells(level), sampling_cell_limit);
  EXPECT_GT(cells(level), sampling_cell_limit / 4);
  EXPECT_EQ(choose_sampling_level(sheet, 1e6, level), level);
}

TEST(Tessellation, AnOpenSheetKeepsItsEdges) {
  ControlNet net(5, 4);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) net.set_point(i, j, {0.01 * i, 0.0, 0.01 * j});
  }
  SurfaceSnapshot sheet{
      KnotVector::clamped_uniform(3, 5).value(), KnotVector::clamped_uniform(2, 4).value(), 1, {}, {}, {}};
  sheet.x.assign(net.x.begin(), net.x.end());
  sheet.y.assign(net.y.begin(), net.y.end());
  sheet.z.assign(net.z.begin(), net.z.end());
  const auto surface = tessellated(sheet, 5000.0);
  EXPECT_FALSE(surface.is_closed());
  const Box box = surface.bounds();
  EXPECT_NEAR(box.high.x(), 0.04, 1e-7);
  EXPECT_NEAR(box.high.z(), 0.03, 1e-7);
}

TEST(Tessellation, ANetThatDoesNotFitItsKnotsIsRefused) {
  SurfaceSnapshot snapshot = sample_scene().bodies[0].surface;
  const SamplingLevel level = choose_sampling_level(snapshot, 6000.0, {});
  snapshot.x.pop_back();
  TessellatedSurface surface;
  EXPECT_FALSE(surface.update(snapshot, level).ok());
}

TEST(DrawnBounds, AreThoseOfTheSurfaceNotOfItsNet) {
  const Snapshot snapshot = sample_scene();
  const Box box = drawn_bounds(snapshot);
  EXPECT_NEAR(box.high.x() - box.low.x(), 0.100, 1e-4);
  EXPECT_GT(
      box.low.y(),
      *std::min_element(snapshot.bodies[0].surface.y.begin(), snapshot.bodies[0].surface.y.end()) + 1e-6);
}

}  // namespace
}  // namespace spoonbill
