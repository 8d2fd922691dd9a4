#include "engine/simulation/tool_contact.h"

namespace spoonbill {
namespace {

constexpr int constraint_capacity = 1024;

// How near a sample must be to become a constraint, in lattice cells: what the refit may leave between the
// surface that collides and the lattice that gives way.
constexpr double margin_cells = 0.5;

bool is_inside(const CollisionResult& collision) {
  return collision.found && collision.nearest.depth_m >= 0.0;
}

}  // namespace

ToolContact::ToolContact(std::span<const BodyState> bodies) : constraints_(constraint_capacity) {
  contacts_.reserve(bodies.size());
  for (const BodyState& body : bodies) contacts_.emplace_back(body.mapping);
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

void ToolContact::prepare(std::span<const BodyState> bodies, const Tool& tool, const Pose& pose,
                          bool gripping, bool hovering) {
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  const ToolShape shape = ToolShape::sphere(pose.position_m, radius);
  overflow_ = false;
  bool inside = false, near = false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double margin = margin_cells * static_cast<double>(bodies[b].lattice.cell_size_m());
    CollisionResult& collision = contacts_[b].collision;
    collision = contacts_[b].collider.collide(bodies[b].mapping.current(), shape, margin, true);
    overflow_ |= collision.overflow;
    inside |= is_inside(collision);
    near |= collision.found;
  }
  // A body that the tool has just pressed lies against it, and quivers: the tool has left when it is a margin
  // away, or hovers.
  const bool against = hovering ? inside : near;
  lifted_ = lifted_ && (against || gripping);
  hovered_ = hovering || (hovered_ && inside);
  if (lifted_ || hovered_) return release();
  const bool pulls = tool.action == ToolAction::pull;
  if (pulls && !gripping) return release();
  const bool grips = pulls && !gripped_ && inside;
  if (!pulls || grips) constraints_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    if (!pulls && contacts_[b].collision.found) add_pushes(body, bodies[b]);
    if (grips && is_inside(contacts_[b].collision)) add_grips(body, bodies[b], pose);
  }
  gripped_ |= grips;
}

void ToolContact::add_pushes(int body, const BodyState& state) {
  const SurfaceContact& nearest = contacts_[body].collision.nearest;
  overflow_ |= !constraints_.add_plane_push(body, state.lattice, state.mapping.at(nearest.u, nearest.v),
                                            nearest.normal);
  for (const NearSample& sample : contacts_[body].collider.near_samples()) {
    overflow_ |= !constraints_.add_push(body, state.lattice, state.mapping.sample(sample.index));
  }
}

void ToolContact::add_grips(int body, const BodyState& state, const Pose& pose) {
  const auto grip = [&](const EmbeddedPoint& point) {
    Vector3 position = Vector3::Zero();
    for (int i = 0; i < point.count; ++i) {
      position += static_cast<double>(point.weight[i]) * state.lattice.position(point.node[i]);
    }
    const Vector3 offset = pose.orientation.conjugate() * (position - pose.position_m);
    overflow_ |= !constraints_.add_grip(body, state.lattice, point, offset);
  };
  const CollisionResult& collision = contacts_[body].collision;
  grip(state.mapping.at(collision.nearest.u, collision.nearest.v));
  for (const NearSample& sample : contacts_[body].collider.near_samples()) {
    if (sample.distance_m <= 0.0) grip(state.mapping.sample(sample.index));
  }
}

}  // namespace spoonbill
