// Tests fits to exactly known shapes.
#include "engine/fitting/fit_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"
#include "tests/engine/fitting/clouds.h"
#include "tests/engine/fitting/known_shapes.h"

namespace spoonbill {
namespace {

TEST(FitScan, SphereIsClosedAndFacesOutward) {
  const ScanFit fitted = fit(ellipsoid_cloud(6000, {0.02, 0.02, 0.02}), 16);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  const FittedBody& body = fitted.bodies[0];
  EXPECT_EQ(body.kind, ShapeKind::closed);
  EXPECT_EQ(body.folds.folds, 0U);
  // Cubic pieces of a sixteenth of a turn have an error below 1e-4 of the radius. The rest of the error is
  // due to the fairness term of the fit, mostly near the poles, where few points determine a control point.
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

// An even grid without noise has no outliers, and the surface extends to the grid's edges and corners.
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
  // The limit is a fifth of the grid's spacing of 3.4 mm; the rounded corners have the largest error.
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.max_m, 7e-4);
  EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 2e-5);
}

// A low square sheet is nearly symmetric about an axis through its centre, as a bowl with a thin wall is.
TEST(FitScan, LowWavesAreNoThinWall) {
  const Scan scan = random_cloud(5000, 3, [](double s, double t) { return on_waves(s, t, 0.1, 0.004); });
  const ScanFit fitted = fit(scan, 12);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::sheet);
}

// The fit spans the hole in the scan with nodes whose normals may point in either direction. These normals
// must not decide the orientation.
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

TEST(FitScan, HoleIsSpannedSmoothly) {
  Scan scan = ellipsoid_cloud(12000, {0.02, 0.02, 0.02});
  leave_out(scan, [](const Vector3& p) { return (p - Vector3(0.02, 0, 0)).norm() < 0.005; });
  const ScanFit fitted = fit(scan, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  // The limit is slightly more than the error of a flat cap over the hole, which would be 0.6 mm below the
  // sphere.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.02)), 5e-4);
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

// The gap between the balls is about 5 mm wide. This is less than three node spacings, but five point
// spacings.
TEST(FitScan, IslandsNearEachOtherAreTwo) {
  Scan scan = ellipsoid_cloud(10000, {0.03, 0.03, 0.03});
  append(scan, ellipsoid_cloud(9000, {0.03, 0.03, 0.03}), {0.045, 0.045, 0.016});
  add_outliers(scan, 7, 0.01);
  const ScanFit all = fit(scan, 12, IslandChoice::all);
  EXPECT_EQ(all.islands, 2U);
  ASSERT_EQ(all.bodies.size(), 2U);
  for (const FittedBody& body : all.bodies) {
    EXPECT_EQ(body.kind, ShapeKind::closed);
    EXPECT_NEAR(body.size_m.x(), 0.06, 2e-4);
  }
  EXPECT_LT(farthest_off(all.bodies[0].surface, from_sphere(0.03)), 3e-4);
}

// A stripe of 6 mm across a single sheet was not scanned. A gap of this width between two bodies would
// separate them.
TEST(FitScan, AStripeWithoutPointsPartsNoSheet) {
  Scan scan = random_cloud(20000, 31, [](double s, double t) { return on_waves(s, t, 0.2, 0.01); });
  leave_out(scan, [](const Vector3& p) { return std::abs(p.x() - 0.09) < 0.003; });
  const ScanFit fitted = fit(scan, 16);
  EXPECT_EQ(fitted.islands, 1U);
  EXPECT_NEAR(fitted.bodies[0].size_m.x(), 0.2, 1e-3);
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
  // The body covers both ellipsoids. Each of them has a volume of 4/3 pi 2e-6 m^3.
  EXPECT_GT(volume_of(body.surface), 2.0 * 4.0 / 3.0 * M_PI * 2e-6 * 0.9);
  EXPECT_LT(body.errors.data_to_surface.p95_m, 1e-3);
}

// Returns a ball whose upper half is pushed down, so that it becomes a bowl with a wall of 2 mm, open at the
// top.
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

// Handles of several slopes start beside the bowl's rim. The hole that the fit opens beside the rim is not
// planar, and the loop of this hole must run in the right direction.
TEST(FitScan, HandleAtAThinRimIsBridgedTheRightWayRound) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const TriangleMesh bowl = bowl_mesh();
  const std::vector<double> all = {0.5, -0.5, 1.4}, one = {0.5};
  for (const double slope : is_full_run() ? all : one) {
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
    // If the loop ran in the wrong direction, a quarter of the samples would fold.
    EXPECT_LT(fitted.bodies[0].folds.folds, fitted.bodies[0].folds.samples / 500) << slope;
    EXPECT_LT(fitted.bodies[0].errors.data_to_surface.p95_m, 1e-3) << slope;
  }
}

TEST(FitScan, TriangleSoupOfABallIsClosed) {
  const TriangleMesh mesh = soup(ball_mesh(24, 48, 0.02));
  const ScanFit fitted = fit({mesh.vertices_m, {}, mesh.triangles}, 14);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  EXPECT_EQ(fitted.bodies[0].kind, ShapeKind::closed);
  EXPECT_EQ(fitted.bodies[0].folds.folds, 0U);
  EXPECT_GT(volume_of(fitted.bodies[0].surface), 0.0);
  // The triangles are up to 0.05 mm inside the ball.
  EXPECT_LT(farthest_off(fitted.bodies[0].surface, from_sphere(0.02)), 2e-4);
}

// The surface rounds the eight corners, which therefore have the largest errors. The errors are measured over
// the whole mesh, not only at its eight vertices.
TEST(FitScan, ErrorsOfAMeshAreThoseOfAllItsTriangles) {
  Scan box;
  for (int k = 0; k < 8; ++k) box.points_m.emplace_back(0.03 * (k & 1), 0.02 * (k >> 1 & 1), 0.05 * (k >> 2));
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const ScanFit fitted = fit(box, 20);
  ASSERT_EQ(fitted.bodies.size(), 1U);
  const FitErrors& errors = fitted.bodies[0].errors;
  EXPECT_EQ(fitted.bodies[0].points_m.size(), 8U);
  EXPECT_GT(errors.positions_m.size(), 2000U);
  EXPECT_EQ(errors.distance_m.size(), errors.positions_m.size());
  EXPECT_EQ(errors.strays, 0U);
  double at_corners = 1.0;
  for (std::size_t p = 0; p < errors.positions_m.size(); ++p) {
    for (const Vector3& corner : box.points_m) {
      if (errors.positions_m[p] == corner) at_corners = std::min(at_corners, errors.distance_m[p]);
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
  request.settings.progress = Progress([](double) { return false; });
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
