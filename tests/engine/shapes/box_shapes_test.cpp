#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/collision/surfaces/closed_surface.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
// The rounding of a box or plate. Along `axis`, the outline is a rectangle whose corners are rounded by
// `edge_m`. The edges between the end faces and the sides are rounded by `end_m`.
struct Rounded {
  Vector3 size_m;
  int axis;
  double edge_m, end_m;
};

double box_distance(const Vector3& p, const Rounded& box) {
  const auto beyond = [&](int a) { return std::abs(p[a]) - (0.5 * box.size_m[a] - box.edge_m); };
  const Eigen::Vector2d q(beyond((box.axis + 1) % 3), beyond((box.axis + 2) % 3));
  const double out = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - (box.edge_m - box.end_m);
  const double up = std::abs(p[box.axis]) - (0.5 * box.size_m[box.axis] - box.end_m);
  return std::hypot(std::max(out, 0.0), std::max(up, 0.0)) + std::min(std::max(out, up), 0.0) - box.end_m;
}

// The expected volume follows from the section's area A and perimeter P by Steiner's formula in each slice:
// an outline moved inwards by d encloses A - d P + pi d^2. The expected area follows from the outline's
// perimeter P - 2 pi d.
void expect_box(const FittedShape& shape, const Rounded& box, double most_uneven_along = 2.5) {
  const double x = box.size_m[(box.axis + 1) % 3], y = box.size_m[(box.axis + 2) % 3];
  const double r = box.end_m, length = box.size_m[box.axis] - 2.0 * r;
  const double a = x * y - (4.0 - pi) * box.edge_m * box.edge_m;
  const double perimeter = 2.0 * (x + y) - (8.0 - 2.0 * pi) * box.edge_m;
  // Along the quarter circle of the rounding, of radius r, the outline is moved inwards by d = r (1 - cos).
  // `first` and `second` are the integrals of d and d^2 over the circle's height; `arc_first` is the integral
  // of d over its length.
  const double first = r * r * (1.0 - 0.25 * pi), second = r * r * r * (5.0 / 3.0 - 0.5 * pi);
  const double arc = 0.5 * pi * r, arc_first = r * r * (0.5 * pi - 1.0);
  const double volume = a * length + 2.0 * (a * r - perimeter * first + pi * second);
  const double area = perimeter * length + 2.0 * (perimeter * arc - 2.0 * pi * arc_first) +
                      2.0 * (a - perimeter * r + pi * r * r);
  const auto distance = [&](const Vector3& p) { return box_distance(p, box); };
  EXPECT_LE(shape.deviation_m, shape_tolerance_m);
  EXPECT_LE(shape.surface.net.columns, 60);
  EXPECT_LE(largest_distance_m(shape.surface, distance), shape_tolerance_m);
  EXPECT_NEAR(volume_m3(shape.surface), volume, shape_tolerance_m * area);
  EXPECT_NEAR(area_m2(shape.surface), area, 1e-3 * area);
  EXPECT_GT(least_outward(shape.surface, distance), 0.9);
  EXPECT_FALSE(is_self_intersecting(shape.surface, true));
  EXPECT_LT(seam_jump(shape.surface), 1e-3);
  const Evenness even = evenness(shape.surface);
  EXPECT_LT(even.along, most_uneven_along);
  EXPECT_LT(even.around, 1.5);
  const Status closed = check_closed_tube(shape.surface);
  EXPECT_TRUE(closed.ok()) << closed.error().message;
}

TEST(Box, IsWhatItIsAskedFor) {
  for (const BoxSize& size : {BoxSize{{0.06, 0.04, 0.02}, 0.003}, BoxSize{{0.04, 0.04, 0.04}, 0.004},
                              BoxSize{{0.02, 0.1, 0.02}, 0.008}, BoxSize{{0.06, 0.04, 0.02}, 0.0005}}) {
    int longest = 0;
    size.size_m.maxCoeff(&longest);
    const double edge = std::min(2.0 * size.rounding_m, 0.5 * size.size_m.minCoeff());
    expect_box(fitted(box_shape(size)), {size.size_m, longest, edge, size.rounding_m});
  }
}

TEST(Box, ThatIsFlatHasItsPolesInTheLargeFaces) {
  expect_box(fitted(box_shape({{0.1, 0.06, 0.002}, 0.0002})), {{0.1, 0.06, 0.002}, 2, 0.0004, 0.0002});
  expect_box(fitted(box_shape({{0.1, 0.03, 0.01}, 0.001})), {{0.1, 0.03, 0.01}, 0, 0.002, 0.001});
}

// The rounding may be up to two fifths of the shortest side. Then only strips of the end faces are flat, and
// lines from the poles are longer along a strip than across it.
TEST(Box, MayBeRoundedFarIn) {
  for (const BoxSize& size : {BoxSize{{0.06, 0.04, 0.02}, 0.007}, BoxSize{{0.06, 0.04, 0.02}, 0.0075},
                              BoxSize{{0.06, 0.04, 0.02}, 0.008}, BoxSize{{0.04, 0.0399, 0.02}, 0.008},
                              BoxSize{{0.06, 0.059, 0.02}, 0.008}, BoxSize{{0.1, 0.06, 0.05}, 0.02}}) {
    const double edge = 0.5 * size.size_m.minCoeff(), rounding = size.rounding_m;
    const double left_of_second = size.size_m.y() - 2.0 * rounding, left = 2.0 * (edge - rounding);
    expect_box(fitted(box_shape(size)), {size.size_m, 0, edge, rounding}, 2.0 * left_of_second / left);
  }
}

// The box may have any proportions: even the rounding of a thin box, which is tiny beside a long side, must
// be fitted.
TEST(Box, MayBeLongOrWideOrBoth) {
  for (const Vector3& size_m :
       {Vector3(1.0, 0.001, 0.001), Vector3(0.1, 0.1, 0.001), Vector3(1.0, 1.0, 0.001),
        Vector3(10.0, 10.0, 10.0), Vector3(0.3, 0.02, 0.003)}) {
    BoxSize size{size_m};
    size.rounding_m = default_rounding_m(size);
    const auto shape = box_shape(size);
    ASSERT_TRUE(shape) << shape.error().message;
    ShapeFit fit;
    fit.tolerance_m = default_tolerance_m(shape.value());
    const FittedShape box = fitted(shape, fit);
    EXPECT_LE(box.deviation_m, fit.tolerance_m);
    EXPECT_NEAR(volume_m3(box.surface), size_m.prod(), 0.06 * size_m.prod());
    EXPECT_FALSE(is_self_intersecting(box.surface, true));
  }
}

// Slender end faces must be exactly flat: ripples that a fit leaves there would be sharp dimples.
TEST(Box, HasFlatEndFaces) {
  for (const BoxSize& size : {BoxSize{{0.3, 0.02, 0.003}, 0.0003}, BoxSize{{0.06, 0.04, 0.02}, 0.008}}) {
    const auto shape = box_shape(size);
    const Surface box = fitted(shape).surface;
    const double to = shape->flat_to.value(), from = shape->flat_from.value(), half = 0.5 * size.size_m.x();
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j <= 10; ++j) {
        EXPECT_NEAR(position(box, i / 40.0, to * j / 10.0).x(), -half, 1e-12);
        EXPECT_NEAR(position(box, i / 40.0, from + (1.0 - from) * j / 10.0).x(), half, 1e-12);
      }
    }
  }
}

TEST(Plate, MayBeLong) {
  PlateSize size{1.0, 0.01, 0.002};
  size.corner_m = default_corner_m(size);
  const FittedShape plate = fitted(plate_shape(size));
  EXPECT_LE(plate.deviation_m, shape_tolerance_m);
  EXPECT_LT(plate.surface.net.size(), 3000U);
}

TEST(Plate, IsASlabWithAHalfRoundRim) {
  for (const PlateSize& size : {PlateSize{0.1, 0.06, 0.003, 0.006}, PlateSize{0.1, 0.1, 0.001, 0.05},
                                PlateSize{0.3, 0.2, 0.002, 0.02}, PlateSize{0.02, 0.02, 0.01, 0.01}}) {
    const Vector3 sides(size.x_size_m, size.thickness_m, size.z_size_m);
    expect_box(fitted(plate_shape(size)), {sides, 1, size.corner_m, 0.5 * size.thickness_m});
  }
}

TEST(Plate, RefusesWhatFolds) {
  EXPECT_FALSE(plate_shape({0.1, 0.06, 0.031, 0.031}).ok());
  EXPECT_FALSE(plate_shape({0.1, 0.06, 0.003, 0.002}).ok());
  EXPECT_FALSE(plate_shape({0.1, 0.06, 0.003, 0.031}).ok());
}

TEST(Box, RefusesSizesThatMakeNone) {
  EXPECT_FALSE(box_shape({{0.06, 0.04, 0.02}, 0.0081}).ok());
  EXPECT_FALSE(box_shape({{0.06, 0.04, 0.02}, 0.0}).ok());
  EXPECT_FALSE(box_shape({{0.06, 0.0, 0.02}, 0.001}).ok());
  EXPECT_FALSE(box_shape({{0.06, std::nan(""), 0.02}, 0.001}).ok());
}

TEST(Sheet, IsFlatAndOpen) {
  const FittedShape sheet = fitted(sheet_shape(0.1, 0.06));
  EXPECT_NEAR(area_m2(sheet.surface), 0.006, 1e-9);
  EXPECT_LT(sheet.deviation_m, 1e-12);
  EXPECT_FALSE(sheet.surface.u.is_periodic() || sheet.surface.v.is_periodic());
  EXPECT_GT(unit_normal(sheet.surface, 0.3, 0.4).y(), 0.999999);
}

}  // namespace
}  // namespace spoonbill
