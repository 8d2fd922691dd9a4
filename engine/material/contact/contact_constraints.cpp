#include "engine/material/contact/contact_constraints.h"

#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// The correction is below 1, so that neighbouring points that push the same node do not overshoot together.
constexpr ContactPace tool_pace{1.0, 0.3};

// Frequency at which a coupled tool follows the hand, rad/s of material time. It determines the tool's mass,
// which is about that of a few nodes of clay, so that neither tool nor clay dominates.
constexpr double coupling_frequency = 60.0;

}  // namespace

ContactConstraints::ContactConstraints(int capacity) : constraints_(static_cast<std::size_t>(capacity)) {
  SPOONBILL_ASSERT(capacity >= 0);
}

void ContactConstraints::clear() {
  count_ = 0;
}

bool ContactConstraints::add_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point) {
  return add(Kind::sphere_push, body, lattice, point, Vector3::Zero(), 0.0);
}

bool ContactConstraints::add_plane_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                                        const Vector3& normal, double offset_m) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  return add(Kind::plane_push, body, lattice, point, normal, offset_m);
}

bool ContactConstraints::add_grip(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                                  const Vector3& offset_m) {
  return add(Kind::grip, body, lattice, point, offset_m, 0.0);
}

bool ContactConstraints::add(Kind kind, int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                             const Vector3& direction, double offset_m) {
  SPOONBILL_ASSERT_DEBUG(body >= 0 && body < lattice_capacity);
  if (count_ == static_cast<int>(constraints_.size())) return false;
  constraints_[count_++] = {kind,
                            body,
                            point,
                            point.rest_m(lattice),
                            direction,
                            offset_m,
                            point.compliance(lattice),
                            point.friction(lattice),
                            false};
  return true;
}

void ContactConstraints::begin(const ToolMotion& motion, double material_time_s) {
  SPOONBILL_ASSERT(material_time_s > 0.0);
  SPOONBILL_ASSERT(motion.radius_m >= 0.0 && motion.coupling_n_per_m >= 0.0);
  motion_ = motion;
  hand_velocity_ = (motion.end_m - motion.start_m) / material_time_s;
  carried_force_.setZero();
  const bool coupled = motion.coupling_n_per_m > 0.0;
  tool_compliance_ = coupled ? coupling_frequency * coupling_frequency / motion.coupling_n_per_m : 0.0;
  tool_impulse_.fill(Vector3::Zero());
  acted_ = false;
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
}

void ContactConstraints::solve(std::span<const LatticeView> lattices, ToolState& tool, float h,
                               double fraction, std::span<const float> caps) {
  SPOONBILL_ASSERT_DEBUG(h > 0.0f && fraction >= 0.0 && fraction < 1.0);
  const double damped = 1.0 + static_cast<double>(h) * coupling_frequency;
  response_compliance_ = tool_compliance_ / (damped * damped);
  follow_hand(tool, h, fraction);
  if (motion_.carried.body >= 0) {
    tool_impulse_[motion_.carried.body] += static_cast<double>(h) * carried_force_;
  }
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (effective_compliance(constraint) + response_compliance_ == 0.0) continue;
    const LatticeView& lattice = lattices[constraint.body];
    const double cap = caps[constraint.body];
    if (constraint.kind == Kind::grip) {
      solve_grip(lattice, constraint, tool, h, cap);
    } else {
      solve_push(lattice, constraint, tool, h, cap);
    }
  }
  tool.position_m += static_cast<double>(h) * tool.velocity_m_per_s;
}

double ContactConstraints::effective_compliance(const Constraint& constraint) const {
  return motion_.body_yields ? constraint.compliance : 0.0;
}

// Moves the tool by its coupling spring and critical damper, implicit in the tool's velocity: x'' = w^2
// (hand - x) + 2 w (hand' - x').
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
  if (motion_.body_yields) constraint.point.push(lattice, impulse);
  tool.velocity_m_per_s -= response_compliance_ * impulse;
  tool_impulse_[constraint.body] -= impulse;
  constraint.acted = true;
  acted_ = true;
}

void ContactConstraints::solve_push(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3 position = constraint.rest_m + constraint.point.displacement_m(lattice);
  const Vector3 from_centre = position - tool.position_m;
  Vector3 normal = constraint.direction;
  double gap = 0.0;
  if (constraint.kind == Kind::plane_push) {
    gap = from_centre.dot(normal) - constraint.offset_m;
  } else {
    const double distance = from_centre.norm();
    if (!(distance > 0.0)) return;
    normal = from_centre / distance;
    gap = distance - motion_.radius_m;
  }
  const ContactPush push{gap, normal, constraint.point.velocity_m_per_s(lattice) - tool.velocity_m_per_s,
                         1.0 / (effective_compliance(constraint) + response_compliance_)};
  if (const auto impulse = push.impulse(h, tool_pace, cap, constraint.friction)) {
    exchange(lattice, constraint, tool, *impulse);
  }
}

void ContactConstraints::solve_grip(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3 position = constraint.rest_m + constraint.point.displacement_m(lattice);
  const Vector3 miss = tool.position_m + motion_.orientation * constraint.direction - position;
  Vector3 target = miss * (tool_pace.correction / h);
  const double speed = target.norm();
  if (speed > cap) target *= cap / speed;
  const Vector3 velocity = constraint.point.velocity_m_per_s(lattice);
  exchange(lattice, constraint, tool,
           (tool.velocity_m_per_s + target - velocity) /
               (effective_compliance(constraint) + response_compliance_));
}

void ContactConstraints::mark_touched(int body, std::uint8_t* touched) const {
  for (int c = 0; c < count_; ++c) {
    if (constraints_[c].acted && constraints_[c].body == body) constraints_[c].point.mark(touched);
  }
}

}  // namespace spoonbill
