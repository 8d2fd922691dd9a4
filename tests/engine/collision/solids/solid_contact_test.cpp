// Tests contacts of solids with surfaces against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/collision/solids/implicit_shapes.h"
#include "engine/collision/solids/surface_collider.h"
#include "tests/engine/collision/solids/implicit/support_function.h"
#include "tests/engine/collision/surfaces/sheets.h"

namespace spoonbill {
namespace {

struct SolidCase {
  Surface surface;
  ImplicitShape shape;
  Pose pose;
  double margin_m = 0.02;
  bool closed = false;
};

struct SolidAnswer {
  CollisionResult result;
  double size;
};

SolidAnswer ask(const SolidCase& contact, int levels = 2) {
  const NestedGrid nested = make_nested_grid(contact.surface.u, contact.surface.v, levels).value();
  SurfaceCollider collider(nested);
  EXPECT_TRUE(check_implicit_shape(contact.shape).ok());
  const auto solid = make_signed_distance(contact.shape);
  const Box bounds = solid->bounds();
  return {collider.collide(contact.surface, ToolShape::solid(*solid, contact.pose), contact.margin_m,
                           contact.closed),
          std::isfinite(bounds.size()) ? bounds.size() : 0.1};
}

void expect_contact(const SolidCase& contact, double depth, const Vector3& normal) {
  const SolidAnswer answer = ask(contact);
  ASSERT_TRUE(answer.result.found);
  EXPECT_FALSE(answer.result.overflow);
  EXPECT_NEAR(answer.result.nearest.depth_m, depth, 1e-6 * answer.size);
  EXPECT_LT((answer.result.nearest.normal - normal).norm(), 1e-6);
}

Quaternion about(const Vector3& axis, double angle) {
  return Quaternion(Eigen::AngleAxisd(angle, axis.normalized()));
}

Surface flat() {
  return quadric_sheet(0.1, 0.0, 0.0, 12);
}

constexpr double right = 0.5 * std::numbers::pi;

TEST(SolidContact, SphereOnAPlane) {
  expect_contact({flat(), SphereShape{0.02}, {{0.013, 0.018, 0.021}, {}}}, 0.002, Vector3::UnitY());
  expect_contact({flat(), SphereShape{0.02}, {{0.013, 0.023, 0.021}, {}}}, -0.003, Vector3::UnitY());
}

// The centre of a sphere is at height c above the lowest point of the bowl y = b r^2. While c < 1 / (2 b),
// this lowest point is the nearest to the centre; beyond, the nearest points form a ring.
TEST(SolidContact, SphereInABowl) {
  const double bend = 20.0;
  const Surface bowl = quadric_sheet(0.08, bend, bend, 14);
  expect_contact({bowl, SphereShape{0.02}, {{0.0, 0.0185, 0.0}, {}}}, 0.0015, Vector3::UnitY());
  const double height = 0.04, square = (height - 0.5 / bend) / bend;
  const double ring = std::sqrt(square + (bend * square - height) * (bend * square - height));
  const SolidAnswer answer = ask({bowl, SphereShape{0.03}, {{0.0, height, 0.0}, {}}});
  EXPECT_NEAR(answer.result.nearest.depth_m, 0.03 - ring, 1e-6 * answer.size);
  const Vector3 at = answer.result.nearest.point_m, normal(-2.0 * bend * at.x(), 1.0, -2.0 * bend * at.z());
  EXPECT_NEAR(at.x() * at.x() + at.z() * at.z(), square, 1e-8);
  EXPECT_LT((answer.result.nearest.normal - normal.normalized()).norm(), 1e-6);
}

TEST(SolidContact, CylinderInAGutter) {
  const double bend = 20.0;
  const Surface gutter = quadric_sheet(0.08, bend, 0.0, 14);
  const Quaternion along_z = about(Vector3::UnitX(), right);
  expect_contact({gutter, CylinderShape{0.02, 0.05}, {{0.0, 0.0185, 0.0}, along_z}}, 0.0015,
                 Vector3::UnitY());
  const double height = 0.04, square = (height - 0.5 / bend) / bend;
  const double line = std::sqrt(square + (bend * square - height) * (bend * square - height));
  const SolidAnswer answer = ask({gutter, CylinderShape{0.03, 0.05}, {{0.0, height, 0.0}, along_z}});
  EXPECT_NEAR(answer.result.nearest.depth_m, 0.03 - line, 1e-6 * answer.size);
}

TEST(SolidContact, CylinderAcrossACylinder) {
  const Surface tube = round_tube(0.02, 0.06);
  const Quaternion along_z = about(Vector3::UnitX(), right);
  for (const double depth : {0.001, -0.004}) {
    expect_contact({tube, CylinderShape{0.015, 0.05}, {{0.013, 0.035 - depth, 0.0}, along_z}}, depth,
                   Vector3::UnitY());
  }
}

// Two linked rings, one shifted so that the tubes touch or nearly touch on one side. Before the shift, every
// point of the tool's ring is equally far from the other ring.
TEST(SolidContact, TorusLinkedWithATorus) {
  const Surface ring = round_torus(0.06, 0.01);
  const Quaternion upright = about(Vector3::UnitX(), right);
  for (const double shift : {0.008, 0.0121, 0.0119, 0.015}) {
    const double depth = shift - (0.03 - 0.01 - 0.008);
    expect_contact({ring, TorusShape{0.03, 0.008}, {{0.06 + shift, 0.0, 0.0}, upright}, 0.005, true}, depth,
                   -Vector3::UnitX());
  }
}

// The depth is the largest distance of a point of the surface inside the box from the nearest face of the
// box. It is therefore less than the distance by which an edge or a corner is below the plane.
TEST(SolidContact, BoxOnAPlaneByFaceEdgeAndCorner) {
  const Vector3 half(0.02, 0.03, 0.025);
  const double depth = 0.002;
  const auto box = [&](const Quaternion& turn, double lowest, double expected) {
    const Vector3 at(0.0071, lowest - depth, 0.0043);
    expect_contact({flat(), BoxShape{half}, {at, turn}}, expected, Vector3::UnitY());
  };
  box(Quaternion::Identity(), 0.03, depth);
  box(about(Vector3::UnitY(), 0.3), 0.03, depth);
  for (const double tilt : {0.25 * std::numbers::pi, 0.5}) {
    // The deepest point, below the edge, is equally far from the two faces that meet at the edge.
    const double lowest = half.y() * std::cos(tilt) + half.x() * std::sin(tilt);
    const double width = depth * (1.0 / std::tan(tilt) + std::tan(tilt));
    const double expected = width * std::sin(tilt) * std::cos(tilt) / (std::sin(tilt) + std::cos(tilt));
    box(about(Vector3::UnitZ(), tilt), lowest, expected);
  }
  const Quaternion corner =
      Quaternion::FromTwoVectors(Vector3(1.0, 1.0, 1.0).normalized(), -Vector3::UnitY());
  box(corner, half.sum() / std::sqrt(3.0), depth / std::sqrt(3.0));
}

// An edge of the box presses on the top of a dome, which falls away along the edge and to both sides of it.
TEST(SolidContact, BoxEdgeOnADome) {
  const double depth = 0.002;
  const Surface dome = quadric_sheet(0.1, -3.0, -5.0, 12);
  const Quaternion tilted = about(Vector3::UnitZ(), 0.25 * std::numbers::pi);
  for (const double turn : {0.0, 0.7}) {
    const Pose pose{{0.0, 0.02 * std::sqrt(2.0) - depth, 0.0}, about(Vector3::UnitY(), turn) * tilted};
    expect_contact({dome, BoxShape{Vector3::Constant(0.02)}, pose}, depth / std::sqrt(2.0), Vector3::UnitY());
  }
}

TEST(SolidContact, ConesTipOnAPlane) {
  const double depth = 0.003;
  const Pose pose{{0.011, 0.04 - depth, 0.007}, about(Vector3::UnitX(), std::numbers::pi)};
  expect_contact({flat(), ConeShape{0.015, 0.04}, pose}, depth * 0.015 / std::hypot(0.015, 0.04),
                 Vector3::UnitY());
}

TEST(SolidContact, EllipsoidOnAPlane) {
  expect_contact({flat(), EllipsoidShape{{0.03, 0.02, 0.01}}, {{0.013, 0.018, 0.021}, {}}}, 0.002,
                 Vector3::UnitY());
}

TEST(SolidContact, HalfSpaceOnADome) {
  const Surface dome = quadric_sheet(0.1, -3.0, -5.0, 12);
  expect_contact({dome, HalfSpaceShape{}, {{0.02, -0.004, 0.0}, about(Vector3::UnitX(), std::numbers::pi)}},
                 0.004, Vector3::UnitY());
}

// A convex solid's height above a plane is given by its support function.
TEST(SolidContact, ConvexSolidsAboveAPlaneAreAsHighAsTheirSupport) {
  Random random(41);
  const Surface sheet = quadric_sheet(0.5, 0.0, 0.0, 12);
  for (int trial = 0; trial < 210; ++trial) {
    const ImplicitShape shape = random_convex_shape(random, trial % convex_shape_kinds);
    const Vector3 axis = random_direction(random);
    const Quaternion turn = about(axis, random.uniform(0.0, 3.0));
    const double gap = random.uniform(1e-4, 0.01);
    const double lowest = support(shape, turn.conjugate() * -Vector3::UnitY());
    SCOPED_TRACE(trial);
    expect_contact({sheet, shape, {{0.05, lowest + gap, -0.03}, turn}}, -gap, Vector3::UnitY());
  }
}

TEST(SolidContact, TangentsSpanThePlane) {
  const SolidAnswer answer =
      ask({quadric_sheet(0.08, 20.0, 5.0, 14), SphereShape{0.02}, {{0.03, 0.03, 0.01}, {}}});
  const SurfaceContact& at = answer.result.nearest;
  const SurfacePoint point = evaluate(quadric_sheet(0.08, 20.0, 5.0, 14), at.u, at.v);
  EXPECT_LT((at.tangent_u - point.du.normalized()).norm(), 1e-12);
  EXPECT_LT((at.tangent_v - at.normal.cross(at.tangent_u)).norm(), 1e-15);
  EXPECT_NEAR(at.normal.dot(at.tangent_u), 0.0, 1e-15);
  EXPECT_NEAR(at.tangent_v.norm(), 1.0, 1e-14);
}

}  // namespace
}  // namespace spoonbill
