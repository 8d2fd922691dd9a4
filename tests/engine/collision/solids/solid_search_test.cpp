// Compares contacts of random surfaces and solids with dense sampling, and tests cases that a search easily
// misses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "engine/collision/solids/implicit_shapes.h"
#include "engine/collision/solids/surface_collider.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/solids/implicit/support_function.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Returns the surface point of least distance from the tool among dense samples, refined around the best
// sample.
Vector3 dense_nearest(const Surface& surface, const ToolShape& tool, int count) {
  double best = 1e300, best_u = 0.0, best_v = 0.0;
  double step_u = (surface.u.domain_end() - surface.u.domain_start()) / count;
  double step_v = (surface.v.domain_end() - surface.v.domain_start()) / count;
  const auto offer = [&](double u, double v) {
    const double distance = tool.distance(position(surface, u, v));
    if (distance >= best) return;
    best = distance;
    best_u = u;
    best_v = v;
  };
  for (int i = 0; i <= count; ++i) {
    for (int j = 0; j <= count; ++j) {
      offer(surface.u.domain_start() + i * step_u, surface.v.domain_start() + j * step_v);
    }
  }
  for (int round = 0; round < 16; ++round, step_u *= 0.6, step_v *= 0.6) {
    const double u = best_u, v = best_v;
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j) {
        offer(surface.u.into_domain(u + i * step_u), surface.v.into_domain(v + j * step_v));
      }
    }
  }
  return position(surface, best_u, best_v);
}

KnotVector random_knots_to_degree_5(Random& random) {
  const KnotKind kinds[] = {KnotKind::clamped, KnotKind::unclamped, KnotKind::periodic};
  const int degree = random.integer(1, 5);
  return random_knots(random, degree, kinds[random.integer(0, 2)]);
}

// Returns a pose that brings a random point of the surface near or into the solid.
Pose pose_near_contact(Random& random, const Surface& surface, const Box& bounds) {
  const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
  const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
  const Quaternion turn = random_turn(random);
  const Vector3 inside = 0.5 * (bounds.low + bounds.high) +
                         0.7 * (bounds.high - bounds.low).cwiseProduct(random_in_cube(random));
  return {position(surface, u, v) - turn * inside, turn};
}

TEST(SolidSearch, AgreesWithDenseSampling) {
  const int trials = random_cases(500, 10000);
  Random random(51);
  int touching = 0;
  for (int trial = 0; trial < trials; ++trial) {
    KnotVector u = random_knots_to_degree_5(random), v = random_knots_to_degree_5(random);
    const Surface surface = random_surface(random, std::move(u), std::move(v));
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, random.integer(0, 2)).value();
    SurfaceCollider collider(nested);
    const int kind = trial % (convex_shape_kinds + 1);
    const ImplicitShape shape = kind == convex_shape_kinds
                                    ? TorusShape{random.uniform(0.02, 0.3), 0.002 + 0.001 * (trial % 16)}
                                    : random_convex_shape(random, kind);
    const auto solid = make_signed_distance(shape);
    const Pose pose = pose_near_contact(random, surface, solid->bounds());
    const ToolShape tool = ToolShape::solid(*solid, pose);
    const CollisionResult result = collider.collide(surface, tool, 0.0, false);
    // The distance function of a superquadric takes a hundred times as long as those of other shapes, so
    // fewer samples are used. It may also overstate the depth. If the reference is deeper than the result, it
    // is therefore computed again from the support function.
    const Vector3 at = dense_nearest(surface, tool, kind == 6 ? 30 : 120);
    double reference = tool.distance(at);
    if (kind == 6 && reference < std::min(-result.nearest.depth_m, 0.0) - 1e-6) {
      reference = distance_by_support(shape, tool.into_frame(at));
    }
    ASSERT_FALSE(result.overflow) << trial;
    EXPECT_EQ(result.found, -result.nearest.depth_m <= 0.0) << trial;
    EXPECT_NEAR(-result.nearest.depth_m, tool.distance(result.nearest.point_m), 1e-15) << trial;
    EXPECT_LT((position(surface, result.nearest.u, result.nearest.v) - result.nearest.point_m).norm(), 1e-12);
    touching += result.found ? 1 : 0;
    if (!result.found) {
      EXPECT_GT(reference, -1e-6) << trial << " kind " << kind;
    } else {
      EXPECT_LE(-result.nearest.depth_m, reference + 2e-5) << trial << " kind " << kind;
    }
  }
  EXPECT_GT(touching, trials / 4);
  EXPECT_LT(touching, trials);
}

// A signed distance that guarantees only one thing: it changes by no more than the point moves.
class BareTorus final : public SignedDistance {
 public:
  DistanceSample at(const Vector3& point_m) const override { return torus_->at(point_m); }
  bool is_convex() const override { return false; }
  Box bounds() const override { return torus_->bounds(); }

 private:
  std::shared_ptr<const SignedDistance> torus_ = make_signed_distance(TorusShape{0.03, 0.006});
};

TEST(SolidSearch, ASolidOfWhichLittleIsKnownIsFoundToItsWiderTolerance) {
  Random random(52);
  const BareTorus torus;
  for (int trial = 0; trial < 40; ++trial) {
    const Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
    SurfaceCollider collider(nested);
    const ToolShape tool = ToolShape::solid(torus, pose_near_contact(random, surface, torus.bounds()));
    const CollisionResult result = collider.collide(surface, tool, 0.0, false);
    const double reference = tool.distance(dense_nearest(surface, tool, 120));
    EXPECT_FALSE(result.overflow) << trial;
    if (result.found || reference < -1e-6) {
      ASSERT_TRUE(result.found) << trial;
      EXPECT_LE(-result.nearest.depth_m, reference + 5e-5) << trial;
    }
  }
}

// The axis of a needle, which is thinner than any cell, passes through a random point of the surface.
TEST(SolidSearch, ANeedleBetweenSamplesIsFound) {
  Random random(53);
  const auto needle = make_signed_distance(CapsuleShape{1e-4, 0.05});
  for (int trial = 0; trial < 60; ++trial) {
    const Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 1).value();
    SurfaceCollider collider(nested);
    const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
    const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
    const Quaternion turn = random_turn(random);
    const Vector3 through = position(surface, u, v) + turn * Vector3(0.0, random.uniform(-0.04, 0.04), 0.0);
    const CollisionResult result =
        collider.collide(surface, ToolShape::solid(*needle, {through, turn}), 0.0, false);
    EXPECT_TRUE(result.found) << trial;
    EXPECT_NEAR(result.nearest.depth_m, 1e-4, 2e-5) << trial;
  }
}

CollisionResult search(const Surface& surface, const ImplicitShape& shape, const Pose& pose, bool closed,
                       double margin_m = 0.0) {
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
  SurfaceCollider collider(nested);
  const auto solid = make_signed_distance(shape);
  CollisionResult result = collider.collide(surface, ToolShape::solid(*solid, pose), margin_m, closed);
  EXPECT_FALSE(result.overflow);
  return result;
}

TEST(SolidSearch, AToolFarLargerThanTheModelIsFound) {
  const Surface body = ellipsoid_tube(12, 12);
  double top = 0.0;
  for (int k = 0; k < 1000000; ++k) top = std::max(top, position(body, 1e-6 * k, 0.5).y());
  const CollisionResult pressed =
      search(body, BoxShape{Vector3::Constant(0.5)}, {{0.1, top + 0.499, 0.2}, Quaternion::Identity()}, true);
  ASSERT_TRUE(pressed.found);
  EXPECT_NEAR(pressed.nearest.depth_m, 0.001, 1e-9);
  EXPECT_GT(pressed.nearest.normal.y(), 0.99);
  EXPECT_FALSE(
      search(body, BoxShape{Vector3::Constant(0.5)}, {{0.1, top + 0.501, 0.2}, Quaternion::Identity()}, true)
          .found);
}

// The tool is completely inside the tube and does not touch its surface. The result is the displacement
// through the nearest wall, along the wall's normal.
TEST(SolidSearch, AToolWhollyInsideIsFoundWithItsWayOut) {
  const Surface tube = round_tube(0.02, 0.06);
  const ImplicitShape shapes[] = {
      BoxShape{{0.002, 0.003, 0.004}}, ConeShape{0.002, 0.005},
      CapsuleShape{0.001, 0.002},      EllipsoidShape{{0.002, 0.004, 0.001}},
      TorusShape{0.003, 0.001},        SuperquadricShape{{0.002, 0.003, 0.001}, 0.4, 1.5}};
  Random random(54);
  for (const ImplicitShape& shape : shapes) {
    for (int trial = 0; trial < 10; ++trial) {
      const Quaternion turn = random_turn(random);
      const Pose pose{{0.03 * random.uniform(-1.0, 1.0), 0.0005 * trial, 0.006}, turn};
      const CollisionResult result = search(tube, shape, pose, true);
      ASSERT_TRUE(result.found) << shape.index();
      const SurfaceContact& wall = result.nearest;
      // The depth is the distance by which the solid reaches behind the wall's tangent plane. It is computed
      // with the support function of the solid.
      const double behind =
          wall.normal.dot(wall.point_m - pose.position_m) + support(shape, turn.conjugate() * -wall.normal);
      EXPECT_NEAR(wall.depth_m, behind, 2e-7) << shape.index();
      EXPECT_GT(wall.depth_m, 0.02 - 0.015) << shape.index();
      EXPECT_FALSE(search(tube, shape, pose, false).found) << shape.index();
    }
  }
}

TEST(SolidSearch, TouchingAnEdgeAPoleOrByATangentIsFound) {
  const Surface sheet = quadric_sheet(0.1, 0.0, 0.0, 8);
  const Quaternion none = Quaternion::Identity();
  // The tool is beyond the sheet's edge, then beyond its corner.
  const CollisionResult edge =
      search(sheet, CapsuleShape{0.01, 0.02}, {{0.1 + 0.0099, 0.0, 0.03}, none}, false);
  ASSERT_TRUE(edge.found);
  EXPECT_NEAR(edge.nearest.depth_m, 1e-4, 1e-9);
  const CollisionResult corner =
      search(sheet, SphereShape{0.01}, {{0.1 + 0.0069, 0.0, 0.1 + 0.0069}, none}, false);
  ASSERT_TRUE(corner.found);
  EXPECT_NEAR(corner.nearest.depth_m, 0.01 - 0.0069 * std::sqrt(2.0), 1e-9);
  // The tool is beyond a pole, where all values of u are one point.
  for (const bool turned : {false, true}) {
    const Surface tube = ellipsoid_tube(12, 12), body = turned ? transposed(tube) : tube;
    // The transposed surface has inward normals, so it is not passed as a closed one.
    const CollisionResult pole =
        search(body, BoxShape{Vector3::Constant(0.01)}, {{0.0, 0.0, 0.05 + 0.0095}, none}, !turned);
    ASSERT_TRUE(pole.found);
    EXPECT_NEAR(pole.nearest.depth_m, 5e-4, 1e-9);
    const SurfaceContact& at = pole.nearest;
    EXPECT_NEAR(std::abs(at.normal.z()), 1.0, 1e-6);
    EXPECT_NEAR(at.tangent_u.norm(), 1.0, 1e-12);
    EXPECT_NEAR(at.tangent_v.norm(), 1.0, 1e-12);
    EXPECT_NEAR(at.tangent_u.dot(at.normal), 0.0, 1e-9);
    EXPECT_NEAR(at.tangent_u.dot(at.tangent_v), 0.0, 1e-9);
  }
  // The solid is almost tangent, slightly inside or slightly outside.
  for (const double gap : {-2e-6, 3e-6}) {
    EXPECT_EQ(search(sheet, CylinderShape{0.01, 0.02}, {{0.0, 0.02 + gap, 0.0}, none}, false).found,
              gap < 0.0);
  }
}

TEST(SolidSearch, AllocatesNothing) {
  const Surface body = ellipsoid_tube(16, 16);
  const NestedGrid nested = make_nested_grid(body.u, body.v, 2).value();
  SurfaceCollider collider(nested);
  Random random(55);
  for (int kind = 0; kind <= convex_shape_kinds; ++kind) {
    const auto solid = make_signed_distance(kind == convex_shape_kinds ? TorusShape{0.02, 0.003}
                                                                       : random_convex_shape(random, kind));
    const std::size_t before = allocation_count();
    for (int k = 0; k < 5; ++k) {
      const Vector3 at(0.004 * k, 0.012, 0.005 * k);
      const ToolShape tool = ToolShape::solid(*solid, {at, Quaternion::Identity()});
      (void)collider.collide(body, tool, 0.002, true);
      (void)collider.find_contact_regions(tool);
    }
    EXPECT_EQ(allocation_count(), before) << kind;
  }
}

}  // namespace
}  // namespace spoonbill
