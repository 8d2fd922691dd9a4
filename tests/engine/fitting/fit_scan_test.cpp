// Fits to shapes of which every point is known.
#include "engine/fitting/fit_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/study/curvature_range.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"
#include "tests/engine/fitting/clouds.h"

namespace spoonbill {
namespace {

using Distance = std::function<double(const Vector3&)>;

// The largest distance of the surface from the known shape, on a grid of samples.
double farthest_off(const Surface& surface, const Distance& distance) {
  double farthest = 0.0;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j <= 60; ++j) {
      farthest = std::max(farthest, distance(position(surface, i / 60.0, j / 60.0)));
    }
  }
  return farthest;
}

ScanFit fit(const Scan& scan, int control, IslandChoice islands = IslandChoice::largest) {
  FitRequest request;
  request.settings.control_u = request.settings.control_v = control;
  request.islands = islands;
  auto fitted = fit_scan(scan, request);
  EXPECT_TRUE(fitted) << fitted.error().message;
  return fitted ? std::move(fitted).value() : ScanFit{};
}

Distance from_sphere(double radius_m) {
  return [=](const Vector3& point) { return std::abs(point.norm() - radius_m); };
}

double volume_of(const Surface& surface) {
  double volume = 0.0;
  constexpr int grid = 200;
  for (int k = 0; k < grid * grid; ++k) {
    const SurfacePoint at = evaluate(surface, (k / grid + 0.5) / grid, (k % grid + 0.5) / grid);
    volume += at.position_m.dot(at.du.cross(at.dv)) / (3.0 * grid * grid);
  }
  return volume;
}

TEST(FitScan, SphereIsClosedAndFacesOutward) {
  const ScanFit fitted = fit(ellipsoid_cloud(6000, {0.02, 0.02, 0.02}), 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  const FittedBody& body = fitted.bodies[0];
  EXPECT_EQ(body.kind, ShapeKind::closed);
  EXPECT_EQ(body.folds.folds, 0U);
  // Cubic pieces of a sixteenth of the way around: their own error is below 1e-4 of the radius; what remains
  // is the fairness, and more of it about the poles, where few points hold a control point.
  EXPECT_LT(body.errors.data_to_surface.p95_m, 2e-5);
  EXPECT_LT(farthest_off(body.surface, from_sphere(0.02)), 6e-4);
  EXPECT_NEAR(volume_of(body.surface), 4.0 / 3.0 * M_PI * 8e-6, 1e-7);
}

TEST(FitScan, EllipsoidHasPolesOnItsLongAxis) {
  const ScanFit fitted = fit(ellipsoid_cloud(6000, {0.01, 0.012, 0.03}), 20);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  const Surface& surface = fitted.bodies[0].surface;
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 5e-5);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_NEAR(std::abs(position(surface, 0.0, 0.0).z()), 0.03, 1e-3);
  EXPECT_NEAR(std::abs(position(surface, 0.0, 1.0).z()), 0.03, 1e-3);
}

TEST(FitScan, OpenCylinderIsATube) {
  const Scan scan = random_cloud(8000, 1, [](double s, double t) { return on_cylinder(s, t, 0.01, 0.06); });
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::tube);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_LT(farthest_off(fitted.bodies[0].surface,
                         [](const Vector3& p) { return std::abs(std::hypot(p.x(), p.y()) - 0.01); }),
            1e-4);
}

double share_facing(const Surface& surface, const std::function<Vector3(const Vector3&)>& out) {
  int facing = 0;
  constexpr int grid = 20;
  for (int k = 0; k < grid * grid; ++k) {
    const SurfacePoint at = evaluate(surface, (k / grid + 0.5) / grid, (k % grid + 0.5) / grid);
    if (at.du.cross(at.dv).dot(out(at.position_m)) > 0.0) ++facing;
  }
  return facing / static_cast<double>(grid * grid);
}

// What is scanned is seen from outside, and clay lies behind its normals.
TEST(FitScan, OpenShapesWithoutNormalsFaceOutwards) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
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

TEST(FitScan, TorusSectorIsATubeAlongItsBend) {
  const Scan scan =
      random_cloud(9000, 2, [](double s, double t) { return on_torus_sector(s, t, 0.05, 0.01); });
  const ScanFit fitted = fit(scan, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::tube);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_LT(farthest_off(fitted.bodies[0].surface,
                         [](const Vector3& p) {
                           return std::abs(std::hypot(std::hypot(p.x(), p.y()) - 0.05, p.z()) - 0.01);
                         }),
            1.5e-4);
}

TEST(FitScan, WavesAreASheet) {
  const Scan scan = random_cloud(8000, 3, [](double s, double t) { return on_waves(s, t, 0.1, 0.006); });
  const ScanFit fitted = fit(scan, 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::sheet);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 1e-4);
}

// Nothing of an even grid without noise is a stray, and the surface goes out to its edges and corners.
TEST(FitScan, ExactGridIsFittedToItsEdges) {
  Scan scan;
  for (int k = 0; k < 900; ++k) {
    const double x = (k % 30) / 29.0, y = (k / 30) / 29.0;
    scan.points_m.emplace_back(0.1 * x, 0.1 * y, 0.005 * std::sin(7.0 * x) * std::cos(7.0 * y));
  }
  const ScanFit fitted = fit(scan, 24);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::sheet);
  EXPECT_EQ(fitted.bodies[0].errors.strays, 0U);
  // A fifth of the grid's spacing of 3.4 mm, at the corners, which are rounded.
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.max_m, 7e-4);
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 2e-5);
}

// Square and low, so that it is as round about its middle as a bowl.
TEST(FitScan, LowWavesAreNoThinWall) {
  const Scan scan = random_cloud(5000, 3, [](double s, double t) { return on_waves(s, t, 0.1, 0.004); });
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::sheet);
}

TEST(FitScan, NoiseIsAveragedAndOutliersLeftOut) {
  Scan scan = ellipsoid_cloud(20000, {0.03, 0.03, 0.03});
  add_noise(scan, 4, 3e-4);
  add_outliers(scan, 5, 0.02);
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_GT(fitted.outliers, 200U);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  // Some 150 points for each control point average their noise of 0.3 mm; the few at a pole do not.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.03)), 4.5e-4);
  EXPECT_LT(fitted.bodies[0].errors.surface_to_data.mean_m, 1.5e-4);
}

// More points than are fitted: each outlier has a voxel of its own, those of the surface share theirs.
TEST(FitScan, OutliersOfLargeCloudsAreLeftOut) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scan scan = ellipsoid_cloud(600'000, {0.03, 0.03, 0.03});
  add_outliers(scan, 5, 0.05);
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  // Of 30,000 in a box of 0.06 m, some 8 % lie within 0.5 mm of the sphere, a voxel's side.
  EXPECT_GT(fitted.outliers, 25'000U);
  EXPECT_LT(fitted.outliers, 30'000U);
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.03)), 2e-4);
}

// As a depth camera sees what is far off or turned away: what is sparse is surface all the same.
TEST(FitScan, SparsePartsOfLargeCloudsAreKept) {
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

// Noise and wrinkles about the poles bend a surface many times as much as its shape does.
TEST(FitScan, NoiseDoesNotWrinkleTheSurface) {
  for (const Vector3& half_axes : {Vector3(0.03, 0.03, 0.03), Vector3(0.02, 0.025, 0.04)}) {
    Scan scan = ellipsoid_cloud(12000, half_axes);
    add_noise(scan, 6, 3e-4);
    const ScanFit fitted = fit(scan, 24);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    // 8 pi for a ball, little more for these.
    EXPECT_LT(bending_measure(fitted.bodies[0].surface), 45.0);
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

// As scanners' programs write them: towards the scanner, or as it came.
TEST(FitScan, NormalsThatDoNotAgreeAreMadeTo) {
  const ScanFit true_fit = fit(egg_with_normals(), 14);
  ASSERT_EQ(true_fit.bodies.size(), 1U);
  EXPECT_EQ(true_fit.turned_normals, 0U);
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
    EXPECT_GT(fitted.turned_normals, 5000U);
    const FittedBody& body = fitted.bodies[0];
    EXPECT_EQ(body.points_m.size(), 12000U);
    EXPECT_EQ(body.kind, ShapeKind::closed);
    EXPECT_EQ(body.folds.folds, 0U);
    EXPECT_NEAR(volume_of(body.surface), volume_of(true_fit.bodies[0].surface), 1e-8);
    EXPECT_LT(body.errors.data_to_surface.p95_m, 1.1 * true_fit.bodies[0].errors.data_to_surface.p95_m);
  }
}

// Half of a ball as a bowl with a wall of `wall_m`, of which the points of each face know their normals.
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

// Nodes lie some 4 mm apart: the faces of the walls are nearer to each other than these.
TEST(FitScan, WallsKeepTheNormalsOfTheirFaces) {
  for (const double wall : {0.001, 0.002, 0.005}) {
    const ScanFit fitted = fit(bowl_with_normals(wall), 20, IslandChoice::all);
    EXPECT_EQ(fitted.turned_normals, 0U) << wall;
    EXPECT_EQ(fitted.islands, 2U) << wall;
  }
}

// What spans the hole faces either way: it must not tell which side is out.
TEST(FitScan, ClosedShapesFaceOutwardsWhateverWasNotSeen) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Scan scan = ellipsoid_cloud(3000 + 500 * seed, {0.02, 0.022, 0.03});
    leave_out(scan, [](const Vector3& p) { return p.z() < -0.026; });
    add_noise(scan, seed, 1e-4);
    const ScanFit fitted = fit(scan, 14);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
    EXPECT_GT(volume_of(fitted.bodies[0].surface), 0.0) << seed;
  }
}

TEST(FitScan, AMeshInsideOutIsTurned) {
  TriangleMesh mesh = ball_mesh(24, 48, 0.02);
  for (TriangleCorners& corners : mesh.triangles) std::swap(corners[0], corners[1]);
  const ScanFit fitted = fit({mesh.vertices_m, {}, mesh.triangles}, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_GT(volume_of(fitted.bodies[0].surface), 0.0);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
}

// Noise hides a part of the rims.
TEST(FitScan, NoisyOpenCylinderIsATube) {
  Scan scan = random_cloud(9000, 11, [](double s, double t) { return on_cylinder(s, t, 0.031, 0.08); });
  add_noise(scan, 12, 3e-4);
  const ScanFit fitted = fit(scan, 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::tube);
}

// A single face as thick as its noise is no wall.
TEST(FitScan, NoisyDomeIsASheet) {
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

TEST(FitScan, HoleIsSpannedSmoothly) {
  Scan scan = ellipsoid_cloud(12000, {0.02, 0.02, 0.02});
  leave_out(scan, [](const Vector3& p) { return (p - Vector3(0.02, 0, 0)).norm() < 0.005; });
  const ScanFit fitted = fit(scan, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  // A flat lid would lie 0.6 mm below the sphere.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.02)), 8e-4);
}

TEST(FitScan, IslandsAreFittedAsAsked) {
  Scan scan = ellipsoid_cloud(6000, {0.02, 0.02, 0.02});
  append(scan, ellipsoid_cloud(3000, {0.01, 0.01, 0.01}), {0.06, 0.0, 0.0});
  const ScanFit all = fit(scan, 10, IslandChoice::all);
  ASSERT_EQ(all.bodies.size(), 2U);
  EXPECT_EQ(all.islands, 2U);
  EXPECT_NEAR(all.bodies[0].size_m.x(), 0.04, 1e-4);
  EXPECT_NEAR(all.bodies[1].size_m.x(), 0.02, 1e-4);
  const ScanFit largest = fit(scan, 10);
  ASSERT_EQ(largest.bodies.size(), 1U);
  EXPECT_EQ(largest.other_islands, 3000U);
}

TEST(FitScan, IslandsAreBridgedToOneBody) {
  Scan scan = ellipsoid_cloud(5000, {0.01, 0.01, 0.02});
  append(scan, ellipsoid_cloud(5000, {0.01, 0.01, 0.02}), {0.0, 0.0, 0.05});
  const ScanFit fitted = fit(scan, 20, IslandChoice::bridge);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.islands, 2U);
  const FittedBody& body = fitted.bodies[0];
  EXPECT_EQ(body.kind, ShapeKind::closed);
  EXPECT_EQ(body.folds.folds, 0U);
  EXPECT_NEAR(body.size_m.z(), 0.09, 1e-3);
  // The middles of both are within one body: its rings run around them.
  EXPECT_GT(volume_of(body.surface), 2.0 * 4.0 / 3.0 * M_PI * 2e-6 * 0.9);
  EXPECT_LT(body.errors.data_to_surface.p95_m, 1e-3);
}

// A ball pressed in to a bowl with a wall 2 mm thick, open upwards.
TriangleMesh bowl_mesh() {
  constexpr double outer = 0.025, wall = 0.002;
  TriangleMesh mesh = ball_mesh(40, 60, outer);
  for (Vector3& vertex : mesh.vertices_m) {
    if (vertex.z() < 0.0) continue;
    vertex *= (outer - wall * std::min(1.0, vertex.z() / wall)) / outer;
    vertex.z() *= -1.0;
  }
  return mesh;
}

// Handles of all slopes that begin beside the bowl's rim: where that is opened, the rim of the hole does not
// run round the way to the handle.
TEST(FitScan, HandleAtAThinRimIsBridgedTheRightWayRound) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const TriangleMesh bowl = bowl_mesh();
  for (const double slope : {-0.5, 0.5, 1.4}) {
    TriangleMesh rod = ball_mesh(30, 30, 1.0);
    const Vector3 along(std::cos(slope), 0.0, std::sin(slope)), across(-along.z(), 0.0, along.x());
    for (Vector3& vertex : rod.vertices_m) {
      vertex = Vector3(0.025, 0.0, 0.0) + (0.035 + 0.03 * vertex.x()) * along +
               0.004 * (vertex.y() * Vector3::UnitY() + vertex.z() * across);
    }
    Scan scan{bowl.vertices_m, {}, bowl.triangles};
    const auto first = static_cast<std::uint32_t>(scan.points_m.size());
    scan.points_m.insert(scan.points_m.end(), rod.vertices_m.begin(), rod.vertices_m.end());
    for (const TriangleCorners& corners : rod.triangles) {
      scan.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    }
    const ScanFit fitted = fit(scan, 24, IslandChoice::bridge);
    ASSERT_EQ(fitted.bodies.size(), 1U);
    EXPECT_EQ(fitted.islands, 2U);
    // Turned the wrong way round, a quarter of it folds.
    EXPECT_LT(fitted.bodies[0].folds.folds, fitted.bodies[0].folds.samples / 500) << slope;
    EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 1e-3) << slope;
  }
}

// Both faces of a wall 2 mm thick, 3 mm between points: only the profile tells them apart.
TEST(FitScan, ThinBowlWithoutNormalsHasTwoFaces) {
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

TEST(FitScan, TriangleSoupOfABallIsClosed) {
  const TriangleMesh mesh = soup(ball_mesh(24, 48, 0.02));
  const ScanFit fitted = fit({mesh.vertices_m, {}, mesh.triangles}, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_GT(volume_of(fitted.bodies[0].surface), 0.0);
  // The triangles lie up to 0.05 mm within the ball.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.02)), 2e-4);
}

// Its eight corners are the worst places: the surface rounds them. All of it counts.
TEST(FitScan, ErrorsOfAMeshAreThoseOfAllItsTriangles) {
  Scan box;
  for (int k = 0; k < 8; ++k) box.points_m.emplace_back(0.03 * (k & 1), 0.02 * (k >> 1 & 1), 0.05 * (k >> 2));
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const ScanFit fitted = fit(box, 20);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  const FitErrors& errors = fitted.bodies[0].errors;
  EXPECT_EQ(fitted.bodies[0].points_m.size(), 8U);
  EXPECT_GT(errors.places_m.size(), 2000U);
  EXPECT_EQ(errors.distance_m.size(), errors.places_m.size());
  EXPECT_EQ(errors.strays, 0U);
  double at_corners = 1.0;
  for (std::size_t p = 0; p < errors.places_m.size(); ++p) {
    for (const Vector3& corner : box.points_m) {
      if (errors.places_m[p] == corner) at_corners = std::min(at_corners, errors.distance_m[p]);
    }
  }
  EXPECT_LT(errors.data_to_surface.p95_m, at_corners);
}

TEST(FitScan, ToleranceSavesControlPoints) {
  FitRequest request;
  request.settings.control_u = request.settings.control_v = 40;
  request.settings.tolerance_m = 5e-4;
  const auto fitted = fit_scan(ellipsoid_cloud(6000, {0.02, 0.02, 0.02}), request);
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_LT(fitted->bodies[0].surface.net.rows, 20);
  EXPECT_LT(fitted->bodies[0].errors.data_to_surface.max_m, 5e-4);
}

TEST(FitScan, StopsWhenToldTo) {
  FitRequest request;
  request.settings.watch = [](double) { return false; };
  EXPECT_FALSE(fit_scan(ellipsoid_cloud(2000, {0.02, 0.02, 0.02}), request));
}

TEST(FitScan, RefusesWhatIsNoSurface) {
  EXPECT_FALSE(fit_scan(Scan{}, {}));
  EXPECT_FALSE(fit_scan(ellipsoid_cloud(20, {0.02, 0.02, 0.02}), {}));
  Scan one_place;
  one_place.points_m.assign(1000, Vector3(0.01, 0.02, 0.03));
  EXPECT_FALSE(fit_scan(one_place, {}));
  Scan line;
  for (int k = 0; k < 1000; ++k) line.points_m.emplace_back(k * 1e-4, 0.0, 0.0);
  const auto fitted = fit_scan(line, {});
  if (fitted) {
    EXPECT_TRUE(fitted->bodies[0].surface.net.point(0, 0).allFinite());
  }
}

}  // namespace
}  // namespace spoonbill
