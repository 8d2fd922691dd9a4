#include "engine/simulation/body_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/simulation/contact_samples.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/support_points.h"

namespace spoonbill {
namespace {

// The largest lateral offset of a point over a surface is this fraction of the point's height plus an
// allowance for rounding. At a larger offset the point is beside the surface. The lateral error of nearest
// points is far smaller.
constexpr double lateral_tolerance = 0.2, rounding_m = 1e-6;

// A point between samples gets a contact only if it is deeper than the samples around it by this fraction of
// a cell. Such points differ from tick to tick, so that their pushes would shake bodies at rest.
constexpr double least_lead_cells = 0.02;

// Largest correction of a gap for what the control net does not reproduce, in cells. A larger one would let
// the drawn surfaces overlap visibly where a net is too coarse for its lattice.
constexpr double largest_fit_error_cells = 0.02;

// Largest depth of a point that had no contact in the last step, in cells, or the approach of the bodies in
// that step if that is larger. A deeper point is beside a fold of the surface. The approach does not include
// the motion of the hand, so that a few points of a soft tool may be left out if the hand is faster than
// about 1 m/s.
constexpr double deepest_new_cells = 0.2;

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

namespace {

// A point of a surface as contacts use it. Its error is the position of the embedded point minus that of the
// point on the surface, whose control net does not reproduce every displacement of its lattice. `fit_error_m`
// is this error up to largest_fit_error_cells. Gaps measured on surfaces are corrected by it, so that a push
// changes the gap that caused it. Without the correction, bodies would never come to rest on each other.
struct SkinPoint {
  BodyPoint point;
  Vector3 fit_error_m = Vector3::Zero();
};

// Returns the gap between two points whose surfaces are `gap_m` apart along `normal`.
double corrected_gap_m(double gap_m, const Vector3& normal, const SkinPoint& first, const SkinPoint& second) {
  return gap_m + normal.dot(first.fit_error_m - second.fit_error_m);
}

// Returns whether the body stands still in this tick. Its points then need no embedding.
bool stands_still(const BodyState& body) {
  return body.rigid && !body.rigid->moves();
}

// Returns a point that does not move.
SkinPoint make_still_point(const IndexedBody& body) {
  return {{body.index, &body.state->lattice, {}}};
}

SkinPoint make_skin_point(const IndexedBody& body, const EmbeddedPoint& embedding, const Vector3& error_m) {
  const SpringLattice& lattice = body.state->lattice;
  const double most_m = largest_fit_error_cells * static_cast<double>(lattice.cell_size_m());
  const double size_m = error_m.norm();
  const double kept = size_m > most_m ? most_m / size_m : 1.0;
  return {{body.index, &lattice, embedding}, kept * error_m};
}

// `point_m` is the position of the sample on the surface.
SkinPoint find_skin_sample(const IndexedBody& body, int sample, const Vector3& point_m) {
  if (stands_still(*body.state)) return make_still_point(body);
  const EmbeddedPoint& embedding = body.state->mapping().sample(sample);
  if (body.state->rigid) return {{body.index, &body.state->lattice, embedding}};
  return make_skin_point(body, embedding, embedding.position_m(body.state->lattice) - point_m);
}

// Between samples, the embedded point is beside the surface even in the rest shape, because its embedding is
// a blend of those of the samples around it. This offset along the normal is not an error, and turns with the
// surface. `point_m` and `normal` are the position and the normal of the surface.
SkinPoint find_skin_point(const IndexedBody& body, double u, double v, const Vector3& point_m,
                          const Vector3& normal) {
  if (stands_still(*body.state)) return make_still_point(body);
  const BodyMapping& mapping = body.state->mapping();
  const SpringLattice& lattice = body.state->lattice;
  const EmbeddedPoint embedding = mapping.at(u, v);
  if (body.state->rigid) return {{body.index, &lattice, embedding}};
  const Vector3 rest_offset_m = embedding.rest_m(lattice) - position(mapping.rest(), u, v);
  const Vector3 offset_m = embedding.position_m(lattice) - point_m;
  const double height_m = rest_offset_m.dot(unit_normal(mapping.rest(), u, v));
  return make_skin_point(body, embedding, offset_m - height_m * normal);
}

SkinPoint find_own_skin_point(const IndexedBody& body, const NearPoint& near) {
  if (near.sample >= 0) return find_skin_sample(body, near.sample, near.point_m);
  if (stands_still(*body.state)) return make_still_point(body);
  return find_skin_point(body, near.u, near.v, near.point_m,
                         unit_normal(body.state->mapping().current(), near.u, near.v));
}

SkinPoint find_other_skin_point(const IndexedBody& body, const NearPoint& near) {
  // The normal of a contact may be that of the far face of a shell.
  const Vector3 normal = body.state->shell_thickness_m > 0.0 && !stands_still(*body.state)
                             ? unit_normal(body.state->mapping().current(), near.other_u, near.other_v)
                             : near.normal;
  return find_skin_point(body, near.other_u, near.other_v, near.other_m, normal);
}

// Returns a vertex or another point of a body's mesh, which is exactly where its embedding is.
SkinPoint make_mesh_point(const IndexedBody& body, const EmbeddedPoint& embedding) {
  if (stands_still(*body.state)) return make_still_point(body);
  return {{body.index, &body.state->lattice, embedding}};
}

std::pair<double, double> find_sample_parameters(const BodyMapping& mapping, int sample) {
  const Grid& grid = mapping.nested().grid;
  return {grid.u.parameters[sample / grid.columns()], grid.v.parameters[sample % grid.columns()]};
}

}  // namespace

EmbeddedPoint find_embedding(const BodyMapping& mapping, const NearPoint& near) {
  return near.sample >= 0 ? mapping.sample(near.sample) : mapping.at(near.u, near.v);
}

namespace {

Quaternion find_turn(const BodyState& body) {
  return body.rigid ? body.rigid->pose().orientation : Quaternion::Identity();
}

// Numbers of points between the samples of rigid bodies begin here. Surfaces have fewer samples.
constexpr int first_number_between = 1 << 24;

// Selection of the points on which two rigid bodies rest (SupportPoints), for each part of the surfaces with
// about the same normal. Flat faces would otherwise need hundreds of constraints.
class RestingPoints {
 public:
  void offer(int index, const Vector3& normal, const Vector3& point_m, double gap_m) {
    for (std::size_t p = 0; p < count_; ++p) {
      if (parts_[p].normal().dot(normal) < least_cosine) continue;
      return parts_[p].offer(index, point_m, gap_m);
    }
    if (count_ == parts_.size()) {
      is_complete_ = false;
      return;
    }
    parts_[count_] = SupportPoints(normal);
    parts_[count_++].offer(index, point_m, gap_m);
  }
  // All points count if the surfaces have more parts than the capacity.
  bool contains(int index) const {
    if (!is_complete_) return true;
    return std::any_of(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const SupportPoints& part) {
                         return std::any_of(part.supports().begin(), part.supports().end(),
                                            [&](const auto& support) { return support.index == index; });
                       });
  }

 private:
  static constexpr double least_cosine = 0.9994;  // 2 degrees
  std::array<SupportPoints, 12> parts_;
  std::size_t count_ = 0;
  bool is_complete_ = true;
};

}  // namespace

bool bears_blunt_bodies(const BodyState& body) {
  return !body.rigid && !body.mesh() && !body.trim &&
         body.mapping().contact_spacing_m() <= static_cast<double>(body.lattice.cell_size_m());
}

bool add_near_points(const IndexedBody& from, const IndexedBody& to, const std::vector<NearPoint>& points,
                     double deepest_new_m, BodyContacts& contacts, const NormalCones& cones) {
  const SpringLattice& cells = from.state->rigid ? to.state->lattice : from.state->lattice;
  const bool both_rigid = from.state->rigid && to.state->rigid;
  const double least_lead_m = both_rigid ? 0.0 : least_lead_cells * static_cast<double>(cells.cell_size_m());
  const Quaternion turn = find_turn(*from.state);
  const auto is_left_out = [&](const NearPoint& near) {
    if (near.sample < 0) return near.lead_m < least_lead_m;
    if (!both_rigid) return false;
    const BodyMapping& mapping = from.state->mapping();
    const int columns = mapping.nested().grid.columns();
    return mapping.find_twin(near.sample / columns, near.sample % columns) != near.sample ||
           !cones.allow(near.sample, turn, near.normal);
  };
  RestingPoints resting;
  for (std::size_t p = 0; both_rigid && p < points.size(); ++p) {
    const NearPoint& near = points[p];
    if (!is_left_out(near)) resting.offer(static_cast<int>(p), near.normal, near.point_m, near.gap_m);
  }
  bool complete = true;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const NearPoint& near = points[p];
    if (is_left_out(near) || (both_rigid && !resting.contains(static_cast<int>(p)))) continue;
    const SkinPoint own = find_own_skin_point(from, near), other = find_other_skin_point(to, near);
    // A rigid body that rolls touches between samples, at a point that the next tick finds from the same
    // sample.
    const int number =
        both_rigid && near.sample < 0 ? first_number_between + near.nearest_sample : near.sample;
    complete &= contacts.add(own.point, other.point, near.normal,
                             corrected_gap_m(near.gap_m, near.normal, own, other), deepest_new_m, number);
  }
  return complete;
}

namespace {

// A point on the skin of one of two bodies, near the skin of the other.
struct MeshContact {
  Vector3 point_m, normal;
  double gap_m;
  SkinPoint own, other;
  int number;
};

// Adds contacts of two bodies of which one or both have a mesh. `contact_of(index)` returns a contact, or
// nothing for a point that is left out. Two rigid bodies touch only at the points on which one rests.
template <class ContactOf>
bool add_mesh_contacts(std::size_t count, bool both_rigid, double deepest_new_m, const ContactOf& contact_of,
                       BodyContacts& contacts) {
  RestingPoints resting;
  for (std::size_t c = 0; both_rigid && c < count; ++c) {
    if (const std::optional<MeshContact> contact = contact_of(c)) {
      resting.offer(static_cast<int>(c), contact->normal, contact->point_m, contact->gap_m);
    }
  }
  bool complete = true;
  for (std::size_t c = 0; c < count; ++c) {
    const std::optional<MeshContact> contact = contact_of(c);
    if (!contact || (both_rigid && !resting.contains(static_cast<int>(c)))) continue;
    complete &= contacts.add(contact->own.point, contact->other.point, contact->normal,
                             corrected_gap_m(contact->gap_m, contact->normal, contact->own, contact->other),
                             deepest_new_m, contact->number);
  }
  return complete;
}

// `first` has a surface and `second` a mesh. The cones are those of rigid bodies near another rigid body.
bool add_contacts_of(const IndexedBody& first, const IndexedBody& second, const MeshProximity& proximity,
                     double deepest_new_m, const NormalCones& cones, const NormalCones& mesh_cones,
                     BodyContacts& contacts) {
  const BodyMapping& surface = first.state->mapping();
  const MeshMapping& mesh = *second.state->mesh();
  const bool both_rigid = first.state->rigid && second.state->rigid;
  const Quaternion turn = find_turn(*first.state), mesh_turn = find_turn(*second.state);
  const int columns = surface.nested().grid.columns();
  const auto contact_of_sample = [&](std::size_t index) -> std::optional<MeshContact> {
    const SampleNearMesh& near = proximity.surface_samples()[index];
    if (both_rigid && (surface.find_twin(near.sample / columns, near.sample % columns) != near.sample ||
                       !cones.allow(near.sample, turn, near.mesh.normal))) {
      return std::nullopt;
    }
    const auto [u, v] = find_sample_parameters(surface, near.sample);
    const Vector3 point_m = position(surface.current(), u, v);
    return MeshContact{point_m,
                       near.mesh.normal,
                       near.mesh.gap_m,
                       find_skin_sample(first, near.sample, point_m),
                       make_mesh_point(second, mesh.at(near.mesh.on)),
                       near.sample};
  };
  const auto contact_of_vertex = [&](std::size_t index) -> std::optional<MeshContact> {
    const VertexNearSurface& near = proximity.mesh_vertices()[index];
    if (!mesh_cones.allow(static_cast<int>(near.vertex), mesh_turn, near.normal)) return std::nullopt;
    return MeshContact{mesh.current().vertices_m()[near.vertex],
                       near.normal,
                       near.gap_m,
                       make_mesh_point(second, mesh.vertex(near.vertex)),
                       find_skin_point(first, near.u, near.v, position(surface.current(), near.u, near.v),
                                       unit_normal(surface.current(), near.u, near.v)),
                       static_cast<int>(near.vertex)};
  };
  const bool samples_complete = add_mesh_contacts(proximity.surface_samples().size(), both_rigid,
                                                  deepest_new_m, contact_of_sample, contacts);
  const bool vertices_complete = add_mesh_contacts(proximity.mesh_vertices().size(), both_rigid,
                                                   deepest_new_m, contact_of_vertex, contacts);
  return samples_complete && vertices_complete;
}

// `vertices` are those of the mesh of `from` near the mesh of `to`. `cones` are those of a rigid body `from`
// near another rigid body.
bool add_contacts_of(const IndexedBody& from, const IndexedBody& to,
                     const std::vector<VertexNearMesh>& vertices, double deepest_new_m,
                     const NormalCones& cones, BodyContacts& contacts) {
  const MeshMapping &own = *from.state->mesh(), &other = *to.state->mesh();
  const bool both_rigid = from.state->rigid && to.state->rigid;
  const Quaternion turn = find_turn(*from.state);
  const auto contact_of = [&](std::size_t index) -> std::optional<MeshContact> {
    const VertexNearMesh& near = vertices[index];
    if (!cones.allow(static_cast<int>(near.vertex), turn, near.other.normal)) return std::nullopt;
    return MeshContact{own.current().vertices_m()[near.vertex],
                       near.other.normal,
                       near.other.gap_m,
                       make_mesh_point(from, own.vertex(near.vertex)),
                       make_mesh_point(to, other.at(near.other.on)),
                       static_cast<int>(near.vertex)};
  };
  return add_mesh_contacts(vertices.size(), both_rigid, deepest_new_m, contact_of, contacts);
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
  const auto [u, v] = find_sample_parameters(mapping, deepest->sample);
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
  proximity.keep_if(
      [&](const SampleNearMesh& near) {
        const auto [u, v] = find_sample_parameters(body.mapping(), near.sample);
        return is_untrimmed(body, u, v);
      },
      [&](const VertexNearSurface& near) { return is_untrimmed(body, near.u, near.v); });
}

// Returns the length of a cell to which distances between two bodies are related, m: the larger one of those
// that are not rigid. The frames of rigid bodies have a length like that of cells, which is used between two
// such bodies.
double find_cell_m(const BodyState& first, const BodyState& second) {
  const bool both_rigid = first.rigid && second.rigid;
  const auto size_of_cells = [&](const BodyState& body) {
    return body.rigid && !both_rigid ? 0.0 : static_cast<double>(body.lattice.cell_size_m());
  };
  return std::max(size_of_cells(first), size_of_cells(second));
}

// Returns the sum of how far any points of two bodies, or of the same body, move in a tick.
double find_motion_m(const BodyState& first, const BodyState& second) {
  return tick_s * (first.fastest_m_per_s() + second.fastest_m_per_s());
}

// Returns a bound of how far points of two bodies approach each other in a tick at their present velocities.
double find_steady_approach_m(const BodyState& first, const BodyState& second) {
  const NodeSpeeds one = first.lattice.find_node_speeds(), other = second.lattice.find_node_speeds();
  const double speed_m_per_s = (one.mean_m_per_s - other.mean_m_per_s).norm() +
                               one.fastest_from_mean_m_per_s + other.fastest_from_mean_m_per_s;
  return std::min(tick_s * speed_m_per_s, find_motion_m(first, second));
}

// Returns a bound of how far points of two bodies, or of the same body, approach each other in a tick. Bodies
// that fall side by side approach each other only if something stops one of them; this is found in the next
// tick, before they are a cell deep.
double find_approach_m(const BodyState& first, const BodyState& second, double cell_m) {
  const double moved_m = find_motion_m(first, second);
  if (moved_m <= cell_m) return moved_m;  // the other bound is a cell or more
  return std::min(find_steady_approach_m(first, second) + cell_m, moved_m);
}

void find_near_points(SurfaceProximity& proximity, const BodyState& first, const BodyState& second,
                      double margin) {
  const ShellOrSolid one{&first.mapping().current(), first.shell_thickness_m},
      other{&second.mapping().current(), second.shell_thickness_m};
  const Pose frame = first.rigid ? first.rigid->pose() : second.rigid ? second.rigid->pose() : Pose{};
  proximity.find(*one.surface, *other.surface, margin + one.thickness_m + other.thickness_m, 1.0, frame);
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
  proximity.keep_if(
      [&](SampleNearMesh& near) {
        const auto [u, v] = find_sample_parameters(first.mapping(), near.sample);
        near.mesh.gap_m -= far_face_offset_m(thickness, unit_normal(surface, u, v), near.mesh.normal);
        return near.mesh.gap_m <= margin;
      },
      [&](VertexNearSurface& near) {
        return find_shell_gap(surface, thickness, near.u, near.v, mesh.vertices_m()[near.vertex], margin,
                              near.normal, near.gap_m);
      });
}

void find_near_points(MeshPairProximity& proximity, const BodyState& first, const BodyState& second,
                      double margin) {
  proximity.find(first.mesh()->current(), second.mesh()->current(), margin);
}

// Returns the samples of a body that have no contacts with another one.
SkippedSamples find_skipped(const BodyState& body, const BodyState& other) {
  if (body.trim) return {};  // samples beside a trim may be the only ones that are near
  if (!body.rigid || !bears_blunt_bodies(other)) return body.mapping().skipped();
  return find_blunt_samples(body.mapping().rest(), body.mapping().nested().grid,
                            other.mapping().contact_spacing_m(), body.shell_thickness_m > 0.0);
}

}  // namespace

BodyPairContact::BodyPairContact(const BodyState& first, const BodyState& second) {
  const MeshMapping *const first_mesh = first.mesh(), *const second_mesh = second.mesh();
  is_mesh_first_ = first_mesh && !second_mesh;
  if (first_mesh && second_mesh) {
    proximity_ = std::make_unique<MeshPairProximity>(first_mesh->patches(), second_mesh->patches());
  } else if (first_mesh) {
    proximity_ = std::make_unique<MeshProximity>(second.mapping().nested(), first_mesh->patches(),
                                                 find_skipped(second, first));
  } else if (second_mesh) {
    proximity_ = std::make_unique<MeshProximity>(first.mapping().nested(), second_mesh->patches(),
                                                 find_skipped(first, second));
  } else {
    proximity_ = std::make_unique<SurfaceProximity>(first.mapping().nested(), second.mapping().nested(),
                                                    find_skipped(first, second), find_skipped(second, first));
  }
  if (!first.rigid || !second.rigid) return;
  const auto make_cones = [](const BodyState& body) {
    const MeshMapping* const mesh = body.mesh();
    return mesh ? NormalCones(*mesh) : NormalCones(body.mapping(), body.shell_thickness_m > 0.0);
  };
  first_cones_ = make_cones(first);
  second_cones_ = make_cones(second);
}

namespace {

// Returns the largest depth of a point that had no contact before: how far bodies have come into each other
// in the last step, if they move by `tick_motion_m` in a tick.
double find_deepest_new_m(double cell_m, double tick_motion_m, const BodyContacts& contacts) {
  return std::max(deepest_new_cells * cell_m, contacts.time_s() / tick_s * tick_motion_m);
}

// Approach in a tick, in cells, above which all samples of a rigid body have contacts, blunt or not. The
// samples of a soft body may then be behind the wall before they have a contact.
constexpr double fast_approach_cells = 0.1;

}  // namespace

int BodyPairContact::choose_tick_parts(const BodyState& first, const BodyState& second) const {
  const double cell_m = find_cell_m(first, second);
  if (!(least_gap_m() < find_approach_m(first, second, cell_m))) return 1;
  // A body that is carried approaches its bearer only if it moves on it.
  const double approach_m = find_steady_approach_m(first, second);
  int parts = 1;
  while (parts < tick_parts_limit && approach_m > parts * approach_limit_cells * cell_m) parts *= 2;
  return parts;
}

bool BodyPairContact::find(const IndexedBody& first, const IndexedBody& second, double time_s) {
  const double cell = find_cell_m(*first.state, *second.state);
  // Bodies that are lowered move without a velocity.
  const double lowered_m = tick_s * (first.state->lowering_m_per_s + second.state->lowering_m_per_s);
  const double tick_motion_m = find_approach_m(*first.state, *second.state, cell) + lowered_m;
  const double motion_m = time_s / tick_s * tick_motion_m;
  // Points that come within reach during a step need their constraints when it begins. Bodies may become
  // faster in it.
  const double margin_m = std::max(contact_margin_cells * cell, 2.0 * motion_m);
  cell_m_ = cell;
  tick_motion_m_ = tick_motion_m;
  const BodyState &one = is_mesh_first_ ? *second.state : *first.state,
                  &other = is_mesh_first_ ? *first.state : *second.state;
  if (const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_)) {
    const bool is_slow = tick_motion_m <= fast_approach_cells * cell;
    (*surfaces)->set_skipping(!first.state->rigid || is_slow, !second.state->rigid || is_slow);
  }
  return std::visit(
      [&](const auto& proximity) {
        find_near_points(*proximity, one, other, margin_m);
        return !proximity->overflow();
      },
      proximity_);
}

void BodyPairContact::forget() {
  if (const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_)) {
    (*surfaces)->forget();
  }
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_first(const BodyState& first) const {
  if (const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_)) {
    return find_deepest((*surfaces)->first_points());
  }
  const auto* const mesh = std::get_if<std::unique_ptr<MeshProximity>>(&proximity_);
  if (mesh == nullptr || is_mesh_first_) return std::nullopt;
  return find_deepest((*mesh)->surface_samples(), first.mapping());
}

std::optional<SurfaceSpot> BodyPairContact::deepest_on_second(const BodyState& second) const {
  if (const auto* const surfaces = std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_)) {
    return find_deepest((*surfaces)->second_points());
  }
  const auto* const mesh = std::get_if<std::unique_ptr<MeshProximity>>(&proximity_);
  if (mesh == nullptr || !is_mesh_first_) return std::nullopt;
  return find_deepest((*mesh)->surface_samples(), second.mapping());
}

bool BodyPairContact::add_contacts(const IndexedBody& first, const IndexedBody& second,
                                   BodyContacts& contacts) const {
  const double deepest_new_m = find_deepest_new_m(cell_m_, tick_motion_m_, contacts);
  if (const auto* const mesh = std::get_if<std::unique_ptr<MeshProximity>>(&proximity_)) {
    return is_mesh_first_
               ? add_contacts_of(second, first, **mesh, deepest_new_m, second_cones_, first_cones_, contacts)
               : add_contacts_of(first, second, **mesh, deepest_new_m, first_cones_, second_cones_, contacts);
  }
  if (const auto* const meshes = std::get_if<std::unique_ptr<MeshPairProximity>>(&proximity_)) {
    const bool first_complete =
        add_contacts_of(first, second, (*meshes)->first_vertices(), deepest_new_m, first_cones_, contacts);
    const bool second_complete =
        add_contacts_of(second, first, (*meshes)->second_vertices(), deepest_new_m, second_cones_, contacts);
    return first_complete && second_complete;
  }
  const SurfaceProximity& surfaces = **std::get_if<std::unique_ptr<SurfaceProximity>>(&proximity_);
  const bool first_complete =
      add_near_points(first, second, surfaces.first_points(), deepest_new_m, contacts, first_cones_);
  const bool second_complete =
      add_near_points(second, first, surfaces.second_points(), deepest_new_m, contacts, second_cones_);
  return first_complete && second_complete;
}

BodySelfContact::BodySelfContact(const BodyState& body) {
  SPOONBILL_ASSERT_DEBUG(body.fixed.size() == static_cast<std::size_t>(body.lattice.mesh().node_count()));
  if (body.mesh() != nullptr || body.lattice.mesh().slender || body.rigid) return;
  proximity_ = std::make_unique<SelfProximity>(body.mapping().nested(), body.mapping().rest(),
                                               static_cast<double>(body.lattice.cell_size_m()));
}

void BodySelfContact::carry_over(const BodySelfContact& before, const BodyMapping& coarser,
                                 const BodyMapping& finer) {
  if (!proximity_ || !before.proximity_) return;
  proximity_->carry_over(*before.proximity_, coarser.current().net, finer.current().net);
}

bool BodySelfContact::add_contacts(const IndexedBody& body, BodyContacts& contacts) const {
  if (!proximity_) return true;
  const auto cell_m = static_cast<double>(body.state->lattice.cell_size_m());
  const double motion_m = find_approach_m(*body.state, *body.state, cell_m);
  const double deepest_new_m = find_deepest_new_m(cell_m, motion_m, contacts);
  proximity_->find(body.state->mapping().current(), std::max(contact_margin_cells * cell_m, motion_m));
  if (const TrimmedArea* const trim = body.state->trim.get()) {
    proximity_->keep_if([&](const NearPoint& near) {
      return trim->contains(near.u, near.v) && trim->contains(near.other_u, near.other_v);
    });
  }
  const bool complete = add_near_points(body, body, proximity_->points(), deepest_new_m, contacts);
  return complete && !proximity_->overflow();
}

}  // namespace spoonbill
