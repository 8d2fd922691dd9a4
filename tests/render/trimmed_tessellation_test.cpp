#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/engine/trims/loops.h"
#include "tests/render/sample_scene.h"
#include "tests/render/tessellated.h"

namespace spoonbill {
namespace {

// Returns the area outside a clockwise circular hole, whose radius is a fifth of the domain. The centre of
// the hole is at the fraction `turns` of the domain along u and at half of it along v. If `turns` is near 0,
// the hole crosses the seam.
std::shared_ptr<const TrimmedArea> hole_in(const SurfaceSnapshot& surface, double turns) {
  const double u = surface.u.domain_start(), u_length = surface.u.domain_end() - u;
  const double v = surface.v.domain_start(), v_length = surface.v.domain_end() - v;
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < 60; ++k) {
    const double angle = -2.0 * std::numbers::pi * k / 60;
    points.emplace_back(u + (turns + 0.2 * std::cos(angle)) * u_length,
                        v + (0.5 + 0.2 * std::sin(angle)) * v_length);
  }
  const TrimLoop loop = make_polygon_loop(surface.u, surface.v, points).value();
  return std::make_shared<const TrimmedArea>(TrimmedArea::make(surface.u, surface.v, {loop}).value());
}

double area_m2(const TessellatedSurface& surface) {
  double area = 0.0;
  for (std::size_t t = 0; t + 2 < surface.indices().size(); t += 3) {
    const Vector3 a = vertex(surface, surface.indices()[t]);
    area += 0.5 * (vertex(surface, surface.indices()[t + 1]) - a)
                      .cross(vertex(surface, surface.indices()[t + 2]) - a)
                      .norm();
  }
  return area;
}

TEST(TrimmedTessellation, TrianglesFaceOutwardUpToTheRim) {
  for (const double turns : {0.5, 0.02}) {
    for (const bool mirrored : {false, true}) {
      SurfaceSnapshot snapshot = sample_scene({.bend_rad = 0.5}).bodies[0].surface;
      if (mirrored) {
        for (float& z : snapshot.z) z = -z;
      }
      const double whole_m2 = area_m2(tessellated(snapshot, 4000.0));
      snapshot.trim = hole_in(snapshot, turns);
      const TessellatedSurface surface = tessellated(snapshot, 4000.0);
      EXPECT_FALSE(surface.is_closed()) << "its inside can be seen";
      EXPECT_TRUE(surface.is_trimmed());
      EXPECT_LT(area_m2(surface), 0.98 * whole_m2);
      for (std::size_t t = 0; t + 2 < surface.indices().size(); t += 3) {
        const std::uint32_t* corner = surface.indices().data() + t;
        const Vector3 a = vertex(surface, corner[0]);
        const Vector3 face = (vertex(surface, corner[1]) - a).cross(vertex(surface, corner[2]) - a);
        // Very small triangles are skipped: their area is as small as the rounding error of single precision.
        if (face.norm() < 1e-10) continue;
        const auto& s = surface.samples();
        for (int c = 0; c < 3; ++c) {
          const Vector3 normal(s.nx[corner[c]], s.ny[corner[c]], s.nz[corner[c]]);
          EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
          EXPECT_GT(normal.dot(face), 0.0);
        }
      }
    }
  }
}

// Sides that belong to a single triangle must form closed boundary loops, so that each of their corners is on
// two such sides. A pole is a row of vertices in one position, so sides are compared by position.
TEST(TrimmedTessellation, HasOneRimAndNoGapElsewhere) {
  SurfaceSnapshot snapshot = sample_scene({.bend_rad = 0.5}).bodies[0].surface;
  for (const double turns : {0.5, 0.02}) {
    snapshot.trim = hole_in(snapshot, turns);
    const TessellatedSurface surface = tessellated(snapshot, 4000.0);
    std::map<std::array<long, 3>, int> places;
    const auto place = [&](std::uint32_t i) {
      const auto& s = surface.samples();
      const std::array<long, 3> rounded{std::lround(s.x[i] / 1e-7), std::lround(s.y[i] / 1e-7),
                                        std::lround(s.z[i] / 1e-7)};
      return places.try_emplace(rounded, static_cast<int>(places.size())).first->second;
    };
    std::map<std::pair<int, int>, int> sides;
    for (std::size_t t = 0; t + 2 < surface.indices().size(); t += 3) {
      int corners[3];
      for (std::size_t c = 0; c < 3; ++c) corners[c] = place(surface.indices()[t + c]);
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      for (int c = 0; c < 3; ++c) ++sides[std::minmax(corners[c], corners[(c + 1) % 3])];
    }
    std::map<int, int> rim;
    for (const auto& [side, count] : sides) {
      ASSERT_LE(count, 2);
      if (count == 2) continue;
      ++rim[side.first];
      ++rim[side.second];
    }
    EXPECT_GE(rim.size(), 60u);
    for (const auto& [corner, count] : rim) EXPECT_EQ(count, 2);
  }
}

TEST(TrimmedTessellation, FollowsTheTrimAndForgetsIt) {
  SurfaceSnapshot snapshot = sample_scene().bodies[0].surface;
  const SamplingLevel level = choose_sampling_level(snapshot, 4000.0, {});
  TessellatedSurface surface;
  ASSERT_TRUE(surface.update(snapshot, level).ok());
  const auto whole = surface.indices();
  const std::size_t vertices = surface.vertex_count();
  snapshot.trim = hole_in(snapshot, 0.5);
  ASSERT_TRUE(surface.update(snapshot, level).ok());
  EXPECT_NE(surface.indices(), whole);
  EXPECT_GT(surface.vertex_count(), vertices);
  snapshot.trim = nullptr;
  ASSERT_TRUE(surface.update(snapshot, level).ok());
  EXPECT_EQ(surface.indices(), whole);
  EXPECT_EQ(surface.vertex_count(), vertices);
  EXPECT_TRUE(surface.is_closed());
}

}  // namespace
}  // namespace spoonbill
