#include "engine/collision/solids/implicit_shapes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/collision/solids/superquadric_distance.h"

namespace spoonbill {

namespace {

class SphereDistance final : public SignedDistance {
 public:
  explicit SphereDistance(const SphereShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  SphereShape shape_;
};

class HalfSpaceDistance final : public SignedDistance {
 public:
  DistanceSample at(const Vector3& point_m) const override { return {point_m.y(), Vector3::UnitY()}; }
  bool is_convex() const override { return true; }
  Box bounds() const override;
};

class BoxDistance final : public SignedDistance {
 public:
  explicit BoxDistance(const BoxShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-shape_.half_extents_m, shape_.half_extents_m}; }

 private:
  BoxShape shape_;
};

class CapsuleDistance final : public SignedDistance {
 public:
  explicit CapsuleDistance(const CapsuleShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  CapsuleShape shape_;
};

class CylinderDistance final : public SignedDistance {
 public:
  explicit CylinderDistance(const CylinderShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  CylinderShape shape_;
};

class ConeDistance final : public SignedDistance {
 public:
  explicit ConeDistance(const ConeShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  ConeShape shape_;
  double slant_m_;                 // length of the side, from the rim to the tip
  double normal_out_, normal_up_;  // normal of the side: components away from the axis and along y
};

class TorusDistance final : public SignedDistance {
 public:
  explicit TorusDistance(const TorusShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return false; }
  Box bounds() const override;

  // In a half-plane through the axis, the distance is convex. In the direction around the axis, it is concave
  // only at points nearer to the axis than the ring, with a curvature of at most 1 / (distance from the
  // axis).
  double concavity(const Vector3& centre_m, double radius_m) const override;

 private:
  TorusShape shape_;
};

// Signed distance of an ellipsoid with the semi-axes e_i, the shortest of which is e_m (Eberly 2013, whose s
// is w - 1).
//
// The point of the surface nearest to y is x_i = r_i y_i / (w + r_i - 1), where r_i = (e_i / e_m)^2 and w >=
// 0 is the root of sum (x_i / e_i)^2 = 1. This form loses no digits inside the ellipsoid, where w approaches
// 0, nor near the surface, where y_i - x_i = y_i (w - 1) / (w + r_i - 1).
class EllipsoidDistance final : public SignedDistance {
 public:
  explicit EllipsoidDistance(const EllipsoidShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-axes_, axes_}; }

 private:
  DistanceSample at_central_plane(const Vector3& point_m) const;
  double solve(const Vector3& scaled, double low) const;

  Vector3 axes_;
  int shortest_ = 0;
  Vector3 ratio_, excess_;  // r_i and r_i - 1 for each axis i
};

// A direction in the meridian half-plane: away from the y axis and along it.
struct MeridianDirection {
  double out, up;
};

double from_axis(const Vector3& point) {
  return std::sqrt(point.x() * point.x() + point.z() * point.z());
}

// Rotates a direction from the meridian half-plane into the half-plane of the point. On the axis, where all
// half-planes are equivalent, the half-plane of the x axis is used.
Vector3 rotate_from_meridian(const MeridianDirection& direction, const Vector3& point) {
  const double out = from_axis(point);
  if (!(out > 0.0)) return {direction.out, direction.up, 0.0};
  return {direction.out * (point.x() / out), direction.up, direction.out * (point.z() / out)};
}

double sign(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

Box about_axis(double radius, double low, double high) {
  return {{-radius, low, -radius}, {radius, high, radius}};
}

DistanceSample from_point(const MeridianDirection& away, double radius, const Vector3& point) {
  const double length = std::sqrt(away.out * away.out + away.up * away.up);
  if (!(length > 0.0)) return {-radius, Vector3::UnitY()};
  return {length - radius, rotate_from_meridian({away.out / length, away.up / length}, point)};
}

DistanceSample SphereDistance::at(const Vector3& point_m) const {
  const double length = point_m.norm();
  if (!(length > 0.0)) return {-shape_.radius_m, Vector3::UnitY()};
  return {length - shape_.radius_m, point_m / length};
}

Box SphereDistance::bounds() const {
  return {Vector3::Constant(-shape_.radius_m), Vector3::Constant(shape_.radius_m)};
}

Box HalfSpaceDistance::bounds() const {
  return {Vector3::Constant(-infinity), {infinity, 0.0, infinity}};
}

DistanceSample BoxDistance::at(const Vector3& point_m) const {
  const Vector3 beyond = point_m.cwiseAbs() - shape_.half_extents_m;
  const Vector3 outside = beyond.cwiseMax(0.0);
  const double length = outside.norm();
  Vector3 gradient = Vector3::Zero();
  if (length > 0.0) {
    for (int k = 0; k < 3; ++k) gradient[k] = sign(point_m[k]) * (outside[k] / length);
    return {length, gradient};
  }
  int nearest = 0;
  for (int k = 1; k < 3; ++k) {
    if (beyond[k] > beyond[nearest]) nearest = k;
  }
  gradient[nearest] = sign(point_m[nearest]);
  return {beyond[nearest], gradient};
}

DistanceSample CapsuleDistance::at(const Vector3& point_m) const {
  const double along = std::clamp(point_m.y(), -shape_.half_length_m, shape_.half_length_m);
  const Vector3 away(point_m.x(), point_m.y() - along, point_m.z());
  const double length = away.norm();
  if (!(length > 0.0)) return {-shape_.radius_m, Vector3::UnitX()};
  return {length - shape_.radius_m, away / length};
}

Box CapsuleDistance::bounds() const {
  const double end = shape_.half_length_m + shape_.radius_m;
  return about_axis(shape_.radius_m, -end, end);
}

DistanceSample CylinderDistance::at(const Vector3& point_m) const {
  const double out = from_axis(point_m) - shape_.radius_m;
  const double up = std::abs(point_m.y()) - shape_.half_length_m, up_sign = sign(point_m.y());
  if (out > 0.0 && up > 0.0) return from_point({out, up_sign * up}, 0.0, point_m);
  if (out > up) return {out, rotate_from_meridian({1.0, 0.0}, point_m)};
  return {up, {0.0, up_sign, 0.0}};
}

Box CylinderDistance::bounds() const {
  return about_axis(shape_.radius_m, -shape_.half_length_m, shape_.half_length_m);
}

ConeDistance::ConeDistance(const ConeShape& shape)
    : shape_(shape),
      slant_m_(std::sqrt(shape.base_radius_m * shape.base_radius_m + shape.height_m * shape.height_m)),
      normal_out_(shape.height_m / slant_m_),
      normal_up_(shape.base_radius_m / slant_m_) {}

DistanceSample ConeDistance::at(const Vector3& point_m) const {
  const double from_rim = from_axis(point_m) - shape_.base_radius_m, up = point_m.y();
  const double side = normal_out_ * from_rim + normal_up_ * up;
  // Distance along the side, from the rim towards the tip.
  const double along = normal_out_ * up - normal_up_ * from_rim;
  if (side <= 0.0 && up >= 0.0) {
    if (side > -up) return {side, rotate_from_meridian({normal_out_, normal_up_}, point_m)};
    return {-up, -Vector3::UnitY()};
  }
  if (side > 0.0 && along >= slant_m_) {
    return from_point({from_axis(point_m), up - shape_.height_m}, 0.0, point_m);
  }
  if (side > 0.0 && along >= 0.0) return {side, rotate_from_meridian({normal_out_, normal_up_}, point_m)};
  if (from_rim > 0.0) return from_point({from_rim, up}, 0.0, point_m);
  return {-up, -Vector3::UnitY()};
}

Box ConeDistance::bounds() const {
  return about_axis(shape_.base_radius_m, 0.0, shape_.height_m);
}

DistanceSample TorusDistance::at(const Vector3& point_m) const {
  return from_point({from_axis(point_m) - shape_.ring_radius_m, point_m.y()}, shape_.tube_radius_m, point_m);
}

Box TorusDistance::bounds() const {
  return about_axis(shape_.ring_radius_m + shape_.tube_radius_m, -shape_.tube_radius_m, shape_.tube_radius_m);
}

double TorusDistance::concavity(const Vector3& centre_m, double radius_m) const {
  const double nearest = from_axis(centre_m) - radius_m;
  if (nearest >= shape_.ring_radius_m) return 0.0;
  return nearest > 0.0 ? 1.0 / nearest : std::numeric_limits<double>::infinity();
}

EllipsoidDistance::EllipsoidDistance(const EllipsoidShape& shape) : axes_(shape.semi_axes_m) {
  const double least = axes_.minCoeff(&shortest_);
  for (int k = 0; k < 3; ++k) {
    ratio_[k] = (axes_[k] / least) * (axes_[k] / least);
    excess_[k] = ((axes_[k] - least) / least) * ((axes_[k] + least) / least);
  }
}

// Returns the root w. The reciprocal norm of the vector scaled_k / (w + excess_k) is a concave, increasing
// function of w. If Newton's method starts below the root, it therefore never passes the root (More and
// Sorensen 1983).
double EllipsoidDistance::solve(const Vector3& scaled, double low) const {
  double w = low;
  for (int step = 0; step < 60; ++step) {
    double sum = 0.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (!(scaled[k] > 0.0)) continue;
      const double denominator = w + excess_[k], term = (scaled[k] / denominator) * (scaled[k] / denominator);
      sum += term;
      slope += term / denominator;
    }
    const double next = w + (sum / slope) * (std::sqrt(sum) - 1.0);
    if (!(next > w)) break;
    const double gain = next - w;
    w = next;
    if (gain < 1e-16 * w) break;
  }
  return w;
}

// Returns the distance of a point that is on or close to the plane of the two longer axes. The nearest
// surface point must be above or below that plane.
DistanceSample EllipsoidDistance::at_central_plane(const Vector3& point_m) const {
  Vector3 nearest = Vector3::Zero();
  double rest = 1.0;
  for (int k = 0; k < 3; ++k) {
    if (!(excess_[k] > 0.0)) continue;
    nearest[k] = point_m[k] * (ratio_[k] / excess_[k]);
    rest -= (nearest[k] / axes_[k]) * (nearest[k] / axes_[k]);
  }
  nearest[shortest_] = axes_[shortest_] * std::sqrt(std::max(rest, 0.0));
  const Vector3 normal = nearest.cwiseQuotient(axes_).cwiseQuotient(axes_).normalized();
  return {-(nearest - point_m).norm(), normal};
}

DistanceSample EllipsoidDistance::at(const Vector3& point_m) const {
  const Vector3 scaled = ratio_.cwiseProduct(point_m.cwiseAbs().cwiseQuotient(axes_));
  const double low = std::max((scaled - excess_).maxCoeff(), 0.0);
  if (!(low > 0.0)) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (excess_[k] > 0.0) sum += (scaled[k] / excess_[k]) * (scaled[k] / excess_[k]);
    }
    if (sum <= 1.0) return at_central_plane(point_m);
  }
  const double w = solve(scaled, low);
  Vector3 normal;
  for (int k = 0; k < 3; ++k) {
    const double denominator = w + excess_[k];
    normal[k] = denominator > 0.0 ? point_m[k] / denominator : 0.0;
  }
  const double length = normal.norm();
  return {(w - 1.0) * length, normal / length};
}

}  // namespace

namespace {

// Overload set for std::visit.
template <class... Kinds>
struct Visitor : Kinds... {
  using Kinds::operator()...;
};
template <class... Kinds>
Visitor(Kinds...) -> Visitor<Kinds...>;

Status check_axes(const std::string& shape, const Vector3& lengths) {
  const double ratio = lengths.maxCoeff() / lengths.minCoeff();
  if (ratio <= greatest_axis_ratio * (1.0 + 1e-12)) return {};
  return Error(ErrorCode::inconsistent,
               shape + ".semi_axes_mm: the longest axis is " + number_text(ratio) +
                   " times the shortest, must be at most " + number_text(greatest_axis_ratio) + " times",
               "semi_axes_mm");
}

// Checks the relations between the fields of a shape, such as the ratio of its axes. The ranges of the fields
// are checked elsewhere.
template <class Shape>
Status check_proportions(const Shape&) {
  return {};
}

Status check_proportions(const EllipsoidShape& shape) {
  return check_axes(kind_name<EllipsoidShape>, shape.semi_axes_m);
}

Status check_proportions(const SuperquadricShape& shape) {
  return check_axes(kind_name<SuperquadricShape>, shape.semi_axes_m);
}

Status check_proportions(const TorusShape& torus) {
  if (torus.tube_radius_m < torus.ring_radius_m) return {};
  return Error(ErrorCode::inconsistent,
               "torus.tube_radius_mm is " + number_text(torus.tube_radius_m * 1e3) +
                   ", must be less than torus.ring_radius_mm, " + number_text(torus.ring_radius_m * 1e3),
               "tube_radius_mm");
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
