#include "engine/simulation/tool_contact.h"

namespace spoonbill {
namespace {

constexpr int constraint_capacity = 1024;

// How near a sample must be to become a constraint, in lattice cells: what the refit may leave between the
// surface that collides and the lattice that gives way.
constexpr double margin_cells = 0.5;

}  // namespace

ToolContact::ToolContact(const BodyMapping& mapping)
    : collider_(mapping.nested()), constraints_(constraint_capacity) {}

void ToolContact::release() {
  constraints_.clear();
  gripped_ = false;
}

void ToolContact::lift() {
  release();
  lifted_ = true;
}

void ToolContact::prepare(const BodyMapping& mapping, const SpringLattice& lattice, const Tool& tool,
                          const Pose& pose, bool gripping, bool hovering) {
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  const double margin = margin_cells * static_cast<double>(lattice.cell_size_m());
  collision_ = collider_.collide(mapping.current(), ToolShape::sphere(pose.position_m, radius), margin, true);
  overflow_ = collision_.overflow;
  const bool inside = collision_.found && collision_.nearest.depth_m >= 0.0;
  // A body that the tool has just pressed lies against it, and quivers: the tool has left when it is a margin
  // away, or hovers.
  const bool against = hovering ? inside : collision_.found;
  lifted_ = lifted_ && (against || gripping);
  hovered_ = hovering || (hovered_ && inside);
  if (lifted_ || hovered_) return release();
  if (tool.action != ToolAction::pull) {
    constraints_.clear();
    if (collision_.found) add_pushes(mapping, lattice);
    return;
  }
  if (!gripping) {
    release();
  } else if (!gripped_ && inside) {
    add_grips(mapping, lattice, pose);
    gripped_ = true;
  }
}

void ToolContact::add_pushes(const BodyMapping& mapping, const SpringLattice& lattice) {
  const SurfaceContact& nearest = collision_.nearest;
  overflow_ |= !constraints_.add_plane_push(lattice, mapping.at(nearest.u, nearest.v), nearest.normal);
  for (const NearSample& sample : collider_.near_samples()) {
    overflow_ |= !constraints_.add_push(lattice, mapping.sample(sample.index));
  }
}

void ToolContact::add_grips(const BodyMapping& mapping, const SpringLattice& lattice, const Pose& pose) {
  constraints_.clear();
  const auto grip = [&](const EmbeddedPoint& point) {
    Vector3 position = Vector3::Zero();
    for (int i = 0; i < point.count; ++i) {
      position += static_cast<double>(point.weight[i]) * lattice.position(point.node[i]);
    }
    const Vector3 offset = pose.orientation.conjugate() * (position - pose.position_m);
    overflow_ |= !constraints_.add_grip(lattice, point, offset);
  };
  grip(mapping.at(collision_.nearest.u, collision_.nearest.v));
  for (const NearSample& sample : collider_.near_samples()) {
    if (sample.distance_m <= 0.0) grip(mapping.sample(sample.index));
  }
}

}  // namespace spoonbill
