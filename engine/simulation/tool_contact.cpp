#include "engine/simulation/tool_contact.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/simulation/body_pair_contact.h"
#include "engine/simulation/shell_gap.h"
#include "engine/simulation/tool_kernel.h"

namespace spoonbill {
namespace {

constexpr int constraint_capacity = 1024;

// How near a sample must be to become a constraint, in lattice cells: what the refit may leave between the
// surface that collides and the lattice that gives way.
constexpr double margin_cells = 0.5;

double margin_of(const BodyState& body) {
  return margin_cells * static_cast<double>(body.lattice.cell_size_m());
}

// The way in which the tool pushes a point: the gradient of its distance.
Vector3 push_at(const ToolShape& tool, const Vector3& point_m) {
  if (tool.is_solid()) return tool.at(point_m).gradient;
  const Vector3 from_centre = point_m - tool.centre_m;
  const double distance = from_centre.norm();
  return distance > 0.0 ? Vector3(from_centre / distance) : Vector3::Zero();
}

bool is_inside(const CollisionResult& collision) {
  return collision.found && collision.nearest.depth_m >= 0.0;
}

Vector3 position_of(const SpringLattice& lattice, const EmbeddedPoint& point) {
  Vector3 position = Vector3::Zero();
  for (int i = 0; i < point.count; ++i) {
    position += static_cast<double>(point.weight[i]) * lattice.position(point.node[i]);
  }
  return position;
}

ToolShape shape_of(const Tool& tool, const ToolModel& model, const ToolHold& hold) {
  if (tool.kind == ToolKind::solid && model.distance) {
    return ToolShape::solid(*model.distance, hold.pose.position_m, hold.turn);
  }
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  return ToolShape::sphere(hold.pose.position_m, radius);
}

}  // namespace

ToolContact::ToolContact(std::span<const BodyState> bodies, const ToolModel& model)
    : constraints_(constraint_capacity) {
  contacts_.reserve(bodies.size());
  for (const BodyState& body : bodies) {
    contacts_.push_back({SurfaceCollider(body.mapping().nested(), body.trim), nullptr, {}});
    if (!model.surface) continue;
    contacts_.back().proximity = std::make_unique<SurfaceProximity>(body.mapping().nested(), *model.nested);
  }
  if (model.surface) placed_ = std::make_unique<Surface>(*model.surface);
}

void ToolContact::release() {
  constraints_.clear();
  gripped_ = false;
}

void ToolContact::lift() {
  release();
  lifted_ = true;
}

int ToolContact::deepest_body() const {
  const auto depth = [&](std::size_t body) {
    const CollisionResult& collision = contacts_[body].collision;
    return collision.found ? collision.nearest.depth_m : -1e300;
  };
  std::size_t deepest = 0;
  for (std::size_t body = 1; body < contacts_.size(); ++body) {
    if (depth(body) > depth(deepest)) deepest = body;
  }
  return static_cast<int>(deepest);
}

void ToolContact::prepare(std::span<const BodyState> bodies, const Tool& tool, const ToolModel& model,
                          const ToolHold& hold) {
  SPOONBILL_ASSERT(bodies.size() == contacts_.size());
  SPOONBILL_ASSERT(hold.reach_m >= 0.0);
  is_solid_ = tool.kind == ToolKind::solid;
  if (is_surface()) place(model.surface->net, hold.turn, hold.pose.position_m, placed_->net);
  overflow_ = false;
  bool inside = false, near = false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    find(contacts_[b], bodies[b], tool, model, hold);
    overflow_ |= contacts_[b].collision.overflow;
    const CollisionResult& collision = contacts_[b].collision;
    inside |= is_inside(collision);
    near |= collision.found && -collision.nearest.depth_m <= margin_of(bodies[b]);
  }
  if (!acts(inside, near, hold)) return release();
  kernel_of(tool.action).constrain(*this, {bodies, hold, inside});
}

void ToolContact::push(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (contacts_[b].collision.found) add_pushes(static_cast<int>(b), bodies[b], hold);
  }
}

void ToolContact::grip(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (is_inside(contacts_[b].collision)) add_grips(static_cast<int>(b), bodies[b], hold.pose);
  }
  gripped_ = true;
}

// A body that the tool has just pressed lies against it, and quivers: the tool has left when it is a margin
// away, or hovers.
bool ToolContact::acts(bool inside, bool near, const ToolHold& hold) {
  const bool against = hold.hovering ? inside : near;
  lifted_ = lifted_ && (against || hold.gripping);
  hovered_ = hold.hovering || (hovered_ && inside);
  return !lifted_ && !hovered_;
}

void ToolContact::prepare_soft() {
  constraints_.clear();
  overflow_ = false;
  for (BodyContact& contact : contacts_) contact.collision = {};
}

void ToolContact::find(BodyContact& contact, const BodyState& body, const Tool& tool, const ToolModel& model,
                       const ToolHold& hold) {
  // What a fast tool meets within the tick holds it off before it has passed.
  const double margin = std::max(margin_of(body), hold.reach_m);
  if (is_surface()) return find_near(contact, body, margin, hold);
  shape_ = shape_of(tool, model, hold);
  const double thickness = body.shell_thickness_m;
  // A trimmed skin is open: through its holes a tool comes inside.
  const bool closed = !(thickness > 0.0) && !body.trim;
  contact.collision = contact.collider.collide(body.mapping().current(), shape_, margin + thickness, closed);
  if (thickness > 0.0) take_face(contact, body, margin);
}

bool ToolContact::is_small(const BodyState& body) const {
  return !is_solid_ && shape_.radius_m < static_cast<double>(body.lattice.cell_size_m());
}

void ToolContact::take_face(BodyContact& contact, const BodyState& body, double margin) const {
  CollisionResult& collision = contact.collision;
  SurfaceContact& nearest = collision.nearest;
  if (!collision.found) return;
  const double thickness = body.shell_thickness_m;
  const Surface& surface = body.mapping().current();
  Vector3 normal = nearest.normal;
  bool behind = false;
  if (is_small(body)) {
    // Which may come through the surface's middle: the side tells, not the way that it pushes.
    double gap = 0.0;
    collision.found = gap_to_shell(surface, thickness, nearest.u, nearest.v, shape_.centre_m,
                                   margin + shape_.radius_m, normal, gap);
    behind = normal.dot(nearest.normal) < 0.0;
    nearest.depth_m = shape_.radius_m - gap;
  } else {
    const double lead = far_face_lead_m(thickness, normal, push_at(shape_, nearest.point_m));
    behind = lead > 0.0;
    nearest.depth_m += lead;
    collision.found = -nearest.depth_m <= margin;
  }
  if (!behind) return;
  nearest.point_m -= thickness * nearest.normal;
  nearest.normal = -nearest.normal;
  nearest.tangent_v = -nearest.tangent_v;
}

void ToolContact::find_near(BodyContact& contact, const BodyState& body, double margin,
                            const ToolHold& hold) {
  const Surface& surface = body.mapping().current();
  SurfaceProximity& proximity = *contact.proximity;
  const double thickness = body.shell_thickness_m;
  proximity.find(surface, *placed_, margin + thickness, hold.turn.determinant() < 0.0 ? -1.0 : 1.0);
  if (thickness > 0.0) {
    const MaybeShell shell{&surface, thickness}, solid{placed_.get(), 0.0};
    proximity.keep_if([&](NearPoint& near) { return settle_shell_gap(shell, solid, margin, near); },
                      [&](NearPoint& near) { return settle_shell_gap(solid, shell, margin, near); });
  }
  if (body.trim) {
    proximity.keep_if([&](const NearPoint& near) { return body.trim->contains(near.u, near.v); },
                      [&](const NearPoint& near) { return body.trim->contains(near.other_u, near.other_v); });
  }
  contact.collision = {};
  contact.collision.overflow = proximity.overflow();
  const auto deepest =
      std::min_element(proximity.first_points().begin(), proximity.first_points().end(),
                       [](const NearPoint& one, const NearPoint& other) { return one.gap_m < other.gap_m; });
  if (deepest == proximity.first_points().end()) return;
  contact.collision.found = true;
  contact.collision.nearest = contact_at(surface, {deepest->u, deepest->v, deepest->point_m, deepest->gap_m});
}

// Every point of the body's surface that is near the tool, with the plane of the tool there.
template <class Visit>
void ToolContact::visit_near(BodyContact& contact, const BodyState& state, const Visit& visit) {
  if (is_surface()) {
    for (const NearPoint& near : contact.proximity->first_points()) {
      visit(Pushed{embedding_of(state.mapping(), near), near.normal, near.gap_m});
    }
    for (const NearPoint& near : contact.proximity->second_points()) {
      visit(Pushed{state.mapping().at(near.other_u, near.other_v), -near.normal, near.gap_m});
    }
    return;
  }
  for (const NearSample& sample : contact.collider.near_samples()) {
    const DistanceSample distance = shape_.at(contact.collider.levels().sample(sample.index));
    visit(Pushed{state.mapping().sample(sample.index), distance.gradient, distance.distance_m});
  }
}

void ToolContact::add_pushes(int body, const BodyState& state, const ToolHold& hold) {
  BodyContact& contact = contacts_[body];
  const SurfaceContact& nearest = contact.collision.nearest;
  if (state.shell_thickness_m > 0.0 && !is_surface()) return add_shell_pushes(body, state, hold);
  if (!is_solid_) return add_sphere_pushes(body, state);
  add_plane_push(body, state, {state.mapping().at(nearest.u, nearest.v), -nearest.normal, -nearest.depth_m},
                 hold);
  visit_near(contact, state, [&](const Pushed& pushed) { add_plane_push(body, state, pushed, hold); });
}

double ToolContact::gap_of(const BodyState& state, const NearSample& sample) const {
  if (!(state.shell_thickness_m > 0.0)) return sample.distance_m;
  const Grid& grid = state.mapping().nested().grid;
  const double u = grid.u.parameters[sample.index / grid.columns()],
               v = grid.v.parameters[sample.index % grid.columns()];
  const Vector3 normal = unit_normal(state.mapping().current(), u, v);
  const Vector3 push = push_at(shape_, position(state.mapping().current(), u, v));
  return sample.distance_m - far_face_lead_m(state.shell_thickness_m, normal, push);
}

// Away from the tool, whichever face it is at.
void ToolContact::add_shell_pushes(int body, const BodyState& state, const ToolHold& hold) {
  BodyContact& contact = contacts_[body];
  const SurfaceContact& nearest = contact.collision.nearest;
  const EmbeddedPoint deepest = state.mapping().at(nearest.u, nearest.v);
  if (is_small(state)) return add_plane_push(body, state, {deepest, -nearest.normal, -nearest.depth_m}, hold);
  const Vector3 push = push_at(shape_, position(state.mapping().current(), nearest.u, nearest.v));
  add_plane_push(body, state, {deepest, push, -nearest.depth_m}, hold);
  const double margin = std::max(margin_of(state), hold.reach_m);
  for (const NearSample& sample : contact.collider.near_samples()) {
    const double gap = gap_of(state, sample);
    if (gap > margin) continue;
    const Vector3 away = push_at(shape_, contact.collider.levels().sample(sample.index));
    add_plane_push(body, state, {state.mapping().sample(sample.index), away, gap}, hold);
  }
}

// The samples, and the plane of the nearest point: for a tool that fits between samples always, for others
// where they are so near that it is still the nearest a tick later.
void ToolContact::add_sphere_pushes(int body, const BodyState& state) {
  BodyContact& contact = contacts_[body];
  const SurfaceContact& nearest = contact.collision.nearest;
  const double cell = static_cast<double>(state.lattice.cell_size_m());
  if (-nearest.depth_m <= margin_of(state) || shape_.radius_m < cell) {
    overflow_ |= !constraints_.add_plane_push(body, state.lattice, state.mapping().at(nearest.u, nearest.v),
                                              -nearest.normal, shape_.radius_m);
  }
  for (const NearSample& sample : contact.collider.near_samples()) {
    overflow_ |= !constraints_.add_push(body, state.lattice, state.mapping().sample(sample.index));
  }
}

// The gap is that of the surface; what its embedding is off by now stays the same over a tick.
void ToolContact::add_plane_push(int body, const BodyState& state, const Pushed& pushed,
                                 const ToolHold& hold) {
  const Vector3 from_centre = position_of(state.lattice, pushed.point) - hold.pose.position_m;
  overflow_ |= !constraints_.add_plane_push(body, state.lattice, pushed.point, pushed.normal,
                                            from_centre.dot(pushed.normal) - pushed.gap_m);
}

void ToolContact::add_grips(int body, const BodyState& state, const Pose& pose) {
  const auto grip = [&](const EmbeddedPoint& point) {
    const Vector3 offset =
        pose.orientation.conjugate() * (position_of(state.lattice, point) - pose.position_m);
    overflow_ |= !constraints_.add_grip(body, state.lattice, point, offset);
  };
  BodyContact& contact = contacts_[body];
  grip(state.mapping().at(contact.collision.nearest.u, contact.collision.nearest.v));
  if (is_surface()) {
    visit_near(contact, state, [&](const Pushed& near) {
      if (near.gap_m <= 0.0) grip(near.point);
    });
    return;
  }
  for (const NearSample& sample : contact.collider.near_samples()) {
    if (gap_of(state, sample) <= 0.0) grip(state.mapping().sample(sample.index));
  }
}

}  // namespace spoonbill
