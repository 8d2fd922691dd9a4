#include "engine/simulation/tool_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/simulation/body_contact.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {
namespace {

constexpr int constraint_capacity = 2048;

// Gap, in lattice cells, up to which the surface is searched for points near the tool. It is the largest
// distance that the refit may leave between the surface used for collision and the lattice. Of the points
// found, spheres push only those within find_approach_m().
constexpr double tool_margin_cells = 0.5;

// A tool of local reach shows what it would shape from this distance on. Only points within the margin above
// are pushed.
constexpr double local_preview_m = 0.003;

double find_margin_m(const BodyState& body) {
  return tool_margin_cells * static_cast<double>(body.lattice.cell_size_m());
}

// Returns the direction in which the tool pushes a point: the gradient of the tool's distance function, or
// zero at a sphere's centre.
Vector3 push_direction_at(const ToolShape& tool, const Vector3& point_m) {
  if (tool.is_solid()) return tool.at(point_m).gradient;
  const Vector3 from_centre = point_m - tool.centre_m;
  const double distance = from_centre.norm();
  return distance > 0.0 ? Vector3(from_centre / distance) : Vector3::Zero();
}

// Returns an estimate, m, of how far a point of the body and the tool approach each other in this tick.
// `reach_m` is the largest movement of the tool. The nodes may become twice as fast as they are, and
// start_cells is an allowance, in lattice cells, for nodes that are set in motion. Contacts set an implicitly
// stepped lattice in motion more strongly, because they only estimate its mass. Points that approach by more
// are pushed in the next tick.
double find_approach_m(const BodyState& body, double reach_m) {
  using Values = Eigen::Map<const Eigen::ArrayXf>;
  const double start_cells = body.lattice.moved_by_solver() ? 0.1 : 0.01;
  const int nodes = body.lattice.mesh().node_count();
  const Values vx(body.lattice.velocities(0), nodes), vy(body.lattice.velocities(1), nodes),
      vz(body.lattice.velocities(2), nodes);
  const double speed = std::sqrt(static_cast<double>((vx * vx + vy * vy + vz * vz).maxCoeff()));
  return reach_m + 2.0 * tick_s * speed + start_cells * static_cast<double>(body.lattice.cell_size_m());
}

bool is_inside(const CollisionResult& collision) {
  return collision.found && collision.nearest.depth_m >= 0.0;
}

ToolShape make_shape(const Tool& tool, const ToolModel& model, const ToolHold& hold) {
  if (tool.kind == ToolKind::solid && model.distance) {
    return ToolShape::solid(*model.distance, hold.pose.position_m, hold.turn);
  }
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  return ToolShape::sphere(hold.pose.position_m, radius);
}

}  // namespace

ToolContact::ToolContact(std::span<const BodyState> bodies, const ToolModel& model)
    : constraints_(constraint_capacity), local_stroke_(bodies) {
  contacts_.reserve(bodies.size());
  for (const BodyState& body : bodies) {
    if (body.mesh()) {
      contacts_.emplace_back();
      continue;
    }
    contacts_.push_back({SurfaceCollider(body.mapping().nested(), body.trim), nullptr, {}, 0.0, {}});
    if (!model.surface) continue;
    contacts_.back().proximity = std::make_unique<SurfaceProximity>(body.mapping().nested(), *model.nested);
  }
  if (model.surface) placed_ = std::make_unique<Surface>(*model.surface);
}

void ToolContact::release() {
  constraints_.forget();
  for (BodyContact& contact : contacts_) contact.points.fill({});
  gripped_ = false;
  held_.body = -1;
  local_stroke_.end();
}

void ToolContact::carry_over(const ToolContact& before, int body, std::span<const int> new_sample) {
  SPOONBILL_ASSERT(before.contacts_.size() == contacts_.size());
  lifted_ = before.lifted_;
  hovered_ = before.hovered_;
  gripped_ = before.gripped_;
  held_ = before.held_;
  is_solid_ = before.is_solid_;
  shape_ = before.shape_;
  for (std::size_t b = 0; b < contacts_.size(); ++b) {
    contacts_[b].collision = before.contacts_[b].collision;
    contacts_[b].approach_m = before.contacts_[b].approach_m;
    contacts_[b].points = before.contacts_[b].points;
  }
  constraints_.carry_over(before.constraints_, body, new_sample);
  local_stroke_.carry_over(before.local_stroke_);
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
    near |= collision.found && -collision.nearest.depth_m <= find_margin_m(bodies[b]);
  }
  if (!acts(inside, near, hold)) return release();
  find_kernel(tool).constrain(*this,
                              {bodies, hold, inside, hold.gripping && tool.sideways == ToolGlide::hold});
}

void ToolContact::push(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (contacts_[b].collision.found) {
      contacts_[b].approach_m = find_approach_m(bodies[b], hold.reach_m);
      add_pushes(static_cast<int>(b), bodies[b], hold);
    } else {
      contacts_[b].points.fill({});
    }
  }
  // These points are the most numerous. They come last, so that those of one body cannot leave another body
  // without constraints.
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    if (contacts_[b].collision.found && rests_on_lattice(body, bodies[b])) {
      add_pushes_between_samples(body, bodies[b]);
    }
  }
}

void ToolContact::hold_sideways(std::span<const BodyState> bodies, const ToolHold& hold, bool holds) {
  // A tool that clay has given way under is still at the surface.
  constexpr double lost_gap_m = 5e-4;
  const Pose& pose = hold.pose;
  if (held_.body >= 0) {
    const CollisionResult& collision = contacts_[static_cast<std::size_t>(held_.body)].collision;
    if (!holds || !collision.found || -collision.nearest.depth_m > lost_gap_m) held_.body = -1;
  } else if (const int deepest = deepest_body(); holds && is_inside(collision(deepest))) {
    const BodyState& state = bodies[static_cast<std::size_t>(deepest)];
    const SurfaceContact& nearest = collision(deepest).nearest;
    const Vector3 point_m = state.mapping().at(nearest.u, nearest.v).position_m(state.lattice);
    const Quaternion into_tool = pose.orientation.conjugate();
    held_ = {deepest, nearest.u, nearest.v, into_tool * (point_m - pose.position_m),
             into_tool * nearest.normal};
  }
  if (held_.body < 0) return;
  const BodyState& state = bodies[static_cast<std::size_t>(held_.body)];
  overflow_ |= !constraints_.add_hold(held_.body, state.lattice, state.mapping().at(held_.u, held_.v),
                                      held_.offset_m, pose.orientation * held_.normal);
}

void ToolContact::grip(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (is_inside(contacts_[b].collision)) add_grips(static_cast<int>(b), bodies[b], hold.pose);
  }
  gripped_ = true;
}

void ToolContact::push_nearest(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (contacts_[b].collision.found) {
      add_nearest_pushes(static_cast<int>(b), bodies[b], hold);
    } else {
      contacts_[b].points.fill({});
    }
  }
}

void ToolContact::grip_nearest(std::span<const BodyState> bodies, const ToolHold& hold) {
  constraints_.clear();
  const int body = deepest_body();
  const BodyState& state = bodies[static_cast<std::size_t>(body)];
  const SurfaceContact& nearest = contacts_[static_cast<std::size_t>(body)].collision.nearest;
  const EmbeddedPoint point = state.mapping().at(nearest.u, nearest.v);
  const Pose& pose = hold.pose;
  const Vector3 offset = pose.orientation.conjugate() * (point.position_m(state.lattice) - pose.position_m);
  overflow_ |= !constraints_.add_grip(body, state.lattice, point, offset);
  gripped_ = true;
}

// After a push, the body vibrates against the tool. A lifted tool therefore counts as clear of the body only
// at a distance of one margin or, while it hovers, outside the body.
bool ToolContact::acts(bool inside, bool near, const ToolHold& hold) {
  const bool is_against = hold.hovering ? inside : near;
  lifted_ = lifted_ && (is_against || hold.gripping);
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
  if (body.mesh()) return;
  // The margin grows with the tool's movement, so that a fast tool cannot pass a body within a tick.
  double margin = std::max(find_margin_m(body), hold.reach_m);
  if (tool.is_local()) margin = std::max(margin, local_preview_m);
  if (is_surface()) return find_near_points(contact, body, margin, hold);
  shape_ = make_shape(tool, model, hold);
  const double thickness = body.shell_thickness_m;
  // A trimmed surface is open: a tool can get inside through its holes.
  const bool closed = !(thickness > 0.0) && !body.trim;
  const Box box = bounding_box(body.mapping().current().net);
  if (shape_.is_beyond(box.centre(), 0.5 * box.size(), margin + thickness)) {
    contact.collision = {};
    contact.collider->clear_near_samples();
    return;
  }
  contact.collision = contact.collider->collide(body.mapping().current(), shape_, margin + thickness, closed);
  if (thickness > 0.0) select_shell_face(contact, body, margin);
}

bool ToolContact::is_small(const BodyState& body) const {
  return !is_solid_ && shape_.radius_m < static_cast<double>(body.lattice.cell_size_m());
}

bool ToolContact::is_centre_outside(int body) const {
  return contacts_[body].collision.nearest.depth_m <= shape_.radius_m;
}

bool ToolContact::rests_on_lattice(int body, const BodyState& state) const {
  return !is_solid_ && !(state.shell_thickness_m > 0.0) && !is_small(state) && is_centre_outside(body);
}

void ToolContact::select_shell_face(BodyContact& contact, const BodyState& body, double margin) const {
  CollisionResult& collision = contact.collision;
  SurfaceContact& nearest = collision.nearest;
  if (!collision.found) return;
  const double thickness = body.shell_thickness_m;
  const Surface& surface = body.mapping().current();
  Vector3 normal = nearest.normal;
  bool behind = false;
  if (is_small(body)) {
    // A small tool can be inside the shell. Its position, not its push direction, then decides which face it
    // touches.
    double gap = 0.0;
    collision.found = find_shell_gap(surface, thickness, nearest.u, nearest.v, shape_.centre_m,
                                     margin + shape_.radius_m, normal, gap);
    behind = normal.dot(nearest.normal) < 0.0;
    nearest.depth_m = shape_.radius_m - gap;
  } else {
    const double offset = far_face_offset_m(thickness, normal, push_direction_at(shape_, nearest.point_m));
    behind = offset > 0.0;
    nearest.depth_m += offset;
    collision.found = -nearest.depth_m <= margin;
  }
  if (!behind) return;
  nearest.point_m -= thickness * nearest.normal;
  nearest.normal = -nearest.normal;
  nearest.tangent_v = -nearest.tangent_v;
}

void ToolContact::find_near_points(BodyContact& contact, const BodyState& body, double margin,
                                   const ToolHold& hold) {
  const Surface& surface = body.mapping().current();
  SurfaceProximity& proximity = *contact.proximity;
  const double thickness = body.shell_thickness_m;
  proximity.find(surface, *placed_, margin + thickness, hold.turn.determinant() < 0.0 ? -1.0 : 1.0);
  if (thickness > 0.0) {
    const ShellOrSolid shell{&surface, thickness}, solid{placed_.get(), 0.0};
    proximity.keep_if([&](NearPoint& near) { return resolve_shell_gap(shell, solid, margin, near); },
                      [&](NearPoint& near) { return resolve_shell_gap(solid, shell, margin, near); });
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

// Visits every point of the body's surface near the tool, with the tool's tangent plane there.
template <class Visit>
void ToolContact::visit_near(BodyContact& contact, const BodyState& state, const Visit& visit) {
  if (is_surface()) {
    for (const NearPoint& near : contact.proximity->first_points()) {
      const int key = near.sample >= 0 ? near.sample : changing_point_key;
      visit(Pushed{find_embedding(state.mapping(), near), near.normal, near.gap_m, key});
    }
    for (const NearPoint& near : contact.proximity->second_points()) {
      visit(Pushed{state.mapping().at(near.other_u, near.other_v), -near.normal, near.gap_m,
                   changing_point_key});
    }
    return;
  }
  for (const NearSample& sample : contact.collider->near_samples()) {
    const DistanceSample distance = shape_.at(contact.collider->levels().sample(sample.index));
    visit(Pushed{state.mapping().sample(sample.index), distance.gradient, distance.distance_m, sample.index});
  }
}

namespace {

// The nearest point counts as the same point as in the last tick if it has moved by at most the tool's
// movement plus this many lattice cells.
constexpr double same_point_cells = 0.2;

int key_of(std::size_t point) {
  return nearest_point_key - static_cast<int>(point);
}

}  // namespace

std::size_t ToolContact::track_nearest(int body, const BodyState& state, double reach_m) {
  BodyContact& contact = contacts_[body];
  const SurfaceContact& nearest = contact.collision.nearest;
  const Surface& surface = state.mapping().current();
  const Vector3 at_m = position(surface, nearest.u, nearest.v);
  double least_m = same_point_cells * static_cast<double>(state.lattice.cell_size_m()) + reach_m;
  double least_n = std::numeric_limits<double>::infinity();
  std::size_t same = contact.points.size(), weakest = 0;
  for (std::size_t p = 0; p < contact.points.size(); ++p) {
    ContactPoint& point = contact.points[p];
    const double force_n = constraints_.last_force_n(body, key_of(p));
    point.is_used = point.is_used && force_n > 0.0;
    if (point.is_used) {
      point.position_m = position(surface, point.u, point.v);
      const double distance_m = (point.position_m - at_m).norm();
      if (distance_m <= least_m) {
        least_m = distance_m;
        same = p;
      }
    }
    if (force_n < least_n) {
      least_n = force_n;
      weakest = p;
    }
  }
  const std::size_t found = same < contact.points.size() ? same : weakest;
  contact.points[found] = {true, nearest.u, nearest.v, at_m};
  return found;
}

void ToolContact::add_earlier_pushes(int body, const BodyState& state, std::size_t nearest,
                                     const ToolHold& hold) {
  const BodyContact& contact = contacts_[body];
  for (std::size_t p = 0; p < contact.points.size(); ++p) {
    const ContactPoint& point = contact.points[p];
    if (p == nearest || !point.is_used) continue;
    const Vector3 push = push_direction_at(shape_, point.position_m);
    if (push.isZero(0.0)) continue;
    const double gap = find_gap(state, point.u, point.v, shape_.distance(point.position_m));
    add_plane_push(body, state, {state.mapping().at(point.u, point.v), push, gap, key_of(p)}, hold);
  }
}

// Adds the push at the nearest point and those at the nearest points of earlier ticks. A B-spline tool needs
// none of the latter, because visit_near() visits all of its locally nearest points.
void ToolContact::add_nearest_pushes(int body, const BodyState& state, const ToolHold& hold) {
  const SurfaceContact& nearest = contacts_[body].collision.nearest;
  const std::size_t point = track_nearest(body, state, hold.reach_m);
  add_plane_push(body, state,
                 {state.mapping().at(nearest.u, nearest.v), -nearest.normal, -nearest.depth_m, key_of(point)},
                 hold);
  if (!is_surface()) add_earlier_pushes(body, state, point, hold);
}

void ToolContact::add_pushes(int body, const BodyState& state, const ToolHold& hold) {
  BodyContact& contact = contacts_[body];
  if (state.shell_thickness_m > 0.0 && !is_surface()) return add_shell_pushes(body, state, hold);
  if (!is_solid_) return add_sphere_pushes(body, state, hold);
  add_nearest_pushes(body, state, hold);
  visit_near(contact, state, [&](const Pushed& pushed) { add_plane_push(body, state, pushed, hold); });
}

double ToolContact::find_gap(const BodyState& state, double u, double v, double distance_m) const {
  if (!(state.shell_thickness_m > 0.0)) return distance_m;
  const Vector3 normal = unit_normal(state.mapping().current(), u, v);
  const Vector3 push = push_direction_at(shape_, position(state.mapping().current(), u, v));
  return distance_m - far_face_offset_m(state.shell_thickness_m, normal, push);
}

double ToolContact::find_gap(const BodyState& state, const NearSample& sample) const {
  const Grid& grid = state.mapping().nested().grid;
  return find_gap(state, grid.u.parameters[sample.index / grid.columns()],
                  grid.v.parameters[sample.index % grid.columns()], sample.distance_m);
}

// Adds pushes away from the tool on either face of the shell.
void ToolContact::add_shell_pushes(int body, const BodyState& state, const ToolHold& hold) {
  BodyContact& contact = contacts_[body];
  const SurfaceContact& nearest = contact.collision.nearest;
  const EmbeddedPoint deepest = state.mapping().at(nearest.u, nearest.v);
  const std::size_t point = track_nearest(body, state, hold.reach_m);
  if (is_small(state)) {
    return add_plane_push(body, state, {deepest, -nearest.normal, -nearest.depth_m, key_of(point)}, hold);
  }
  const Vector3 push = push_direction_at(shape_, position(state.mapping().current(), nearest.u, nearest.v));
  add_plane_push(body, state, {deepest, push, -nearest.depth_m, key_of(point)}, hold);
  add_earlier_pushes(body, state, point, hold);
  const double margin = std::max(find_margin_m(state), hold.reach_m);
  for (const NearSample& sample : contact.collider->near_samples()) {
    const double gap = find_gap(state, sample);
    if (gap > margin) continue;
    const Vector3 away = push_direction_at(shape_, contact.collider->levels().sample(sample.index));
    add_plane_push(body, state, {state.mapping().sample(sample.index), away, gap, sample.index}, hold);
  }
}

namespace {

// Largest depth, in lattice cells, to which a sphere may reach between pushed points.
constexpr double largest_reach_cells = 0.005;
// Largest number of parts into which the side of a patch between samples is divided.
constexpr int most_parts = 32;

// Coordinates in [0, 1) x [0, 1) of a point on the bilinear patch between four samples.
struct PatchPoint {
  double s, t;

  Vector3 position(const PatchCorners& corners) const {
    return (1.0 - s) * ((1.0 - t) * corners[0] + t * corners[1]) +
           s * ((1.0 - t) * corners[2] + t * corners[3]);
  }
};

// Returns true only if every point of the patch is farther than `distance_m` from the tool. May return false
// for a patch that is a little farther.
bool is_beyond(const ToolShape& tool, const PatchCorners& corners, double distance_m) {
  const Vector3 centre = PatchPoint{0.5, 0.5}.position(corners);
  double radius_square = 0.0;
  for (const Vector3& corner : corners) {
    radius_square = std::max(radius_square, (corner - centre).squaredNorm());
  }
  return tool.is_beyond(centre, std::sqrt(radius_square), distance_m);
}

// Returns the number of parts into which sides are to be divided, given two opposite sides of a patch.
int count_parts(const Vector3& one_side, const Vector3& other_side, double longest_m) {
  const double square = std::max(one_side.squaredNorm(), other_side.squaredNorm());
  if (square <= longest_m * longest_m) return 1;
  const double parts = std::ceil(std::sqrt(square) / longest_m);
  return static_cast<int>(std::clamp(parts, 1.0, static_cast<double>(most_parts)));
}

}  // namespace

// Adds pushes at fixed points between the samples. The points are so close together that the sphere rests on
// the lattice as if every point were pushed, unless this needs more than most_parts parts per side of a
// patch. A sphere of radius R reaches d^2 / (8 R) between points that are d apart. The points are fixed
// because a push at the nearest point would move, and its force would depend on its path.
void ToolContact::add_pushes_between_samples(int body, const BodyState& state) {
  const BodyMapping& mapping = state.mapping();
  SurfaceLevels& levels = contacts_[body].collider->levels();
  const Grid& grid = mapping.nested().grid;
  const auto &u = grid.u.parameters, &v = grid.v.parameters;
  const int columns = grid.columns(), sample_count = grid.rows() * columns;
  const double cell_m = static_cast<double>(state.lattice.cell_size_m());
  const double margin_m = contacts_[body].approach_m;
  const double longest_m = std::sqrt(8.0 * shape_.radius_m * largest_reach_cells * cell_m);
  for (const LevelCell& cell : contacts_[body].collider->finest_cells()) {
    const int first = cell.i * columns + cell.j;
    const std::array<int, 4> samples{first, first + 1, first + columns, first + columns + 1};
    PatchCorners rest, corners;
    for (std::size_t c = 0; c < corners.size(); ++c) rest[c] = mapping.embedded_rest_m(samples[c]);
    const int parts_u = count_parts(rest[2] - rest[0], rest[3] - rest[1], longest_m);
    const int parts_v = count_parts(rest[1] - rest[0], rest[3] - rest[2], longest_m);
    if (parts_u * parts_v == 1) continue;
    for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = mapping.embedded_m(samples[c]);
    const double farthest_m = margin_m + levels.bulge(cell);
    if (is_beyond(shape_, corners, farthest_m)) continue;
    const PatchCorners on_surface = levels.corners(cell);
    const bool starts_at_pole = rest[0] == rest[2];  // samples at a pole share one embedding
    for (int part = 1; part < parts_u * parts_v; ++part) {
      const PatchPoint at{static_cast<double>(part / parts_v) / parts_u,
                          static_cast<double>(part % parts_v) / parts_v};
      if (starts_at_pole && at.t == 0.0) continue;
      const Vector3 on_chord = at.position(corners);
      if (shape_.distance(on_chord) > farthest_m) continue;
      const double at_u = u[cell.i] + at.s * (u[cell.i + 1] - u[cell.i]);
      const double at_v = v[cell.j] + at.t * (v[cell.j + 1] - v[cell.j]);
      // Embedded points between samples are on chords, over which the surface bulges.
      const Vector3 bulge = position(levels.pieces(), at_u, at_v) - at.position(on_surface);
      if (shape_.distance(on_chord + bulge) > margin_m) continue;
      if (state.trim && !state.trim->contains(at_u, at_v)) continue;
      const int key = sample_count + first * most_parts * most_parts + part;
      overflow_ |= !constraints_.add_push(body, state.lattice, mapping.at(at_u, at_v), key, bulge);
    }
  }
}

// Adds pushes that keep the lattice, rather than the surface, out of the tool. The surface follows the
// lattice with a delay and would dent a plastic body unevenly.
void ToolContact::add_sphere_pushes(int body, const BodyState& state, const ToolHold& hold) {
  BodyContact& contact = contacts_[body];
  if (is_small(state) || is_centre_outside(body)) {
    for (const NearSample& sample : contact.collider->near_samples()) {
      if (shape_.distance(state.mapping().embedded_m(sample.index)) > contact.approach_m) continue;
      overflow_ |=
          !constraints_.add_push(body, state.lattice, state.mapping().sample(sample.index), sample.index);
    }
  }
  if (rests_on_lattice(body, state)) return contact.points.fill({});
  const SurfaceContact& nearest = contact.collision.nearest;
  const std::size_t point = track_nearest(body, state, hold.reach_m);
  overflow_ |= !constraints_.add_plane_push(body, state.lattice, state.mapping().at(nearest.u, nearest.v),
                                            -nearest.normal, shape_.radius_m, key_of(point));
}

// Adds a push whose plane is offset by the gap of the surface. The embedded point itself has a slightly
// different gap, but the difference is constant over a tick.
void ToolContact::add_plane_push(int body, const BodyState& state, const Pushed& pushed,
                                 const ToolHold& hold) {
  const Vector3 from_centre = pushed.point.position_m(state.lattice) - hold.pose.position_m;
  overflow_ |= !constraints_.add_plane_push(body, state.lattice, pushed.point, pushed.normal,
                                            from_centre.dot(pushed.normal) - pushed.gap_m, pushed.key);
}

void ToolContact::add_grips(int body, const BodyState& state, const Pose& pose) {
  const auto grip = [&](const EmbeddedPoint& point) {
    const Vector3 offset = pose.orientation.conjugate() * (point.position_m(state.lattice) - pose.position_m);
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
  for (const NearSample& sample : contact.collider->near_samples()) {
    if (find_gap(state, sample) <= 0.0) grip(state.mapping().sample(sample.index));
  }
}

}  // namespace spoonbill
