#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "engine/collision/stages/contact_stages.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

std::vector<Vector3> points_of(const ControlNet& net) {
  std::vector<Vector3> points;
  for (std::size_t k = 0; k < net.size(); ++k) points.emplace_back(net.x[k], net.y[k], net.z[k]);
  return points;
}

double largest_extent(const std::vector<Vector3>& points) {
  Vector3 low = points[0], high = points[0];
  for (const Vector3& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return (high - low).maxCoeff();
}

double hull_volume(const HullFacets& hull, const std::vector<Vector3>& points) {
  double six_volumes = 0.0;
  for (const auto& [a, b, c] : hull.triangles) six_volumes += points[a].dot(points[b].cross(points[c]));
  return six_volumes / 6.0;
}

void expect_closed(const HullFacets& hull) {
  std::set<std::pair<int, int>> directed;
  std::set<int> corners;
  for (const auto& triangle : hull.triangles) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(directed.insert({triangle[k], triangle[(k + 1) % 3]}).second);
      corners.insert(triangle[k]);
    }
  }
  for (const auto& [from, to] : directed) EXPECT_TRUE(directed.contains({to, from}));
  // Euler's formula for a closed surface without holes.
  EXPECT_EQ(corners.size() + hull.triangles.size(), directed.size() / 2 + 2);
}

// Checks that the hull and the points reach equally far along any direction: the hull is neither too small
// nor too large.
void expect_farthest(Random& random, const HullFacets& hull, const std::vector<Vector3>& points) {
  const double step = largest_extent(points) * 0x1p-20;
  for (int k = 0; k < 200; ++k) {
    const Vector3 direction =
        Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    double of_points = -1e30, of_hull = -1e30;
    for (const Vector3& point : points) of_points = std::max(of_points, direction.dot(point));
    for (const auto& triangle : hull.triangles) {
      for (const int corner : triangle) of_hull = std::max(of_hull, direction.dot(points[corner]));
    }
    // hull_facets() rounds the points to multiples of `step`, by at most half a step per axis. The tolerance
    // covers this error for a point and for a corner of the hull.
    EXPECT_NEAR(of_hull, of_points, 2.0 * step);
  }
}

TEST(HullFacets, OfRandomNetsAreTheirHulls) {
  Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const std::vector<Vector3> points = points_of(random_surface(random).net);
    const HullFacets hull = hull_facets(points);
    ASSERT_FALSE(hull.triangles.empty()) << trial;
    expect_closed(hull);
    expect_farthest(random, hull, points);
  }
}

// The points have rings in planes, and poles where many points coincide.
TEST(HullFacets, OfTubesAreTheirHulls) {
  Random random(8);
  const Surface tube = ellipsoid_tube(12, 14);
  const std::vector<Vector3> points = points_of(tube.net);
  const HullFacets hull = hull_facets(points);
  expect_closed(hull);
  expect_farthest(random, hull, points);
}

TEST(HullFacets, OfALatticeInACubeAreTheCube) {
  std::vector<Vector3> points;
  for (int k = 0; k < 125; ++k) points.emplace_back(0.25 * (k / 25), 0.25 * (k / 5 % 5), 0.25 * (k % 5));
  const HullFacets hull = hull_facets(points);
  expect_closed(hull);
  EXPECT_NEAR(hull_volume(hull, points), 1.0, 1e-12);
  double length = 0.0;
  for (const auto& [a, b] : hull.edges) length += (points[a] - points[b]).norm();
  EXPECT_NEAR(length, 12.0, 1e-12) << "no edge within a side";
}

// A box has a roof of two faces, whose normals differ by `bend_deg`. The ridge counts as an edge from half a
// degree on.
TEST(HullFacets, HaveEdgesWhereTheyBend) {
  for (const auto& [bend_deg, edges] : {std::pair{0.4, 12u}, {0.6, 13u}}) {
    const double height = 0.5 * std::tan(0.5 * bend_deg * std::numbers::pi / 180.0);
    std::vector<Vector3> points;
    for (int k = 0; k < 8; ++k) points.emplace_back(k & 1, -((k >> 1) & 1), k >> 2);
    points.emplace_back(0.5, height, 0.0);
    points.emplace_back(0.5, height, 1.0);
    const HullFacets hull = hull_facets(points);
    expect_closed(hull);
    // The four slanting edges of the roof replace two of the box's edges.
    EXPECT_EQ(hull.edges.size(), edges + 2u) << bend_deg;
  }
}

TEST(HullFacets, AreNoneOfWhatHasNoVolume) {
  std::vector<Vector3> flat;
  for (int k = 0; k < 20; ++k) flat.emplace_back(0.1 * k, 0.01 * k * k, 0.0);
  EXPECT_TRUE(hull_facets(flat).triangles.empty());
  EXPECT_TRUE(hull_facets(std::vector<Vector3>(10, Vector3::Ones())).triangles.empty());
  EXPECT_TRUE(hull_facets({}).triangles.empty());
  std::vector<Vector3> odd = {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  EXPECT_EQ(hull_facets(odd).triangles.size(), 4u);
  odd.push_back(Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(hull_facets(odd).triangles.empty());
}

}  // namespace
}  // namespace spoonbill
