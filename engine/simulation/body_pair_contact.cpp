#include "engine/simulation/body_pair_contact.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/simulation/shell_gap.h"

namespace spoonbill {

EmbeddedPoint embedding_of(const BodyMapping& mapping, const NearPoint& near) {
  return near.sample >= 0 ? mapping.sample(near.sample) : mapping.at(near.u, near.v);
}

bool add_near_points(const NumberedBody& from, const NumberedBody& to, const std::vector<NearPoint>& points,
                     BodyContacts& contacts) {
  bool complete = true;
  for (const NearPoint& near : points) {
    complete &=
        contacts.add({from.number, &from.state->lattice, embedding_of(from.state->mapping(), near)},
                     {to.number, &to.state->lattice, to.state->mapping().at(near.other_u, near.other_v)},
                     near.normal, near.gap_m);
  }
  return complete;
}

namespace {

bool add_all(const NumberedBody& first, const NumberedBody& second, const SurfaceProximity& proximity,
             BodyContacts& contacts) {
  const bool all_of_first = add_near_points(first, second, proximity.first_points(), contacts);
  const bool all_of_second = add_near_points(second, first, proximity.second_points(), contacts);
  return all_of_first && all_of_second;
}

bool add_all(const NumberedBody& first, const NumberedBody& second, const MeshProximity& proximity,
             BodyContacts& contacts) {
  const BodyMapping& surface = first.state->mapping();
  const MeshMapping& mesh = *second.state->mesh();
  bool complete = true;
  for (const SampleNearMesh& near : proximity.surface_samples()) {
    complete &= contacts.add({first.number, &first.state->lattice, surface.sample(near.sample)},
                             {second.number, &second.state->lattice, mesh.at(near.mesh.on)}, near.mesh.normal,
                             near.mesh.gap_m);
  }
  for (const VertexNearSurface& near : proximity.mesh_vertices()) {
    complete &= contacts.add({second.number, &second.state->lattice, mesh.vertex(near.vertex)},
                             {first.number, &first.state->lattice, surface.at(near.u, near.v)}, near.normal,
                             near.gap_m);
  }
  return complete;
}

std::optional<SurfaceSpot> deepest_of(const std::vector<NearPoint>& points) {
  const auto deepest =
      std::min_element(points.begin(), points.end(),
                       [](const NearPoint& one, const NearPoint& other) { return one.gap_m < other.gap_m; });
  if (deepest == points.end()) return std::nullopt;
  return SurfaceSpot{deepest->u, deepest->v, deepest->point_m, deepest->gap_m};
}

std::optional<SurfaceSpot> deepest_of(const std::vector<SampleNearMesh>& samples,
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

bool is_there(const BodyState& body, double u, double v) {
  return !body.trim || body.trim->contains(u, v);
}

void keep_what_is_there(SurfaceProximity& proximity, const BodyState& first, const BodyState& second) {
  if (!first.trim && !second.trim) return;
  const auto keep = [](const BodyState& of, const BodyState& other) {
    return [&](const NearPoint& near) {
      return is_there(of, near.u, near.v) && is_there(other, near.other_u, near.other_v);
    };
  };
  proximity.keep_if(keep(first, second), keep(second, first));
}

void keep_what_is_there(MeshProximity& proximity, const BodyState& body) {
  if (!body.trim) return;
  const Grid& grid = body.mapping().nested().grid;
  proximity.keep_if(
      [&](const SampleNearMesh& near) {
        return is_there(body, grid.u.parameters[near.sample / grid.columns()],
                        grid.v.parameters[near.sample % grid.columns()]);
      },
      [&](const VertexNearSurface& near) { return is_there(body, near.u, near.v); });
}

void find_near(SurfaceProximity& proximity, const BodyState& first, const BodyState& second, double margin) {
  const MaybeShell one{&first.mapping().current(), first.shell_thickness_m},
      other{&second.mapping().current(), second.shell_thickness_m};
  proximity.find(*one.surface, *other.surface, margin + one.thickness_m + other.thickness_m);
  keep_what_is_there(proximity, first, second);
  if (!(one.thickness_m > 0.0 || other.thickness_m > 0.0)) return;
  proximity.keep_if([&](NearPoint& near) { return settle_shell_gap(one, other, margin, near); },
                    [&](NearPoint& near) { return settle_shell_gap(other, one, margin, near); });
}

void find_near(MeshProximity& proximity, const BodyState& first, const BodyState& second, double margin) {
  const Surface& surface = first.mapping().current();
  const DeformingMesh& mesh = second.mesh()->current();
  const double thickness = first.shell_thickness_m;
  proximity.find(surface, mesh, margin + thickness);
  keep_what_is_there(proximity, first);
  if (!(thickness > 0.0)) return;
  const Grid& grid = first.mapping().nested().grid;
  proximity.keep_if(
      [&](SampleNearMesh& near) {
        const double u = grid.u.parameters[near.sample / grid.columns()],
                     v = grid.v.parameters[near.sample % grid.columns()];
        near.mesh.gap_m -= far_face_lead_m(thickness, unit_normal(surface, u, v), near.mesh.normal);
        return near.mesh.gap_m <= margin;
      },
      [&](VertexNearSurface& near) {
        return gap_to_shell(surface, thickness, near.u, near.v, mesh.vertices_m()[near.vertex], margin,
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

bool BodyPairContact::find(const NumberedBody& first, const NumberedBody& second) {
  const double cell =
      static_cast<double>(std::max(first.state->lattice.cell_size_m(), second.state->lattice.cell_size_m()));
  return std::visit(
      [&](const auto& of) {
        find_near(*of, *first.state, *second.state, contact_margin_cells * cell);
        return !of->overflow();
      },
      proximity_);
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_first(const BodyState& first) const {
  if (const auto* const meshes = std::get_if<std::unique_ptr<MeshProximity>>(&proximity_)) {
    return deepest_of((*meshes)->surface_samples(), first.mapping());
  }
  return deepest_of((*std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_))->first_points());
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_second() const {
  const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_);
  return surfaces != nullptr ? deepest_of((*surfaces)->second_points()) : std::nullopt;
}

bool BodyPairContact::add_contacts(const NumberedBody& first, const NumberedBody& second,
                                   BodyContacts& contacts) const {
  return std::visit([&](const auto& of) { return add_all(first, second, *of, contacts); }, proximity_);
}

}  // namespace spoonbill
