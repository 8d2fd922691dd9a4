#include "engine/shapes/bowl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/inspection/curvature.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// Sizes from a flat dish with a thin rim to a cup as deep as half its width.
const std::vector<BowlSize> sizes = {
    {0.06, 0.042, 0.005, 0.0005}, {0.06, 0.042, 0.01, 0.001}, {0.06, 0.042, 0.021, 0.004},
    {0.03, 0.05, 0.008, 0.001},   {0.3, 0.3, 0.1, 0.003},     {0.12, 0.03, 0.004, 0.002},
};

Surface fitted_bowl(const BowlSize& size) {
  return fitted(bowl_shape(size)).surface;
}

// Box around many points of a surface.
Box sampled_box(const Surface& surface) {
  constexpr int steps = 400;
  Box box;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      box.include(position(surface, static_cast<double>(i) / steps, static_cast<double>(j) / steps));
    }
  }
  return box;
}

TEST(Bowl, HasItsSizes) {
  for (const BowlSize& size : sizes) {
    const Surface bowl = fitted_bowl(size);
    SCOPED_TRACE(size.depth_m);
    const Box box = sampled_box(bowl);
    const Vector3 expected(size.length_m, size.depth_m + size.rim_m, size.width_m);
    // The fit may err by its tolerance at either end, and the section of a thick rim is round but for 1 %.
    EXPECT_LT((box.extent() - expected).cwiseAbs().maxCoeff(), 2.0 * shape_tolerance_m + 0.01 * size.rim_m);
    const Vector3 inside = position(bowl, 0.75, 0.5), outside = position(bowl, 0.25, 0.5);
    EXPECT_NEAR(box.high.y() - inside.y(), size.depth_m, 2.0 * shape_tolerance_m);
    EXPECT_NEAR(inside.y() - outside.y(), size.rim_m, 2.0 * shape_tolerance_m);
  }
}

TEST(Bowl, HasAnEllipseAsItsEdge) {
  for (const BowlSize& size : sizes) {
    const Surface bowl = fitted_bowl(size);
    const double half_x = position(bowl, 0.0, 1.0).x(), half_z = position(bowl, 0.0, 0.5).z();
    EXPECT_LT(half_x, 0.5 * size.length_m);
    EXPECT_GT(half_x, 0.5 * (size.length_m - size.rim_m));
    for (const double u : {0.0, 0.5}) {
      for (int k = 0; k <= 200; ++k) {
        const Vector3 edge = position(bowl, u, k / 200.0);
        EXPECT_NEAR(edge.y(), 0.0, shape_tolerance_m);
        EXPECT_NEAR(std::hypot(edge.x() / half_x, edge.z() / half_z), 1.0, 2.0 * shape_tolerance_m / half_z);
      }
    }
  }
}

TEST(Bowl, IsSound) {
  for (const BowlSize& size : sizes) {
    const Surface bowl = fitted_bowl(size);
    SCOPED_TRACE(size.depth_m);
    EXPECT_FALSE(is_self_intersecting(bowl, true));
    EXPECT_LT(seam_jump(bowl), 2e-3);
    EXPECT_TRUE(check_closed_tube(bowl).ok());
    EXPECT_GT(volume_m3(bowl), 0.0);
    EXPECT_LE(std::max(bowl.net.rows, bowl.net.columns), 80);
  }
}

// The volume of a wall of even thickness is its thickness times the area of its middle, a paraboloid of
// revolution here. The rim lacks 2 h^2 / pi of it per length, the integral of the wall that erf() takes away.
TEST(Bowl, HasTheVolumeOfItsWall) {
  for (const double rim_m : {0.0005, 0.001, 0.002}) {
    const BowlSize size{0.05, 0.05, 0.01, rim_m};
    const Surface bowl = fitted_bowl(size);
    const double h = 0.5 * rim_m, a = position(bowl, 0.0, 1.0).x(), d = -position(bowl, 0.75, 0.5).y() + h;
    const double area = pi * a / (6.0 * d * d) * (std::pow(a * a + 4.0 * d * d, 1.5) - a * a * a);
    const double volume = rim_m * area - 2.0 * pi * a * 2.0 * h * h / pi;
    // The curvature of the wall changes the volume by a fraction of the order of (h / a)^2.
    EXPECT_NEAR(volume_m3(bowl), volume, 3e-3 * volume) << rim_m;
  }
}

// The rim is round: across it, the surface has half the thickness as its radius, at most a third less at the
// shoulders.
TEST(Bowl, HasARoundRim) {
  for (const BowlSize& size : sizes) {
    const auto shape = bowl_shape(size);
    ASSERT_TRUE(shape.ok());
    const double step = 1e-4;
    const Vector3 before = shape->at(1.0 - step, 0.5), at = shape->at(0.0, 0.5), after = shape->at(step, 0.5);
    const double chord = (after - before).norm(), height = (0.5 * (before + after) - at).norm();
    EXPECT_NEAR(chord * chord / (8.0 * height), 0.5 * size.rim_m, 0.01 * size.rim_m);
    ShapeFit close;
    close.tolerance_m = 1e-4 * size.rim_m;  // small, because curvatures err far more than positions
    const CurvatureRange range = find_curvature_range(fitted(shape, close).surface);
    EXPECT_LT(std::max(std::abs(range.smallest.curvature_per_m), std::abs(range.largest.curvature_per_m)),
              1.05 / bowl_reach_m(size));
  }
}

TEST(Bowl, IsPitched) {
  const BowlSize level{0.06, 0.042, 0.01, 0.001};
  BowlSize pitched = level;
  pitched.pitch_deg = 20.0;
  const auto one = bowl_shape(level), other = bowl_shape(pitched);
  ASSERT_TRUE(one.ok() && other.ok());
  const double front_y = other->at(0.0, 1.0).y();
  EXPECT_NEAR(front_y, one->at(0.0, 1.0).x() * std::sin(20.0 * pi / 180.0), 1e-12);
  for (const double u : {0.1, 0.6}) {
    EXPECT_NEAR(one->at(u, 0.3).norm(), other->at(u, 0.3).norm(), 1e-12);
  }
}

TEST(Bowl, RefusesImpossibleSizes) {
  const auto refused_field = [](const BowlSize& size) {
    const auto shape = bowl_shape(size);
    EXPECT_FALSE(shape.ok());
    return shape.ok() ? std::string() : shape.error().field;
  };
  EXPECT_EQ(refused_field({0.0, 0.042, 0.01, 0.001}), "length");
  EXPECT_EQ(refused_field({0.06, std::nan(""), 0.01, 0.001}), "width");
  EXPECT_EQ(refused_field({0.06, 0.014, 0.005, 0.001}), "width");
  EXPECT_EQ(refused_field({0.06, 0.25, 0.02, 0.001}), "width");
  EXPECT_EQ(refused_field({0.06, 0.042, 0.022, 0.001}), "depth");
  EXPECT_EQ(refused_field({0.06, 0.042, -0.01, 0.001}), "depth");
  EXPECT_EQ(refused_field({0.06, 0.042, 0.01, 0.005}), "rim");
  EXPECT_EQ(refused_field({0.06, 0.042, 0.01, 0.0001}), "rim");
  EXPECT_EQ(refused_field({0.06, 0.042, 0.01, 0.001, 61.0}), "pitch");
}

}  // namespace
}  // namespace spoonbill
