#include "engine/collision/levels/surface_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

// A flat cell does not bulge beyond its corners. The radius of its bounding sphere must therefore equal the
// distance from the centre to the farthest corner, up to rounding.
TEST(SurfaceLevels, SpheresOfFlatCellsEndAtTheirCorners) {
  const KnotVector knots = KnotVector::clamped_uniform(1, 4).value();
  ControlNet net(4, 4);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) net.set_point(i, j, {0.3 * i, 0.1 * i + 0.2 * j, 0.4 * j});
  }
  const Surface sheet = make_surface(knots, knots, net).value();
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceLevels levels(nested);
  levels.begin(sheet);
  for (int level = 0; level <= 2; ++level) {
    const LevelCell cell{levels.step(level), 2 * levels.step(level), level};
    const CoverSphere& cover = levels.cover(cell);
    double farthest = 0.0;
    for (const Vector3& corner : levels.corners(cell)) {
      farthest = std::max(farthest, (corner - cover.centre).norm());
    }
    EXPECT_NEAR(cover.radius, farthest, 1e-15) << level;
  }
}

TEST(SurfaceLevels, BoxesOfElementsHoldThem) {
  const KnotVector u = KnotVector::periodic_uniform(3, 6).value(),
                   v = KnotVector::clamped_uniform(4, 7).value();
  ControlNet net(6, 7);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 7; ++j)
      net.set_point(i, j, {std::cos(i + 0.3 * j), 0.4 * j, std::sin(1.1 * i - 0.2 * j)});
  }
  const Surface surface = make_surface(u, v, net).value();
  const NestedGrid nested = make_nested_grid(u, v, 1).value();
  SurfaceLevels levels(nested);
  levels.begin(surface);
  const int elements_v = levels.bounds().elements_v();
  std::vector<Box> boxes(static_cast<std::size_t>(elements_v));
  std::vector<double> bulges(boxes.size());
  for (int e = 0; e < levels.bounds().elements_u(); ++e) {
    levels.element_boxes(e, boxes.data(), bulges.data());
    for (int f = 0; f < elements_v; ++f) {
      const Box& box = boxes[static_cast<std::size_t>(f)];
      for (int k = 0; k < 100; ++k) {
        const double s =
            nested.grid.u.parameters[2 * e] +
            (k / 10) / 9.0 * (nested.grid.u.parameters[2 * e + 2] - nested.grid.u.parameters[2 * e]);
        const double t =
            nested.grid.v.parameters[2 * f] +
            (k % 10) / 9.0 * (nested.grid.v.parameters[2 * f + 2] - nested.grid.v.parameters[2 * f]);
        const Vector3 point = position(surface, s, t);
        EXPECT_TRUE(box.holds({point + Vector3::Constant(1e-12), point - Vector3::Constant(1e-12)}));
      }
    }
  }
}

// Two quadrilaterals in one plane, each cut from a sector with its tip at the origin. A narrow gap separates
// the two sectors. Neither the direction between the centres of the quadrilaterals nor their normals are
// separating axes.
TEST(PatchDistance, TellsSliversApartThatLieSideBySide) {
  const auto sliver = [](double from, double low_slope, double high_slope) {
    const double to = from + 4.0;
    return PatchCorners{Vector3(from, from * low_slope, 0.0), Vector3(to, to * low_slope, 0.0),
                        Vector3(from, from * high_slope, 0.0), Vector3(to, to * high_slope, 0.0)};
  };
  const PatchCorners one = sliver(5.0, -0.3, 0.0), other = sliver(8.0, 0.02, 0.2);
  EXPECT_LE(patch_distance(one, 0.0, other, 0.0), 0.0);
  EXPECT_NEAR(patch_distance_in_plane(one, 0.0, other, 0.0), 0.16, 1e-12);
  EXPECT_NEAR(patch_distance_in_plane(other, 0.02, one, 0.01), 0.13, 1e-12);
  EXPECT_LE(patch_distance_in_plane(one, 0.0, sliver(8.0, -0.1, 0.2), 0.0), 0.0);
}

}  // namespace
}  // namespace spoonbill
