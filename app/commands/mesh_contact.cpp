#include "app/commands/mesh_contact.h"

#include <algorithm>

#include "engine/collision/solids/surface_collider.h"

namespace spoonbill {
namespace {

// Cells a quarter of an element wide: regions are told that closely.
constexpr int levels = 2;

ContactSide on_mesh(const ToolShape& tool, const Vector3& from) {
  const DistanceSample sample = tool.at(from);
  return {from - sample.distance_m * sample.gradient, {}, {}};
}

ContactSide on_surface(const SurfaceContact& contact) {
  return {contact.point_m, SurfacePlace{contact.u, contact.v, {}}, {}};
}

// The mesh leaves the body along the surface's normal.
ContactOfTwo contact_of(const ToolShape& tool, const SurfaceContact& at, bool mesh_is_a) {
  ContactOfTwo contact{on_surface(at), on_mesh(tool, at.point_m), -at.normal, at.depth_m, at.tangent_u,
                       at.tangent_v};
  if (!mesh_is_a) return contact;
  std::swap(contact.a, contact.b);
  contact.normal = at.normal;
  return contact;
}

}  // namespace

Result<CollisionAnswer> collide_mesh(const SignedDistance& mesh, const Pose& mesh_pose,
                                     const Surface& surface, bool mesh_is_a) {
  const auto grid = make_nested_grid(surface.u, surface.v, levels);
  if (!grid) return grid.error();
  SurfaceCollider collider(grid.value());
  const ToolShape tool = ToolShape::solid(mesh, mesh_pose);
  const CollisionResult result = collider.collide(surface, tool, 0.0, true);

  CollisionAnswer answer;
  answer.touching = result.found;
  answer.complete = !result.overflow;
  const ContactOfTwo nearest = contact_of(tool, result.nearest, mesh_is_a);
  answer.nearest_a = nearest.a;
  answer.nearest_b = nearest.b;
  answer.distance_m = std::max(-result.nearest.depth_m, 0.0);
  if (!result.found) return answer;

  for (const ToolContactRegion& region : collider.find_contact_regions(surface, tool)) {
    answer.contacts.push_back(contact_of(tool, region.deepest, mesh_is_a));
    ContactSide& side = mesh_is_a ? answer.contacts.back().b : answer.contacts.back().a;
    side.place->range = region.range;
  }
  answer.complete = answer.complete && !collider.regions_overflow();
  // A mesh that touches nothing lies inside; one that lies inside and touches leaves by the way told for all.
  answer.contained = answer.contacts.empty();
  if (answer.contained) {
    answer.contacts.push_back(nearest);
  } else {
    answer.contacts.front().depth_m = std::max(answer.contacts.front().depth_m, nearest.depth_m);
  }
  return answer;
}

}  // namespace spoonbill
