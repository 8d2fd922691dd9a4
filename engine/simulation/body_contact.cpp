#include "engine/simulation/body_contact.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// The largest lateral offset of a point over a surface is this fraction of the point's height plus an
// allowance for rounding. At a larger offset the point is beside the surface. The lateral error of nearest
// points is far smaller.
constexpr double lateral_tolerance = 0.2, rounding_m = 1e-6;

}  // namespace

double far_face_offset_m(double thickness_m, const Vector3& normal, const Vector3& push) {
  SPOONBILL_ASSERT_DEBUG(thickness_m >= 0.0);
  return thickness_m * std::max(0.0, normal.dot(push));
}

bool find_shell_gap(const Surface& shell, double thickness_m, double u, double v, const Vector3& point_m,
                    double margin_m, Vector3& normal, double& gap_m) {
  const Vector3 outward = unit_normal(shell, u, v), over = point_m - position(shell, u, v);
  const double height = over.dot(outward);
  if ((over - height * outward).norm() > lateral_tolerance * std::abs(height) + rounding_m) return false;
  const bool behind = height < -0.5 * thickness_m;
  normal = behind ? Vector3(-outward) : outward;
  gap_m = behind ? -height - thickness_m : height;
  return gap_m <= margin_m;
}

bool resolve_shell_gap(const ShellOrSolid& of, const ShellOrSolid& other, double margin_m, NearPoint& near) {
  SPOONBILL_ASSERT_DEBUG(of.surface != nullptr && other.surface != nullptr);
  if (other.thickness_m > 0.0 &&
      !find_shell_gap(*other.surface, other.thickness_m, near.other_u, near.other_v, near.point_m,
                      margin_m + of.thickness_m, near.normal, near.gap_m)) {
    return false;
  }
  if (of.thickness_m > 0.0) {
    near.gap_m -= far_face_offset_m(of.thickness_m, unit_normal(*of.surface, near.u, near.v), near.normal);
  }
  return near.gap_m <= margin_m;
}

EmbeddedPoint find_embedding(const BodyMapping& mapping, const NearPoint& near) {
  return near.sample >= 0 ? mapping.sample(near.sample) : mapping.at(near.u, near.v);
}

bool add_near_points(const IndexedBody& from, const IndexedBody& to, const std::vector<NearPoint>& points,
                     BodyContacts& contacts) {
  bool complete = true;
  for (const NearPoint& near : points) {
    complete &=
        contacts.add({from.index, &from.state->lattice, find_embedding(from.state->mapping(), near)},
                     {to.index, &to.state->lattice, to.state->mapping().at(near.other_u, near.other_v)},
                     near.normal, near.gap_m, near.sample);
  }
  return complete;
}

namespace {

bool add_contacts_of(const IndexedBody& first, const IndexedBody& second, const SurfaceProximity& proximity,
                     BodyContacts& contacts) {
  const bool first_complete = add_near_points(first, second, proximity.first_points(), contacts);
  const bool second_complete = add_near_points(second, first, proximity.second_points(), contacts);
  return first_complete && second_complete;
}

bool add_contacts_of(const IndexedBody& first, const IndexedBody& second, const MeshProximity& proximity,
                     BodyContacts& contacts) {
  const BodyMapping& surface = first.state->mapping();
  const MeshMapping& mesh = *second.state->mesh();
  bool complete = true;
  for (const SampleNearMesh& near : proximity.surface_samples()) {
    complete &= contacts.add({first.index, &first.state->lattice, surface.sample(near.sample)},
                             {second.index, &second.state->lattice, mesh.at(near.mesh.on)}, near.mesh.normal,
                             near.mesh.gap_m, near.sample);
  }
  for (const VertexNearSurface& near : proximity.mesh_vertices()) {
    complete &= contacts.add({second.index, &second.state->lattice, mesh.vertex(near.vertex)},
                             {first.index, &first.state->lattice, surface.at(near.u, near.v)}, near.normal,
                             near.gap_m, near.vertex);
  }
  return complete;
}

std::optional<SurfaceSpot> find_deepest(const std::vector<NearPoint>& points) {
  const auto deepest =
      std::min_element(points.begin(), points.end(),
                       [](const NearPoint& one, const NearPoint& other) { return one.gap_m < other.gap_m; });
  if (deepest == points.end()) return std::nullopt;
  return SurfaceSpot{deepest->u, deepest->v, deepest->point_m, deepest->gap_m};
}

std::optional<SurfaceSpot> find_deepest(const std::vector<SampleNearMesh>& samples,
                                        const BodyMapping& mapping) {
  const auto deepest = std::min_element(samples.begin(), samples.end(),
                                        [](const SampleNearMesh& one, const SampleNearMesh& other) {
                                          return one.mesh.gap_m < other.mesh.gap_m;
                                        });
  if (deepest == samples.end()) return std::nullopt;
  const Grid& grid = mapping.nested().grid;
  const double u = grid.u.parameters[deepest->sample / grid.columns()],
               v = grid.v.parameters[deepest->sample % grid.columns()];
  return SurfaceSpot{u, v, evaluate(mapping.current(), u, v).position_m, deepest->mesh.gap_m};
}

bool is_untrimmed(const BodyState& body, double u, double v) {
  return !body.trim || body.trim->contains(u, v);
}

void drop_trimmed_points(SurfaceProximity& proximity, const BodyState& first, const BodyState& second) {
  if (!first.trim && !second.trim) return;
  const auto is_kept_for = [](const BodyState& own, const BodyState& other) {
    return [&](const NearPoint& near) {
      return is_untrimmed(own, near.u, near.v) && is_untrimmed(other, near.other_u, near.other_v);
    };
  };
  proximity.keep_if(is_kept_for(first, second), is_kept_for(second, first));
}

void drop_trimmed_points(MeshProximity& proximity, const BodyState& body) {
  if (!body.trim) return;
  const Grid& grid = body.mapping().nested().grid;
  proximity.keep_if(
      [&](const SampleNearMesh& near) {
        return is_untrimmed(body, grid.u.parameters[near.sample / grid.columns()],
                            grid.v.parameters[near.sample % grid.columns()]);
      },
      [&](const VertexNearSurface& near) { return is_untrimmed(body, near.u, near.v); });
}

void find_near_points(SurfaceProximity& proximity, const BodyState& first, const BodyState& second,
                      double margin) {
  const ShellOrSolid one{&first.mapping().current(), first.shell_thickness_m},
      other{&second.mapping().current(), second.shell_thickness_m};
  proximity.find(*one.surface, *other.surface, margin + one.thickness_m + other.thickness_m);
  drop_trimmed_points(proximity, first, second);
  if (!(one.thickness_m > 0.0 || other.thickness_m > 0.0)) return;
  proximity.keep_if([&](NearPoint& near) { return resolve_shell_gap(one, other, margin, near); },
                    [&](NearPoint& near) { return resolve_shell_gap(other, one, margin, near); });
}

void find_near_points(MeshProximity& proximity, const BodyState& first, const BodyState& second,
                      double margin) {
  const Surface& surface = first.mapping().current();
  const DeformingMesh& mesh = second.mesh()->current();
  const double thickness = first.shell_thickness_m;
  proximity.find(surface, mesh, margin + thickness);
  drop_trimmed_points(proximity, first);
  if (!(thickness > 0.0)) return;
  const Grid& grid = first.mapping().nested().grid;
  proximity.keep_if(
      [&](SampleNearMesh& near) {
        const double u = grid.u.parameters[near.sample / grid.columns()],
                     v = grid.v.parameters[near.sample % grid.columns()];
        near.mesh.gap_m -= far_face_offset_m(thickness, unit_normal(surface, u, v), near.mesh.normal);
        return near.mesh.gap_m <= margin;
      },
      [&](VertexNearSurface& near) {
        return find_shell_gap(surface, thickness, near.u, near.v, mesh.vertices_m()[near.vertex], margin,
                              near.normal, near.gap_m);
      });
}

}  // namespace

BodyPairContact::BodyPairContact(const BodyState& first, const BodyState& second) {
  SPOONBILL_ASSERT(first.mesh() == nullptr);
  const NestedGrid& grid = first.mapping().nested();
  if (const MeshMapping* const mesh = second.mesh()) {
    proximity_ = std::make_unique<MeshProximity>(grid, mesh->patches());
  } else {
    proximity_ = std::make_unique<SurfaceProximity>(grid, second.mapping().nested());
  }
}

bool BodyPairContact::find(const IndexedBody& first, const IndexedBody& second) {
  const double cell =
      static_cast<double>(std::max(first.state->lattice.cell_size_m(), second.state->lattice.cell_size_m()));
  return std::visit(
      [&](const auto& proximity) {
        find_near_points(*proximity, *first.state, *second.state, contact_margin_cells * cell);
        return !proximity->overflow();
      },
      proximity_);
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_first(const BodyState& first) const {
  if (const auto* const meshes = std::get_if<std::unique_ptr<MeshProximity>>(&proximity_)) {
    return find_deepest((*meshes)->surface_samples(), first.mapping());
  }
  return find_deepest((*std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_))->first_points());
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_second() const {
  const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_);
  return surfaces != nullptr ? find_deepest((*surfaces)->second_points()) : std::nullopt;
}

bool BodyPairContact::add_contacts(const IndexedBody& first, const IndexedBody& second,
                                   BodyContacts& contacts) const {
  return std::visit(
      [&](const auto& proximity) { return add_contacts_of(first, second, *proximity, contacts); },
      proximity_);
}

BodySelfContact::BodySelfContact(const BodyState& body) {
  SPOONBILL_ASSERT_DEBUG(body.fixed.size() == static_cast<std::size_t>(body.lattice.mesh().node_count()));
  if (body.mesh() != nullptr || body.lattice.mesh().slender) return;
  proximity_ = std::make_unique<SelfProximity>(body.mapping().nested(), body.mapping().rest(),
                                               static_cast<double>(body.lattice.cell_size_m()));
}

bool BodySelfContact::add_contacts(const IndexedBody& body, BodyContacts& contacts) const {
  if (!proximity_) return true;
  const double margin = contact_margin_cells * static_cast<double>(body.state->lattice.cell_size_m());
  proximity_->find(body.state->mapping().current(), margin);
  if (const TrimmedArea* const trim = body.state->trim.get()) {
    proximity_->keep_if([&](const NearPoint& near) {
      return trim->contains(near.u, near.v) && trim->contains(near.other_u, near.other_v);
    });
  }
  const bool complete = add_near_points(body, body, proximity_->points(), contacts);
  return complete && !proximity_->overflow();
}

}  // namespace spoonbill
