#include "engine/collision/solids/implicit/implicit_shapes.h"

#include <string>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/collision/solids/implicit/ellipsoid_distance.h"
#include "engine/collision/solids/implicit/plain_distances.h"
#include "engine/collision/solids/implicit/superquadric_distance.h"

namespace spoonbill {
namespace {

// Overloads of one call for the kinds of shape.
template <class... Kinds>
struct Visitor : Kinds... {
  using Kinds::operator()...;
};
template <class... Kinds>
Visitor(Kinds...) -> Visitor<Kinds...>;

Status check_axes(const char* field, const Vector3& lengths) {
  const double ratio = lengths.maxCoeff() / lengths.minCoeff();
  if (ratio <= greatest_axis_ratio * (1.0 + 1e-12)) return {};
  return Error{std::string(field) + " has a longest axis " + number_text(ratio) +
               " times the shortest, must be at most " + number_text(greatest_axis_ratio) + " times"};
}

// What else a shape asks of its lengths than that each is within its range.
template <class Shape>
Status check_proportions(const Shape&) {
  return {};
}

Status check_proportions(const EllipsoidShape& shape) {
  return check_axes("ellipsoid.semi_axes_m", shape.semi_axes_m);
}

Status check_proportions(const SuperquadricShape& shape) {
  return check_axes("superquadric.semi_axes_m", shape.semi_axes_m);
}

Status check_proportions(const TorusShape& torus) {
  if (torus.tube_radius_m < torus.ring_radius_m) return {};
  return Error{"torus.tube_radius_m is " + number_text(torus.tube_radius_m) +
               ", must be less than torus.ring_radius_m, " + number_text(torus.ring_radius_m)};
}

}  // namespace

Status check_implicit_shape(const ImplicitShape& shape) {
  const auto check = []<class Shape>(const Shape& of) -> Status {
    if (Status status = check_fields(std::string(kind_name<Shape>) + ".", of); !status.ok()) return status;
    return check_proportions(of);
  };
  return std::visit(check, shape);
}

std::shared_ptr<const SignedDistance> make_signed_distance(const ImplicitShape& shape) {
  SPOONBILL_ASSERT(check_implicit_shape(shape).ok());
  using Made = std::shared_ptr<const SignedDistance>;
  const Visitor make{
      [](const SphereShape& s) -> Made { return std::make_shared<SphereDistance>(s); },
      [](const EllipsoidShape& s) -> Made { return std::make_shared<EllipsoidDistance>(s); },
      [](const CylinderShape& s) -> Made { return std::make_shared<CylinderDistance>(s); },
      [](const CapsuleShape& s) -> Made { return std::make_shared<CapsuleDistance>(s); },
      [](const BoxShape& s) -> Made { return std::make_shared<BoxDistance>(s); },
      [](const ConeShape& s) -> Made { return std::make_shared<ConeDistance>(s); },
      [](const TorusShape& s) -> Made { return std::make_shared<TorusDistance>(s); },
      [](const HalfSpaceShape&) -> Made { return std::make_shared<HalfSpaceDistance>(); },
      [](const SuperquadricShape& s) -> Made { return std::make_shared<SuperquadricDistance>(s); }};
  return std::visit(make, shape);
}

}  // namespace spoonbill
