// Tests fits to realistic scans: with noise, outliers, and inconsistent or missing normals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/fitting/fit_points.h"
#include "engine/fitting/fit_scan.h"
#include "engine/inspection/curvature.h"
#include "tests/engine/effort.h"
#include "tests/engine/fitting/clouds.h"
#include "tests/engine/fitting/known_shapes.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

double share_facing(const Surface& surface, const std::function<Vector3(const Vector3&)>& out) {
  int facing = 0;
  constexpr int grid = 20;
  for (int k = 0; k < grid * grid; ++k) {
    const SurfacePoint at = evaluate(surface, (k / grid + 0.5) / grid, (k % grid + 0.5) / grid);
    if (at.du.cross(at.dv).dot(out(at.position_m)) > 0.0) ++facing;
  }
  return facing / static_cast<double>(grid * grid);
}

// Scanners see surfaces from outside, so the normals must point away from the material: away from the axis of
// a tube, and towards the side to which a dome bulges.
TEST(RoughScan, OpenShapesWithoutNormalsFaceOutwards) {
  for (unsigned seed = 1; seed <= (is_full_run() ? 6U : 2U); ++seed) {
    Scan tube = random_cloud(4000, seed, [](double s, double t) { return on_cylinder(s, t, 0.01, 0.06); });
    Scan dome = random_cloud(4000, seed, [](double s, double t) {
      const double x = 0.06 * (s - 0.5), y = 0.06 * (t - 0.5);
      return Vector3(0.2 - (x * x + y * y) / 0.1, x, y - 0.1);
    });
    Scan flat = random_cloud(4000, seed, [](double s, double t) { return Vector3(0.1 * s, 0.1 * t, 0.3); });
    if (seed % 2 == 0) {
      for (Scan* scan : {&tube, &dome, &flat}) std::reverse(scan->points_m.begin(), scan->points_m.end());
    }
    const ScanFit tube_fit = fit(tube, 12), dome_fit = fit(dome, 12), flat_fit = fit(flat, 12);
    ASSERT_EQ(tube_fit.bodies[0].kind, ShapeKind::tube);
    ASSERT_EQ(dome_fit.bodies[0].kind, ShapeKind::sheet);
    ASSERT_EQ(flat_fit.bodies[0].kind, ShapeKind::sheet);
    const auto from_axis = [](const Vector3& p) { return Vector3(p.x(), p.y(), 0.0); };
    EXPECT_GT(share_facing(tube_fit.bodies[0].surface, from_axis), 0.99) << seed;
    EXPECT_GT(share_facing(dome_fit.bodies[0].surface, [](auto) { return Vector3::UnitX(); }), 0.99) << seed;
    EXPECT_GT(share_facing(flat_fit.bodies[0].surface, [](auto) { return Vector3::UnitZ(); }), 0.99) << seed;
  }
}

TEST(RoughScan, NoiseIsAveragedAndOutliersLeftOut) {
  Scan scan = ellipsoid_cloud(20000, {0.03, 0.03, 0.03});
  add_noise(scan, 4, 3e-4);
  add_outliers(scan, 5, 0.02);
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_GT(fitted.outliers, 200U);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  // About 150 points for each control point average out the noise of 0.3 mm. Control points near a pole have
  // fewer points.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.03)), 4.5e-4);
  EXPECT_LT(fitted.bodies[0].errors.surface_to_data.mean_m, 1.5e-4);
}

// Returns a mesh over a grid of (s, t), closed along s.
Scan mesh_over(int along_s, int along_t, const std::function<Vector3(double, double)>& place) {
  Scan scan;
  for (int i = 0; i <= along_s; ++i) {
    for (int j = 0; j <= along_t; ++j) {
      scan.points_m.push_back(place(i / static_cast<double>(along_s), j / static_cast<double>(along_t)));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (along_t + 1) + j); };
  for (int i = 0; i < along_s; ++i) {
    for (int j = 0; j < along_t; ++j) {
      scan.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      scan.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return scan;
}

Vector3 on_ball(double s, double t) {
  const double a = 2.0 * pi * s, b = pi * t;
  return 0.03 * Vector3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), -std::cos(b));
}

// Displaces every `every`-th vertex far off the surface, except at the seam and the poles.
std::size_t add_spikes(Scan& mesh, int along_s, int along_t, int every, double height_m) {
  std::size_t count = 0;
  for (int p = every; p < along_s * (along_t + 1); p += every) {
    const int i = p / (along_t + 1), j = p % (along_t + 1);
    if (i == 0 || j < 4 || j > along_t - 4) continue;
    Vector3& point = mesh.points_m[static_cast<std::size_t>(p)];
    point += height_m * (1.0 + 0.1 * static_cast<double>(++count % 7)) * point.normalized();
  }
  return count;
}

TEST(RoughScan, SpikesOfMeshesAreLeftOut) {
  for (const double height_m : {0.008, -0.008}) {
    SCOPED_TRACE(height_m);
    Scan scan = mesh_over(160, 80, on_ball);
    const std::size_t spikes = add_spikes(scan, 160, 80, 101, height_m);
    const ScanFit fitted = fit(scan, 16);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    EXPECT_GT(spikes, 100U);
    EXPECT_EQ(fitted.outliers, spikes);
    EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.03)), 3e-4);
    EXPECT_LT(fitted.bodies[0].errors.all_to_surface.p95_m, 2e-4);
  }
}

std::size_t spikes_in(Scan mesh) {
  const auto points = make_fit_points(std::move(mesh));
  EXPECT_TRUE(points) << points.error().message;
  return points ? points->outliers : 0;
}

TEST(RoughScan, TipsOfMeshesAreNoSpikes) {
  // The cone is slender and has even rings.
  const auto on_cone = [](double s, double t) {
    const double r = 0.008 * (1.0 - t), a = 2.0 * pi * s;
    return Vector3(r * std::cos(a), r * std::sin(a), 0.08 * t);
  };
  EXPECT_EQ(spikes_in(mesh_over(40, 64, on_cone)), 0U);
  // The mesh is a pencil as CAD systems export it: rings 2 mm apart, and a tip of 50 mm that is a single fan
  // of triangles on the last ring.
  constexpr int rings = 21;
  const auto on_pencil = [](double s, double t) {
    const double ring = std::round((rings + 1) * t), a = 2.0 * pi * s;
    const double r = ring == 0.0 || ring > rings ? 0.0 : 0.008;
    return Vector3(r * std::cos(a), r * std::sin(a), ring > rings ? 0.09 : 0.002 * std::max(ring - 1.0, 0.0));
  };
  EXPECT_EQ(spikes_in(mesh_over(64, rings + 1, on_pencil)), 0U);
}

// The cloud has more points than fitted_point_limit, so it is thinned by voxels. Each outlier is alone in its
// voxel, while surface points share voxels.
TEST(RoughScan, OutliersOfLargeCloudsAreLeftOut) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scan scan = ellipsoid_cloud(600'000, {0.03, 0.03, 0.03});
  add_outliers(scan, 5, 0.05);
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  // About 5 % of the 30,000 outliers in a box of 0.06 m are within 0.5 mm, about a voxel's side, of the
  // sphere.
  EXPECT_GT(fitted.outliers, 25'000U);
  EXPECT_LT(fitted.outliers, 30'000U);
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.03)), 2e-4);
}

// A part of the surface is sampled sparsely, as depth cameras sample distant or oblique surfaces. Its points
// are no outliers.
TEST(RoughScan, SparsePartsOfLargeCloudsAreKept) {
  Scan scan = random_cloud(300'000, 21, [](double s, double t) { return on_waves(s, t, 0.1, 0.006); });
  const auto is_sparse = [](const Vector3& p) { return p.x() > 0.06; };
  leave_out(scan, is_sparse);
  Scan few = random_cloud(10'000, 22, [](double s, double t) { return on_waves(s, t, 0.1, 0.006); });
  leave_out(few, [&](const Vector3& p) { return !is_sparse(p); });
  append(scan, few, Vector3::Zero());
  const ScanFit fitted = fit(scan, 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_LT(fitted.outliers, few.points_m.size() / 100);
  EXPECT_NEAR(fitted.bodies[0].size_m.x(), 0.1, 1e-3);
}

// A surface that followed the noise, or that had wrinkles about its poles, would have many times the bending
// energy of its shape.
TEST(RoughScan, NoiseDoesNotWrinkleTheSurface) {
  for (const Vector3& half_axes : {Vector3(0.03, 0.03, 0.03), Vector3(0.02, 0.025, 0.04)}) {
    Scan scan = ellipsoid_cloud(12000, half_axes);
    add_noise(scan, 6, 3e-4);
    const ScanFit fitted = fit(scan, 24);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    // The bending energy is 8 pi = 25.1 for the sphere and 35.0 for the ellipsoid.
    EXPECT_LT(compute_bending_energy(fitted.bodies[0].surface), 45.0);
    EXPECT_LT(fitted.bodies[0].errors.surface_to_data.p95_m, 3e-4);
  }
}

Scan egg_with_normals() {
  const Vector3 semi_axes(0.02, 0.022, 0.03);
  Scan scan = ellipsoid_cloud(12000, semi_axes);
  for (Vector3& point : scan.points_m) {
    scan.normals.push_back(point.cwiseQuotient(semi_axes.cwiseProduct(semi_axes)).normalized());
    point += Vector3(0.3, 0.0, 0.0);
  }
  return scan;
}

// The normals point towards the scanner or have random signs, as scanner software writes them.
TEST(RoughScan, NormalsThatDoNotAgreeAreMadeTo) {
  const ScanFit true_fit = fit(egg_with_normals(), 14);
  ASSERT_EQ(true_fit.bodies.size(), 1U);
  EXPECT_EQ(true_fit.flipped_normals, 0U);
  Scan towards_origin = egg_with_normals(), random = egg_with_normals();
  for (std::size_t p = 0; p < random.normals.size(); ++p) {
    Vector3& normal = towards_origin.normals[p];
    if (normal.dot(towards_origin.points_m[p]) > 0.0) normal = -normal;
    if (p * 2654435761U % 1000 < 500) random.normals[p] = -random.normals[p];
  }
  for (const Scan* scan : {&towards_origin, &random}) {
    const ScanFit fitted = fit(*scan, 14);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    EXPECT_EQ(fitted.islands, 1U);
    EXPECT_GT(fitted.flipped_normals, 5000U);
    const FittedBody& body = fitted.bodies[0];
    EXPECT_EQ(body.points_m.size(), 12000U);
    EXPECT_EQ(body.kind, ShapeKind::closed);
    EXPECT_EQ(body.folds.folds, 0U);
    EXPECT_NEAR(volume_of(body.surface), volume_of(true_fit.bodies[0].surface), 1e-8);
    EXPECT_LT(body.errors.data_to_surface.p95_m, 1.1 * true_fit.bodies[0].errors.data_to_surface.p95_m);
  }
}

// Returns half a ball as a bowl with a wall of `wall_m` and the true normals of both faces.
Scan bowl_with_normals(double wall_m) {
  Scan scan;
  for (const double side : {1.0, -1.0}) {
    const double radius = side > 0.0 ? 0.08 : 0.08 - wall_m;
    const Scan face = random_cloud(10000, side > 0.0 ? 8 : 9, [&](double s, double t) {
      const double height = t * radius, out = std::sqrt(radius * radius - height * height);
      return Vector3(out * std::cos(2.0 * M_PI * s), out * std::sin(2.0 * M_PI * s), -height);
    });
    append(scan, face, Vector3::Zero());
    for (const Vector3& point : face.points_m) scan.normals.push_back(side * point.normalized());
  }
  return scan;
}

// The nodes are about 4 mm apart. Two of the three walls are thinner than this.
TEST(RoughScan, WallsKeepTheNormalsOfTheirFaces) {
  for (const double wall : {0.001, 0.002, 0.005}) {
    if (wall > 0.001 && !is_full_run()) continue;
    const ScanFit fitted = fit(bowl_with_normals(wall), 20, IslandChoice::all);
    EXPECT_EQ(fitted.flipped_normals, 0U) << wall;
    EXPECT_EQ(fitted.islands, 2U) << wall;
  }
}

// Noise hides parts of the tube's boundaries.
TEST(RoughScan, NoisyOpenCylinderIsATube) {
  Scan scan = random_cloud(9000, 11, [](double s, double t) { return on_cylinder(s, t, 0.031, 0.08); });
  add_noise(scan, 12, 3e-4);
  const ScanFit fitted = fit(scan, 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::tube);
}

// The dome has a single face; noise must not make it look like a wall with two faces.
TEST(RoughScan, NoisyDomeIsASheet) {
  Scan scan = random_cloud(9000, 13, [](double s, double t) {
    const double r = 0.04 * std::sqrt(t), height = std::sqrt(0.045 * 0.045 - r * r);
    return Vector3(r * std::cos(2.0 * M_PI * s), r * std::sin(2.0 * M_PI * s), -height);
  });
  add_noise(scan, 14, 3e-4);
  const ScanFit fitted = fit(scan, 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::sheet);
  EXPECT_LT(fitted.bodies[0].errors.surface_to_data.p95_m, 3e-4);
}

// The wall is 2 mm thick and its points are 3 mm apart. Only the profile separates the two faces. The profile
// consists of all points, turned about the axis into one plane.
TEST(RoughScan, ThinBowlWithoutNormalsHasTwoFaces) {
  const auto bowl = [](double s, double t, double radius) {
    const double height = t * radius, out = std::sqrt(radius * radius - height * height);
    return Vector3(out * std::cos(2.0 * M_PI * s), out * std::sin(2.0 * M_PI * s), -height);
  };
  Scan scan = random_cloud(6000, 8, [&](double s, double t) { return bowl(s, t, 0.08); });
  append(scan, random_cloud(6000, 9, [&](double s, double t) { return bowl(s, t, 0.078); }), Vector3::Zero());
  const ScanFit fitted = fit(scan, 20);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 4e-4);
  const double shell = 2.0 / 3.0 * M_PI * (std::pow(0.08, 3) - std::pow(0.078, 3));
  EXPECT_NEAR(volume_of(fitted.bodies[0].surface), shell, 0.1 * shell);
}

}  // namespace
}  // namespace spoonbill
