#include "engine/collision/solids/implicit/implicit_shapes.h"

#include <string>

#include "engine/base/number_text.h"
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

Status check_lengths(const char* shape, const Vector3& lengths) {
  for (int k = 0; k < 3; ++k) {
    const std::string field = std::string(shape) + "[" + std::to_string(k) + "]";
    if (Status status = check_range(field, lengths[k], shape_length_m); !status) return status;
  }
  return {};
}

Status check_axes(const char* field, const Vector3& lengths) {
  if (Status status = check_lengths(field, lengths); !status) return status;
  const double ratio = lengths.maxCoeff() / lengths.minCoeff();
  if (ratio <= greatest_axis_ratio * (1.0 + 1e-12)) return {};
  return Error{std::string(field) + " has a longest axis " + number_text(ratio) +
               " times the shortest, must be at most " + number_text(greatest_axis_ratio) + " times"};
}

Status both(const Status& first, const Status& second) {
  return first ? second : first;
}

Status check_torus(const TorusShape& torus) {
  Status lengths = both(check_range("torus.ring_radius_m", torus.ring_radius_m, shape_length_m),
                        check_range("torus.tube_radius_m", torus.tube_radius_m, shape_length_m));
  if (!lengths || torus.tube_radius_m < torus.ring_radius_m) return lengths;
  return Error{"torus.tube_radius_m is " + number_text(torus.tube_radius_m) +
               ", must be less than torus.ring_radius_m, " + number_text(torus.ring_radius_m)};
}

}  // namespace

Status check_implicit_shape(const ImplicitShape& shape) {
  const Visitor check{
      [](const SphereShape& s) { return check_range("sphere.radius_m", s.radius_m, shape_length_or_none_m); },
      [](const EllipsoidShape& s) { return check_axes("ellipsoid.semi_axes_m", s.semi_axes_m); },
      [](const CylinderShape& s) {
        return both(check_range("cylinder.radius_m", s.radius_m, shape_length_m),
                    check_range("cylinder.half_length_m", s.half_length_m, shape_length_m));
      },
      [](const CapsuleShape& s) {
        return both(check_range("capsule.radius_m", s.radius_m, shape_length_m),
                    check_range("capsule.half_length_m", s.half_length_m, shape_length_or_none_m));
      },
      [](const BoxShape& s) { return check_lengths("box.half_extents_m", s.half_extents_m); },
      [](const ConeShape& s) {
        return both(check_range("cone.base_radius_m", s.base_radius_m, shape_length_m),
                    check_range("cone.height_m", s.height_m, shape_length_m));
      },
      [](const TorusShape& s) { return check_torus(s); },
      [](const HalfSpaceShape&) { return Status(); },
      [](const SuperquadricShape& s) {
        const Status exponents =
            both(check_range("superquadric.exponent_along", s.exponent_along, superquadric_exponent),
                 check_range("superquadric.exponent_around", s.exponent_around, superquadric_exponent));
        return both(check_axes("superquadric.semi_axes_m", s.semi_axes_m), exponents);
      }};
  return std::visit(check, shape);
}

std::shared_ptr<const SignedDistance> make_signed_distance(const ImplicitShape& shape) {
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
