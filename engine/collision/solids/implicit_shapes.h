// Analytic tool shapes as plain structs, and their signed distances. Lengths are in metres. Each shape is
// described in its own frame and is centred on the origin unless its comment says otherwise.
#pragma once

#include <array>
#include <memory>
#include <variant>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

struct SphereShape {
  double radius_m = 0.01;  // 0 for a point
};

struct EllipsoidShape {
  Vector3 semi_axes_m = Vector3::Constant(0.01);  // the ratio of any two must be at most greatest_axis_ratio
};

struct CylinderShape {  // along the y axis
  double radius_m = 0.01, half_length_m = 0.01;
};

// Points within radius_m of the segment from -half_length_m to half_length_m on the y axis.
struct CapsuleShape {
  double radius_m = 0.01, half_length_m = 0.01;
};

struct BoxShape {
  Vector3 half_extents_m = Vector3::Constant(0.01);
};

struct ConeShape {  // along the y axis: base centred on the origin, tip at (0, height_m, 0)
  double base_radius_m = 0.01, height_m = 0.02;
};

struct TorusShape {  // around the y axis; tube_radius_m must be less than ring_radius_m
  double ring_radius_m = 0.02, tube_radius_m = 0.005;
};

struct HalfSpaceShape {};  // the half-space y < 0

// Superquadric with the semi-axes a, b, c and the exponents e1, e2 (Barr 1981, with y in place of his z):
//   (|x / a|^(2 / e2) + |z / c|^(2 / e2))^(e2 / e1) + |y / b|^(2 / e1) <= 1.
// It is convex over the allowed range of the exponents: nearly a box at the low end, an ellipsoid at 1,
// nearly an octahedron at the high end.
struct SuperquadricShape {
  Vector3 semi_axes_m = Vector3::Constant(0.01);  // the ratio of any two must be at most greatest_axis_ratio
  double exponent_along = 1.0;                    // exponent e1
  double exponent_around = 1.0;                   // exponent e2
};

using ImplicitShape = std::variant<SphereShape, EllipsoidShape, CylinderShape, CapsuleShape, BoxShape,
                                   ConeShape, TorusShape, HalfSpaceShape, SuperquadricShape>;

// Range of the lengths that may be 0: the radius of a sphere and the half length of a capsule.
inline constexpr Range<double> shape_length_or_none_m{0.0, 0.5};
// Range of all other lengths of the shapes.
inline constexpr Range<double> shape_length_m{1e-5, 0.5};
inline constexpr double greatest_axis_ratio = 1000.0;
inline constexpr Range<double> superquadric_exponent{0.2, 1.8};

template <>
inline constexpr const char* kind_name<SphereShape> = "sphere";
template <>
inline constexpr auto fields_of<SphereShape> = std::to_array<Field<SphereShape>>({
    number_field("radius_mm", &SphereShape::radius_m, shape_length_or_none_m, FieldUnit::metre),
});

template <>
inline constexpr const char* kind_name<EllipsoidShape> = "ellipsoid";
template <>
inline constexpr auto fields_of<EllipsoidShape> = std::to_array<Field<EllipsoidShape>>({
    lengths_field("semi_axes_mm", &EllipsoidShape::semi_axes_m, shape_length_m),
});

template <>
inline constexpr const char* kind_name<CylinderShape> = "cylinder";
template <>
inline constexpr auto fields_of<CylinderShape> = std::to_array<Field<CylinderShape>>({
    number_field("radius_mm", &CylinderShape::radius_m, shape_length_m, FieldUnit::metre),
    number_field("half_length_mm", &CylinderShape::half_length_m, shape_length_m, FieldUnit::metre),
});

template <>
inline constexpr const char* kind_name<CapsuleShape> = "capsule";
template <>
inline constexpr auto fields_of<CapsuleShape> = std::to_array<Field<CapsuleShape>>({
    number_field("radius_mm", &CapsuleShape::radius_m, shape_length_m, FieldUnit::metre),
    number_field("half_length_mm", &CapsuleShape::half_length_m, shape_length_or_none_m, FieldUnit::metre),
});

template <>
inline constexpr const char* kind_name<BoxShape> = "box";
template <>
inline constexpr auto fields_of<BoxShape> = std::to_array<Field<BoxShape>>({
    lengths_field("half_extents_mm", &BoxShape::half_extents_m, shape_length_m),
});

template <>
inline constexpr const char* kind_name<ConeShape> = "cone";
template <>
inline constexpr auto fields_of<ConeShape> = std::to_array<Field<ConeShape>>({
    number_field("base_radius_mm", &ConeShape::base_radius_m, shape_length_m, FieldUnit::metre),
    number_field("height_mm", &ConeShape::height_m, shape_length_m, FieldUnit::metre),
});

template <>
inline constexpr const char* kind_name<TorusShape> = "torus";
template <>
inline constexpr auto fields_of<TorusShape> = std::to_array<Field<TorusShape>>({
    number_field("ring_radius_mm", &TorusShape::ring_radius_m, shape_length_m, FieldUnit::metre),
    number_field("tube_radius_mm", &TorusShape::tube_radius_m, shape_length_m, FieldUnit::metre),
});

template <>
inline constexpr const char* kind_name<HalfSpaceShape> = "half_space";
template <>
inline constexpr std::array<Field<HalfSpaceShape>, 0> fields_of<HalfSpaceShape>{};

template <>
inline constexpr const char* kind_name<SuperquadricShape> = "superquadric";
template <>
inline constexpr auto fields_of<SuperquadricShape> = std::to_array<Field<SuperquadricShape>>({
    lengths_field("semi_axes_mm", &SuperquadricShape::semi_axes_m, shape_length_m),
    number_field("exponent_along", &SuperquadricShape::exponent_along, superquadric_exponent),
    number_field("exponent_around", &SuperquadricShape::exponent_around, superquadric_exponent),
});

// Checks the ranges and proportions of a shape. The error's field names the value at fault: a length or
// exponent out of range, semi-axes that differ too much, or a torus's tube radius that is not less than its
// ring radius.
Status check_implicit_shape(const ImplicitShape& shape);

// Makes the signed distance of a shape that passed check_implicit_shape(). The distance is exact to 1e-12 of
// the size.
//
// Inside a superquadric, the distance is the best result of several searches, which can all miss the nearest
// wall. At about one of 100,000 points, the depth is therefore too large, by up to some thousandths of the
// size. The gradient always belongs to a plane that bounds the solid. A query of a superquadric takes about
// 20 us, a hundred times as long as for other shapes.
std::shared_ptr<const SignedDistance> make_signed_distance(const ImplicitShape& shape);

}  // namespace spoonbill
