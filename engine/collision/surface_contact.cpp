#include "engine/collision/surface_contact.h"

namespace spoonbill {
namespace {

// Of the other derivative's length, below which a derivative has no direction.
constexpr double vanishing = 1e-9;

}  // namespace

SurfaceContact contact_at(const Surface& surface, const SurfaceSpot& spot) {
  SurfaceContact contact;
  contact.u = spot.u;
  contact.v = spot.v;
  contact.point_m = spot.point_m;
  contact.depth_m = -spot.distance_m;
  contact.normal = unit_normal(surface, spot.u, spot.v);
  const SurfacePoint at = evaluate(surface, spot.u, spot.v);
  const auto in_plane = [&](const Vector3& way) -> Vector3 {
    return way - way.dot(contact.normal) * contact.normal;
  };
  const Vector3 du = in_plane(at.du), dv = in_plane(at.dv);
  Vector3 along = du;
  if (!(du.norm() > vanishing * dv.norm())) along = dv.cross(contact.normal);
  if (!(along.norm() > 0.0)) along = contact.normal.unitOrthogonal();
  contact.tangent_u = along.normalized();
  contact.tangent_v = contact.normal.cross(contact.tangent_u);
  // A surface that is a line or a point here has no normal: any frame about the tangent serves.
  if (!(contact.tangent_v.norm() > 0.5)) contact.tangent_v = contact.tangent_u.unitOrthogonal();
  return contact;
}

}  // namespace spoonbill
