// Stock shapes, from which a design starts, made from their sizes. Each shape is centred at the origin.
#pragma once

#include <variant>

#include "engine/base/result.h"
#include "engine/shapes/bowl.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// A box along x, y and z with rounded edges. The poles are the centres of its two end faces. The end faces
// are at the ends of the longest side, unless these faces are slender and the faces at the ends of the
// shortest side are squarer. The edges around the end faces have the radius `rounding_m`. The four edges
// between the end faces have twice this radius, but at most half the shortest side. The corners are parts of
// tori.
struct BoxSize {
  Vector3 size_m{0.06, 0.04, 0.02};
  // Radius of the rounding, at most max_box_rounding_fraction of the shortest side.
  double rounding_m = 0.002;
};
inline constexpr double max_box_rounding_fraction = 0.4;

Result<ExactShape> box_shape(const BoxSize& size);
// Returns the default rounding of a box: a tenth of its shortest side.
double default_rounding_m(const BoxSize& size);

// A closed horizontal slab with poles at the centres of its faces and a half-round rim.
struct PlateSize {
  double x_size_m = 0.1, z_size_m = 0.06, thickness_m = 0.003;
  double corner_m = 0.006;  // radius of the plate's four corners seen from above, at least the thickness
};
// Refuses a thickness of more than half the width, and a corner radius that is below the thickness or above
// half the width. The width is the shorter of the two sides.
Result<ExactShape> plate_shape(const PlateSize& size);
// Returns the default corner radius of a plate: the thickness or a tenth of the shorter side, whichever is
// larger.
double default_corner_m(const PlateSize& size);

// Makes a horizontal open sheet. u runs along +x and v along -z, so that the normals point up.
Result<ExactShape> sheet_shape(double x_size_m, double z_size_m);

Result<ExactShape> sphere_shape(double radius_m);

// A cylinder along y.
struct CylinderSize {
  double radius_m = 0.02, height_m = 0.06;
  // Radius of the rounding of both edges, at most the radius and half the height of the cylinder.
  double rounding_m = 0.002;
};
Result<ExactShape> cylinder_shape(const CylinderSize& size);

// A cone along y, or a truncated cone if the top radius is not 0. Radii and height are those of the cone
// before rounding; the roundings remove material. `rounding_m` applies to the edge and the tip, or to both
// edges of a truncated cone.
struct ConeSize {
  double radius_m = 0.03, height_m = 0.06;
  double top_radius_m = 0.0;
  double rounding_m = 0.003;
};
Result<ExactShape> cone_shape(const ConeSize& size);

// A horizontal torus, which is closed in both directions: u runs around the tube, v around the ring.
struct TorusSize {
  double ring_radius_m = 0.04, tube_radius_m = 0.01;
};
// Refuses a tube so wide that it closes the hole of the ring.
Result<ExactShape> torus_shape(const TorusSize& size);

// Returns the default rounding: a tenth of the shortest side, which is the height or the diameter of an end.
double default_rounding_m(const CylinderSize& size);
double default_rounding_m(const ConeSize& size);

struct SphereSize {
  double radius_m = 0.03;
};

struct SheetSize {
  double x_size_m = 0.1, z_size_m = 0.06;
};

// Sizes of any stock shape, which determine its kind.
using StockShapeSize =
    std::variant<SphereSize, BoxSize, CylinderSize, ConeSize, PlateSize, SheetSize, TorusSize, BowlSize>;

// Makes a stock shape. Refuses a size that is out of range, and names the size.
Result<ExactShape> stock_shape(const StockShapeSize& size);

// Returns the reach of the shape (Federer 1959): every point nearer to the shape than this distance has
// exactly one nearest point on it. A fitted surface that is nearer to the shape than the reach and does not
// fold cannot touch itself. The reach is infinite for a sheet.
double reach_m(const StockShapeSize& size);

// Returns the degree with which a shape is fitted. It is 5 for shapes of revolution: with twelve spans around
// a circle, the error of the curvature is then 0.01 %, compared with 2 % for degree 3. It is 3 for other
// shapes, so that a control point affects a smaller part of the surface.
int stock_shape_degree(const StockShapeSize& size);

// Returns the default tolerance of a stock shape's fit. It is 0.01 mm in general, a thousandth of the longest
// side if that side is shorter than 10 mm, and a hundred-thousandth of the shortest side if that side is
// longer than 1 m.
double default_tolerance_m(const ExactShape& shape);

}  // namespace spoonbill
