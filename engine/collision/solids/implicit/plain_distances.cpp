#include "engine/collision/solids/implicit/plain_distances.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

// A point of the half-plane that turns about y.
struct MeridianDirection {
  double out, up;
};

double from_axis(const Vector3& point) {
  return std::sqrt(point.x() * point.x() + point.z() * point.z());
}

// On the axis every way out is as good.
Vector3 turned(const MeridianDirection& direction, const Vector3& point) {
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
  return {length - radius, turned({away.out / length, away.up / length}, point)};
}

}  // namespace

DistanceSample SphereDistance::at(const Vector3& point_m) const {
  const double length = point_m.norm();
  if (!(length > 0.0)) return {-shape_.radius_m, Vector3::UnitY()};
  return {length - shape_.radius_m, point_m / length};
}

Box SphereDistance::bounds() const {
  return {Vector3::Constant(-shape_.radius_m), Vector3::Constant(shape_.radius_m)};
}

Box HalfSpaceDistance::bounds() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
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
  const double up = std::abs(point_m.y()) - shape_.half_length_m, way = sign(point_m.y());
  if (out > 0.0 && up > 0.0) return from_point({out, way * up}, 0.0, point_m);
  if (out > up) return {out, turned({1.0, 0.0}, point_m)};
  return {up, {0.0, way, 0.0}};
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
  const double along = normal_out_ * up - normal_up_ * from_rim;  // from the rim towards the tip
  if (side <= 0.0 && up >= 0.0) {
    if (side > -up) return {side, turned({normal_out_, normal_up_}, point_m)};
    return {-up, -Vector3::UnitY()};
  }
  if (side > 0.0 && along >= slant_m_) {
    return from_point({from_axis(point_m), up - shape_.height_m}, 0.0, point_m);
  }
  if (side > 0.0 && along >= 0.0) return {side, turned({normal_out_, normal_up_}, point_m)};
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

}  // namespace spoonbill
