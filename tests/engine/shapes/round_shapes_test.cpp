#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/collision/surfaces/closed_surface.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
double cylinder_distance(const Vector3& p, const CylinderSize& size) {
  const double r = size.rounding_m;
  const double out = std::hypot(p.x(), p.z()) - (size.radius_m - r);
  const double up = std::abs(p.y()) - (0.5 * size.height_m - r);
  return std::hypot(std::max(out, 0.0), std::max(up, 0.0)) + std::min(std::max(out, up), 0.0) - r;
}

// A surface within the tolerance of its shape encloses the shape's volume to within the tolerance times the
// area. Its area differs by a fraction of about twice the tolerance times the mean curvature; that fraction
// is less than a thousandth for these smooth shapes.
void expect_sound(const FittedShape& shape, double volume, double area) {
  EXPECT_LE(shape.deviation_m, shape_tolerance_m);
  EXPECT_NEAR(volume_m3(shape.surface), volume, shape_tolerance_m * area);
  EXPECT_NEAR(area_m2(shape.surface), area, 1e-3 * area);
  EXPECT_FALSE(is_self_intersecting(shape.surface, true));
  EXPECT_LT(seam_jump(shape.surface), 1e-3);
}

TEST(Sphere, IsRound) {
  const FittedShape sphere = fitted(sphere_shape(0.04));
  const auto distance = [](const Vector3& p) { return p.norm() - 0.04; };
  expect_sound(sphere, 4.0 / 3.0 * pi * std::pow(0.04, 3), 4.0 * pi * 0.04 * 0.04);
  EXPECT_LE(largest_distance_m(sphere.surface, distance), shape_tolerance_m);
  EXPECT_GT(least_outward(sphere.surface, distance), 0.9999);
  const Evenness even = evenness(sphere.surface);
  EXPECT_LT(even.along, 1.01);
  EXPECT_LT(even.around, 1.01);
  EXPECT_TRUE(check_closed_tube(sphere.surface).ok());
  EXPECT_LE(sphere.surface.net.rows, 24);
  EXPECT_LE(sphere.surface.net.columns, 24);
}

// The reported deviation must agree with the one found by sampling the surface.
TEST(Sphere, DeviationIsThatOfTheSurface) {
  ShapeFit fit;
  fit.control_counts = {{8, 10}};
  const FittedShape sphere = fitted(sphere_shape(0.04), fit);
  EXPECT_EQ(sphere.surface.net.rows, 8);
  EXPECT_EQ(sphere.surface.net.columns, 10);
  const double found = largest_distance_m(sphere.surface, [](const Vector3& p) { return p.norm() - 0.04; });
  EXPECT_GT(sphere.deviation_m, 0.9 * found);
  EXPECT_LT(sphere.deviation_m, 1.1 * found);
}

TEST(Sphere, AnySizeWithinTheRange) {
  for (const double radius : {1e-4, 1.0, 10.0}) {
    const FittedShape sphere = fitted(sphere_shape(radius));
    EXPECT_LE(sphere.deviation_m, shape_tolerance_m);
  }
  for (const double radius : {0.0, -0.01, 9e-5, 11.0, std::nan(""), HUGE_VAL}) {
    const auto refused = sphere_shape(radius);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::out_of_range) << refused.error().message;
    EXPECT_EQ(refused.error().field, "radius");
  }
}

TEST(Cylinder, IsACylinderWithRoundedEdges) {
  for (const CylinderSize& size :
       {CylinderSize{0.02, 0.06, 0.002}, CylinderSize{0.02, 0.06, 0.02}, CylinderSize{0.05, 0.004, 0.002},
        CylinderSize{0.05, 0.02, 0.0005}, CylinderSize{0.002, 0.2, 0.0005}}) {
    const double R = size.radius_m, r = size.rounding_m, h = size.height_m, c = R - r;
    const FittedShape cylinder = fitted(cylinder_shape(size));
    const auto distance = [&](const Vector3& p) { return cylinder_distance(p, size); };
    // Pappus's theorem: the quarter circles of the rounding have the radius r and the area pi r^2 / 4. Their
    // centroids are 4 r / 3 pi outside the radius c of their centres.
    const double volume = pi * R * R * (h - 2.0 * r) + 2.0 * r * pi * c * c +
                          2.0 * (2.0 * pi * c * 0.25 * pi * r * r + 2.0 / 3.0 * pi * r * r * r);
    const double area = 2.0 * pi * R * (h - 2.0 * r) + 2.0 * pi * c * c +
                        2.0 * (2.0 * pi * c * 0.5 * pi * r + 2.0 * pi * r * r);
    expect_sound(cylinder, volume, area);
    EXPECT_LE(cylinder.surface.net.rows * cylinder.surface.net.columns, 1000);
    EXPECT_LE(largest_distance_m(cylinder.surface, distance), shape_tolerance_m);
    EXPECT_GT(least_outward(cylinder.surface, distance), 0.95);
    const Evenness even = evenness(cylinder.surface);
    EXPECT_LT(even.along, 1.5);
    EXPECT_LT(even.around, 1.05);
  }
}

TEST(Cylinder, RefusesWhatFolds) {
  EXPECT_FALSE(cylinder_shape({0.02, 0.06, 0.021}).ok());
  EXPECT_FALSE(cylinder_shape({0.02, 0.01, 0.0051}).ok());
  EXPECT_FALSE(cylinder_shape({0.02, 0.06, 0.0}).ok());
  EXPECT_FALSE(cylinder_shape({0.02, -0.06, 0.002}).ok());
}

// Returns the signed distance from a cone whose edge and tip are rounded. The nearest of the profile's three
// parts determines it.
double cone_distance(const Vector3& p, const ConeSize& size) {
  const double slope = std::atan2(size.radius_m, size.height_m), r = size.rounding_m, h = size.height_m;
  const Eigen::Vector2d q(std::hypot(p.x(), p.z()), p.y() + 0.5 * h);
  const Eigen::Vector2d outward(std::cos(slope), std::sin(slope));  // normal of the cone's side
  const Eigen::Vector2d down(std::sin(slope), -std::cos(slope));    // direction along the cone's side
  // The rounded cone is the set of points within the distance r of a smaller cone with the same slope. The
  // corners of the smaller cone are the centres of the roundings.
  const Eigen::Vector2d tip(0.0, h - r / std::sin(slope));
  const double edge_x = size.radius_m - r * std::tan(0.25 * pi + 0.5 * slope);
  const Eigen::Vector2d edge(edge_x, r);
  const double side = (q - tip).dot(outward), base = r - q.y();
  if (side <= 0.0 && base <= 0.0) return std::max(side, base) - r;
  const double along = std::clamp((q - tip).dot(down), 0.0, (edge - tip).norm());
  const Eigen::Vector2d on_side = tip + along * down;
  const Eigen::Vector2d on_base(std::clamp(q.x(), 0.0, edge.x()), r);
  return std::min((q - on_side).norm(), (q - on_base).norm()) - r;
}

TEST(Cone, IsAConeWithRoundedEdgeAndTip) {
  for (const ConeSize& size : {ConeSize{0.03, 0.06, 0.0, 0.003}, ConeSize{0.03, 0.01, 0.0, 0.001}}) {
    const FittedShape cone = fitted(cone_shape(size));
    const auto distance = [&](const Vector3& p) { return cone_distance(p, size); };
    EXPECT_LE(cone.deviation_m, shape_tolerance_m);
    EXPECT_LE(cone.surface.net.rows * cone.surface.net.columns, 800);
    EXPECT_LE(largest_distance_m(cone.surface, distance), shape_tolerance_m);
    EXPECT_GT(least_outward(cone.surface, distance), 0.95);
    EXPECT_FALSE(is_self_intersecting(cone.surface, true));
    // The roundings remove a small part of the sharp cone's volume.
    const double sharp = pi / 3.0 * size.radius_m * size.radius_m * size.height_m;
    EXPECT_LT(volume_m3(cone.surface), sharp);
    EXPECT_GT(volume_m3(cone.surface), 0.9 * sharp);
  }
}

TEST(Cone, MayHaveATop) {
  const FittedShape cone = fitted(cone_shape({0.03, 0.04, 0.02, 0.0004}));
  const double sharp = pi / 3.0 * 0.04 * (0.03 * 0.03 + 0.03 * 0.02 + 0.02 * 0.02);
  EXPECT_NEAR(volume_m3(cone.surface), sharp, 0.005 * sharp);
  EXPECT_LT(volume_m3(cone.surface), sharp);
}

TEST(Cone, RefusesRoundingsThatDoNotFit) {
  const auto refused = cone_shape({0.01, 0.1, 0.0, 0.0099});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_range) << refused.error().message;
}

TEST(Torus, IsATorus) {
  const FittedShape torus = fitted(torus_shape({0.04, 0.01}));
  const auto distance = [](const Vector3& p) {
    return std::hypot(std::hypot(p.x(), p.z()) - 0.04, p.y()) - 0.01;
  };
  expect_sound(torus, 2.0 * pi * pi * 0.04 * 0.01 * 0.01, 4.0 * pi * pi * 0.04 * 0.01);
  EXPECT_LE(largest_distance_m(torus.surface, distance), shape_tolerance_m);
  EXPECT_GT(least_outward(torus.surface, distance), 0.999);
  EXPECT_TRUE(torus.surface.u.is_periodic() && torus.surface.v.is_periodic());
}

TEST(Torus, RefusesATubeThatClosesTheHole) {
  const auto refused = torus_shape({0.01, 0.0105});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_range) << refused.error().message;
}

}  // namespace
}  // namespace spoonbill
