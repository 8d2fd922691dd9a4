#include "engine/material/contact_constraints.h"

#include <algorithm>

namespace spoonbill {
namespace {

// The share of a penetration that one substep takes back: below 1, so that neighbouring points that push the
// same node do not overshoot together.
constexpr double correction_share = 0.3;

// How fast a tool on its coupling spring follows the hand, rad/s of material time: its mass follows from
// that, a few nodes' worth in clay, so that neither drags the other about.
constexpr double coupling_frequency = 60.0;

Vector3 embedded_sum(const EmbeddedPoint& point, const float* x, const float* y, const float* z) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < point.count; ++i) {
    const int n = point.node[i];
    sum += static_cast<double>(point.weight[i]) * Vector3(x[n], y[n], z[n]);
  }
  return sum;
}

// Gives the point the velocity change impulse / effective mass by spreading the impulse over its nodes.
void apply_impulse(const LatticeView& lattice, const EmbeddedPoint& point, const Vector3& impulse) {
  for (int i = 0; i < point.count; ++i) {
    const int n = point.node[i];
    const double share = static_cast<double>(point.weight[i]) * static_cast<double>(lattice.inverse_mass[n]);
    lattice.vx[n] += static_cast<float>(share * impulse.x());
    lattice.vy[n] += static_cast<float>(share * impulse.y());
    lattice.vz[n] += static_cast<float>(share * impulse.z());
  }
}

}  // namespace

bool EmbeddedPoint::add(const EmbeddedPoint& other, float share) {
  for (int i = 0; i < other.count; ++i) {
    int at = 0;
    while (at < count && node[at] != other.node[i]) ++at;
    if (at == capacity) return false;
    if (at == count) {
      node[at] = other.node[i];
      weight[at] = 0.0f;
      ++count;
    }
    weight[at] += share * other.weight[i];
  }
  return true;
}

ContactConstraints::ContactConstraints(int capacity) : constraints_(static_cast<std::size_t>(capacity)) {}

void ContactConstraints::clear() {
  count_ = 0;
}

bool ContactConstraints::add_push(const SpringLattice& lattice, const EmbeddedPoint& point) {
  return add(lattice, point, Kind::sphere_push, Vector3::Zero());
}

bool ContactConstraints::add_plane_push(const SpringLattice& lattice, const EmbeddedPoint& point,
                                        const Vector3& normal) {
  return add(lattice, point, Kind::plane_push, normal);
}

bool ContactConstraints::add_grip(const SpringLattice& lattice, const EmbeddedPoint& point,
                                  const Vector3& offset_m) {
  return add(lattice, point, Kind::grip, offset_m);
}

bool ContactConstraints::add(const SpringLattice& lattice, const EmbeddedPoint& point, Kind kind,
                             const Vector3& direction) {
  if (count_ == static_cast<int>(constraints_.size())) return false;
  Constraint& constraint = constraints_[count_++];
  constraint = {kind, point, Vector3::Zero(), direction, 0.0, false};
  for (int i = 0; i < point.count; ++i) {
    const double weight = point.weight[i];
    constraint.rest_m += weight * lattice.mesh().nodes[point.node[i]];
    constraint.compliance += weight * weight * lattice.inverse_mass(point.node[i]);
  }
  return true;
}

void ContactConstraints::begin(const ToolMotion& motion, double material_time_s) {
  motion_ = motion;
  hand_velocity_ = (motion.end_m - motion.start_m) / material_time_s;
  const bool coupled = motion.coupling_n_per_m > 0.0;
  tool_compliance_ = coupled ? coupling_frequency * coupling_frequency / motion.coupling_n_per_m : 0.0;
  tool_impulse_.setZero();
  acted_ = false;
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
}

void ContactConstraints::solve(const LatticeView& lattice, ToolState& tool, float h, double fraction,
                               float cap) {
  follow_hand(tool, h, fraction);
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (compliance_of(constraint) + tool_compliance_ == 0.0) continue;
    if (constraint.kind == Kind::grip) {
      solve_grip(lattice, constraint, tool, h, cap);
    } else {
      solve_push(lattice, constraint, tool, h, cap);
    }
  }
  tool.position_m += static_cast<double>(h) * tool.velocity_m_per_s;
}

double ContactConstraints::compliance_of(const Constraint& constraint) const {
  return motion_.body_yields ? constraint.compliance : 0.0;
}

// The coupling spring and its critical damper, implicit in the tool's velocity: x'' = w^2 (hand - x) + 2 w
// (hand' - x').
void ContactConstraints::follow_hand(ToolState& tool, double h, double fraction) const {
  const Vector3 hand = motion_.start_m + fraction * (motion_.end_m - motion_.start_m);
  if (tool_compliance_ == 0.0) {
    tool.position_m = hand;
    tool.velocity_m_per_s = hand_velocity_;
    return;
  }
  const double w = coupling_frequency;
  const Vector3 stretch = hand + h * hand_velocity_ - tool.position_m;
  tool.velocity_m_per_s = (tool.velocity_m_per_s + h * w * w * stretch + 2.0 * h * w * hand_velocity_) /
                          (1.0 + 2.0 * h * w + h * h * w * w);
}

void ContactConstraints::exchange(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                  const Vector3& impulse) {
  if (motion_.body_yields) apply_impulse(lattice, constraint.point, impulse);
  tool.velocity_m_per_s -= tool_compliance_ * impulse;
  tool_impulse_ -= impulse;
  constraint.acted = true;
  acted_ = true;
}

void ContactConstraints::solve_push(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3 position =
      constraint.rest_m + embedded_sum(constraint.point, lattice.dx, lattice.dy, lattice.dz);
  const bool plane = constraint.kind == Kind::plane_push;
  const Vector3 from_centre = position - tool.position_m;
  const double distance = plane ? -from_centre.dot(constraint.direction) : from_centre.norm();
  if (!plane && !(distance > 0.0)) return;
  const Vector3 normal = plane ? Vector3(-constraint.direction) : Vector3(from_centre / distance);
  const double gap = distance - motion_.radius_m;
  const Vector3 velocity = embedded_sum(constraint.point, lattice.vx, lattice.vy, lattice.vz);
  const Vector3 relative = velocity - tool.velocity_m_per_s;
  const double separating = relative.dot(normal);
  const double wanted = gap > 0.0 ? -gap / h : std::min(-gap * correction_share / h, cap);
  if (separating >= wanted) return;
  const double mass = 1.0 / (compliance_of(constraint) + tool_compliance_);
  const double push = (wanted - separating) * mass;
  const Vector3 sliding = relative - separating * normal;
  const double slide = sliding.norm() * mass;
  // Coulomb: friction stops the sliding where it can, and is the coefficient times the push where it cannot.
  const double drag = std::min(slide, motion_.friction * push);
  exchange(lattice, constraint, tool, push * normal - (slide > 0.0 ? drag / slide : 0.0) * mass * sliding);
}

void ContactConstraints::solve_grip(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3 position =
      constraint.rest_m + embedded_sum(constraint.point, lattice.dx, lattice.dy, lattice.dz);
  const Vector3 miss = tool.position_m + motion_.orientation * constraint.direction - position;
  Vector3 wanted = miss * (correction_share / h);
  const double speed = wanted.norm();
  if (speed > cap) wanted *= cap / speed;
  const Vector3 velocity = embedded_sum(constraint.point, lattice.vx, lattice.vy, lattice.vz);
  exchange(lattice, constraint, tool,
           (tool.velocity_m_per_s + wanted - velocity) / (compliance_of(constraint) + tool_compliance_));
}

void ContactConstraints::mark_touched(std::uint8_t* touched) const {
  for (int c = 0; c < count_; ++c) {
    if (!constraints_[c].acted) continue;
    for (int i = 0; i < constraints_[c].point.count; ++i) {
      if (constraints_[c].point.weight[i] > 0.05f) touched[constraints_[c].point.node[i]] = 1;
    }
  }
}

}  // namespace spoonbill
