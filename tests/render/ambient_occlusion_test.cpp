#include "render/tessellation/ambient_occlusion.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "render/tessellation/tessellated_surface.h"
#include "tests/render/sample_scene.h"
#include "tests/render/tessellated.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

// Returns a mesh of a surface over the unit square, in n x n cells. Its normals point along du x dv.
TessellatedSurface sheet(int n, const std::function<Vector3(double, double)>& at) {
  MeshSnapshot mesh;
  mesh.is_closed = false;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const Vector3 point_m = at(static_cast<double>(i) / n, static_cast<double>(j) / n);
      mesh.x.push_back(static_cast<float>(point_m.x()));
      mesh.y.push_back(static_cast<float>(point_m.y()));
      mesh.z.push_back(static_cast<float>(point_m.z()));
    }
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  mesh.triangles = std::make_shared<const std::vector<std::array<std::uint32_t, 3>>>(std::move(triangles));
  TessellatedSurface surface;
  surface.update(mesh);
  return surface;
}

// Returns a part of a sphere of radius 1 around the origin, up to an angle from its lowest point. Its normals
// point inwards, or outwards.
TessellatedSurface bowl(double most_angle, bool inwards) {
  return sheet(40, [=](double u, double v) {
    const double angle = most_angle * u, around = (inwards ? -2.0 : 2.0) * pi * v;
    return Vector3(std::sin(angle) * std::cos(around), -std::cos(angle), std::sin(angle) * std::sin(around));
  });
}

template <class... Surfaces>
std::vector<TessellatedSurface> scene_of(Surfaces... surfaces) {
  std::vector<TessellatedSurface> scene;
  (scene.push_back(std::move(surfaces)), ...);
  return scene;
}

double mean_of(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double mean_visibility(const AmbientOcclusion& occlusion, std::size_t surface) {
  return mean_of(occlusion.visibility(surface).front);
}

// From every point inside a sphere's skin, a part of the skin hides its area over that of the sphere.
TEST(AmbientOcclusion, InsideABowlIsThatOfASphere) {
  for (const double angle : {0.5, 1.0, pi / 2.0}) {
    AmbientOcclusion occlusion;
    occlusion.update(scene_of(bowl(angle, true)));
    const double hidden = 0.5 * (1.0 - std::cos(angle));
    // The discs are flat, and the nearest of them cover an area that is not small.
    EXPECT_NEAR(1.0 - mean_visibility(occlusion, 0), hidden, 0.04) << angle;
  }
}

TEST(AmbientOcclusion, OutsideABallNothingIsHidden) {
  AmbientOcclusion occlusion;
  occlusion.update(scene_of(bowl(pi, false)));
  for (const float visible : occlusion.visibility(0).front) EXPECT_GT(visible, 0.97f);
}

TEST(AmbientOcclusion, TheBackOfAnOpenBowlIsInTheOpen) {
  AmbientOcclusion occlusion;
  for (const bool inwards : {true, false}) {
    occlusion.update(scene_of(bowl(1.2, inwards)));
    const BothSides& seen = occlusion.visibility(0);
    EXPECT_GT(mean_of(inwards ? seen.back : seen.front), 0.97);
    EXPECT_NEAR(mean_of(inwards ? seen.front : seen.back), 0.5 * (1.0 + std::cos(1.2)), 0.04);
  }
}

// The triangles of a B-spline surface are grouped by its samples.
TEST(AmbientOcclusion, ASurfaceHidesWhatIsBelowIt) {
  const Snapshot snapshot = sample_scene();
  const auto handle = [&](double x_m, double y_m) {
    SurfaceSnapshot moved = snapshot.bodies[0].surface;
    for (float& x : moved.x) x += static_cast<float>(x_m);
    for (float& y : moved.y) y += static_cast<float>(y_m);
    return tessellated(moved, 8000.0);
  };
  AmbientOcclusion occlusion;
  occlusion.update(scene_of(handle(0.0, 0.0), handle(1.0, 0.0)));
  const double apart = mean_visibility(occlusion, 0);
  EXPECT_GT(apart, 0.9);
  occlusion.update(scene_of(handle(0.0, 0.0), handle(0.0, 0.006)));
  EXPECT_LT(mean_visibility(occlusion, 0), apart - 0.07);
  occlusion.update(scene_of(handle(0.0, 0.0)));
  EXPECT_NEAR(mean_visibility(occlusion, 0), apart, 0.02);
  occlusion.update({});
}

// The form factor of a square from a point before its middle.
TEST(AmbientOcclusion, OfASquareAboveIsItsFormFactor) {
  for (const double height : {0.3, 0.6, 1.5}) {
    const auto square = [](double y, bool up) {
      return sheet(
          24, [=](double u, double v) { return Vector3(up ? v - 0.5 : u - 0.5, y, up ? u - 0.5 : v - 0.5); });
    };
    AmbientOcclusion occlusion;
    occlusion.update(scene_of(square(0.0, true), square(height, false)));
    const double x = 0.5 / height, slant = x / std::sqrt(1.0 + x * x);
    const double factor = 4.0 / (2.0 * pi) * 2.0 * slant * std::atan(slant);
    const std::size_t middle = occlusion.visibility(0).front.size() / 2;
    EXPECT_NEAR(1.0 - static_cast<double>(occlusion.visibility(0).front[middle]), factor, 0.03) << height;
  }
}

TEST(AmbientOcclusion, FollowsBodiesThatMove) {
  const auto floor = [] { return sheet(24, [](double u, double v) { return Vector3(v, 0.0, u); }); };
  const auto lid = [](double y) { return sheet(24, [=](double u, double v) { return Vector3(u, y, v); }); };
  AmbientOcclusion occlusion;
  occlusion.update(scene_of(floor(), lid(0.1)));
  const double closed = mean_visibility(occlusion, 0);
  occlusion.update(scene_of(floor(), lid(5.0)));
  EXPECT_LT(closed, 0.3);
  EXPECT_GT(mean_visibility(occlusion, 0), 0.98);
}

TEST(AmbientOcclusion, FollowsInPartsWithinAsManyCalls) {
  const auto floor = [] { return sheet(24, [](double u, double v) { return Vector3(v, 0.0, u); }); };
  const auto lid = [](double y) { return sheet(24, [=](double u, double v) { return Vector3(u, y, v); }); };
  constexpr std::size_t parts = 4;
  AmbientOcclusion whole, divided;
  divided.update(scene_of(floor(), lid(5.0)), parts);
  EXPECT_GT(mean_visibility(divided, 0), 0.98) << "the first call computes all";
  whole.update(scene_of(floor(), lid(0.1)));
  std::vector<float> last = divided.visibility(0).front;
  for (std::size_t call = 0; call < parts; ++call) {
    divided.update(scene_of(floor(), lid(0.1)), parts);
    std::size_t changed = 0;
    for (std::size_t v = 0; v < last.size(); ++v) changed += divided.visibility(0).front[v] != last[v];
    EXPECT_NEAR(static_cast<double>(changed), static_cast<double>(last.size()) / parts, 2.0) << call;
    last = divided.visibility(0).front;
  }
  EXPECT_EQ(last, whole.visibility(0).front);
}

TEST(AmbientOcclusion, IsFiniteForAShapeThatIsNot) {
  AmbientOcclusion occlusion;
  const float nan = std::nanf("");
  occlusion.update(
      scene_of(sheet(4, [=](double u, double v) { return Vector3(u, v > 0.5 ? nan : 0.0, v); })));
  for (const float visible : occlusion.visibility(0).front) {
    EXPECT_TRUE(visible >= 0.0f && visible <= 1.0f);
  }
  occlusion.update(scene_of(sheet(4, [](double, double) { return Vector3(1.0, 1.0, 1.0); })));
  for (const float visible : occlusion.visibility(0).front) EXPECT_EQ(visible, 1.0f);
}

}  // namespace
}  // namespace spoonbill
