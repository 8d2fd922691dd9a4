#include "render/tessellation/reach_ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/render/tessellated.h"

namespace spoonbill {
namespace {

constexpr double pixels_per_metre = 8000.0;

TessellatedSurface tessellated_shape(const Result<ExactShape>& shape) {
  const Surface surface = fit_shape(shape.value()).value().surface;
  SurfaceSnapshot snapshot;
  snapshot.u = surface.u;
  snapshot.v = surface.v;
  snapshot.structure = 1;
  const ControlNet& net = surface.net;
  snapshot.x.assign(net.x.begin(), net.x.end());
  snapshot.y.assign(net.y.begin(), net.y.end());
  snapshot.z.assign(net.z.begin(), net.z.end());
  return tessellated(snapshot, pixels_per_metre);
}

// Circles on a sphere have the great circles from their centre as radii, also over a pole and over the seam
// of the parameters.
TEST(ReachRing, OfASphereIsACircleAlongIt) {
  constexpr double radius_m = 0.03, reach_m = 0.02;
  const TessellatedSurface sphere = tessellated_shape(sphere_shape(radius_m));
  ReachRing ring;
  for (const Vector3& direction :
       {Vector3(0, 1, 0), Vector3(1, 0, 0), Vector3(0, 0, -1), Vector3(1, -2, 1), Vector3(0.1, 1, 0.05)}) {
    const Vector3 centre_m = radius_m * direction.normalized();
    ring.update(sphere, centre_m, reach_m);
    for (const std::optional<Vector3>& end : ring.ends_m()) {
      ASSERT_TRUE(end);
      const double angle = std::atan2(end->cross(centre_m).norm(), end->dot(centre_m));
      // The triangles lie up to 0.05 mm inside the sphere, so that lines over them are shorter.
      EXPECT_NEAR(radius_m * angle, reach_m, 0.01 * reach_m) << direction.transpose();
      EXPECT_NEAR(end->norm(), radius_m, 1e-4);
    }
  }
}

// Over the edge of a box, a line is as long as on the faces folded flat.
TEST(ReachRing, OfABoxGoesAroundItsEdge) {
  constexpr double reach_m = 0.012, below_edge_m = 0.005;
  const TessellatedSurface box = tessellated_shape(box_shape({Vector3(0.06, 0.04, 0.04), 0.001}));
  const Vector3 centre_m(0.0, 0.02, 0.02 - below_edge_m);
  ReachRing ring;
  ring.update(box, centre_m, reach_m);
  int over_the_edge = 0;
  for (const std::optional<Vector3>& end : ring.ends_m()) {
    ASSERT_TRUE(end);
    if (end->y() > 0.02 - 1e-4) {
      EXPECT_NEAR((*end - centre_m).norm(), reach_m, 1e-4);
    } else if (end->z() > 0.02 - 1e-4) {
      ++over_the_edge;
      // The edge has a rounding of 2 mm, which shortens the way by (2 - pi / 2) times that.
      const double shorter_m = (2.0 - 0.5 * std::numbers::pi) * 0.002;
      const double over_m = below_edge_m + 0.02 - end->y() - shorter_m;
      EXPECT_NEAR(std::hypot(over_m, end->x()), reach_m, 3e-4);
    }
  }
  EXPECT_GT(over_the_edge, 10);
}

TEST(ReachRing, StaysOnItsSideOfAPlate) {
  constexpr double reach_m = 0.012;
  const TessellatedSurface plate = tessellated_shape(plate_shape({}));
  const Vector3 centre_m(0.01, 0.0015, 0.005);
  ReachRing ring;
  ring.update(plate, centre_m, reach_m);
  for (const std::optional<Vector3>& end : ring.ends_m()) {
    ASSERT_TRUE(end);
    EXPECT_NEAR(end->y(), 0.0015, 1e-5);
    EXPECT_NEAR((*end - centre_m).norm(), reach_m, 1e-5);
  }
}

// Around a bar, lines meet behind it. What they reach by a longer way is left out.
TEST(ReachRing, LeavesOutWhatIsNearerTheOtherWay) {
  constexpr double radius_m = 0.005, reach_m = 0.02;
  const TessellatedSurface bar =
      tessellated_shape(cylinder_shape({.radius_m = radius_m, .height_m = 0.1, .rounding_m = 0.001}));
  const Vector3 centre_m(radius_m, 0.0, 0.0);
  ReachRing ring;
  ring.update(bar, centre_m, reach_m);
  int kept = 0;
  for (const std::optional<Vector3>& end : ring.ends_m()) {
    if (!end) continue;
    ++kept;
    const double around_m = radius_m * std::abs(std::atan2(end->z(), end->x()));
    EXPECT_NEAR(std::hypot(around_m, end->y()), reach_m, 0.12 * reach_m);
  }
  EXPECT_GT(kept, ReachRing::directions / 3);
  EXPECT_LT(kept, ReachRing::directions);
}

TEST(ReachRing, EndsAtTheEdgeOfASheet) {
  const TessellatedSurface sheet = tessellated_shape(sheet_shape(0.1, 0.06));
  const Vector3 centre_m(0.02, 0.0, 0.025);
  ReachRing ring;
  ring.update(sheet, centre_m, 0.01);
  int beyond = 0;
  for (const std::optional<Vector3>& end : ring.ends_m()) {
    if (end) {
      EXPECT_NEAR((*end - centre_m).norm(), 0.01, 1e-6);
    } else {
      ++beyond;
    }
  }
  // The edge is at half the radius, so that it cuts off a third of the circle.
  EXPECT_NEAR(beyond, ReachRing::directions / 3, 1);
  ring.clear();
  for (const std::optional<Vector3>& end : ring.ends_m()) EXPECT_FALSE(end);
}

}  // namespace
}  // namespace spoonbill
