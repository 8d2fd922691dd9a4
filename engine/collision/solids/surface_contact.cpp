#include "engine/collision/solids/surface_contact.h"

#include <cmath>

namespace spoonbill {
namespace {

// Of the other derivative's length, below which a derivative has no direction.
constexpr double vanishing = 1e-9;

}  // namespace

Tangents tangents_across(const Vector3& normal, const SurfacePoint& at) {
  const auto in_plane = [&](const Vector3& way) -> Vector3 { return way - way.dot(normal) * normal; };
  const Vector3 du = in_plane(at.du), dv = in_plane(at.dv);
  Vector3 along = du;
  if (!(du.norm() > vanishing * dv.norm())) along = dv.cross(normal);
  if (!(along.norm() > 0.0)) along = normal.unitOrthogonal();
  Tangents tangents;
  tangents.u = along.normalized();
  tangents.v = normal.cross(tangents.u);
  // A surface that is a line or a point here has no normal: any frame about the tangent serves.
  if (!(tangents.v.norm() > 0.5)) tangents.v = tangents.u.unitOrthogonal();
  return tangents;
}

SurfaceContact contact_at(const Surface& surface, const SurfaceSpot& spot) {
  SurfaceContact contact;
  contact.u = spot.u;
  contact.v = spot.v;
  contact.point_m = spot.point_m;
  contact.depth_m = -spot.distance_m;
  contact.normal = unit_normal(surface, spot.u, spot.v);
  const Tangents tangents = tangents_across(contact.normal, evaluate(surface, spot.u, spot.v));
  contact.tangent_u = tangents.u;
  contact.tangent_v = tangents.v;
  return contact;
}

}  // namespace spoonbill
