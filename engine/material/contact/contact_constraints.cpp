#include "engine/material/contact/contact_constraints.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/rigid/rigid_dynamics.h"

namespace spoonbill {
namespace {

// Pace of a tool's contacts. A push starts from the force of the last substep, so a slow correction suffices;
// a fast one would make the force oscillate.
constexpr ContactPace tool_pace{0.5, 10.0};
// Pace of a tool's contacts with implicitly stepped lattices. The pushes of these contacts start from zero.
constexpr ContactPace stiff_body_pace{1.0, 300.0};
// Rates at which gripped points return to the tool, 1/s.
constexpr double grip_correction_per_s = 1800.0, stiff_grip_correction_per_s = 300.0;

// Frequency at which a coupled tool follows the hand, rad/s. It determines the tool's mass, which is about
// that of a few nodes of clay, so that neither tool nor clay dominates.
constexpr double coupling_frequency = 360.0;

}  // namespace

ContactConstraints::ContactConstraints(int capacity)
    : capacity_(static_cast<std::size_t>(capacity)), kept_(capacity_) {
  SPOONBILL_ASSERT(capacity >= 0);
  constraints_.reserve(capacity_);
}

void ContactConstraints::clear() {
  kept_.clear();
  for (const Constraint& constraint : constraints_) {
    if (!constraint.keeps_force || !(constraint.force_n > 0.0)) continue;
    kept_.add({.first = constraint.body, .point = constraint.key}, constraint.force_n);
  }
  kept_.sort();
  constraints_.clear();
}

void ContactConstraints::forget() {
  kept_.clear();
  constraints_.clear();
}

void ContactConstraints::carry_over(const ContactConstraints& other, int body, std::span<const int> new_key) {
  SPOONBILL_ASSERT(capacity_ >= other.constraints_.size());
  forget();
  for (const Constraint& constraint : other.constraints_) {
    const bool is_of_sample = constraint.body == body && constraint.key >= 0;
    if (is_of_sample && constraint.key >= static_cast<int>(new_key.size())) continue;
    Constraint& carried = constraints_.emplace_back(constraint);
    if (is_of_sample) carried.key = new_key[static_cast<std::size_t>(constraint.key)];
  }
}

double ContactConstraints::last_force_n(int body, int key) const {
  const double* const force_n = kept_.find({.first = body, .point = key});
  return force_n ? *force_n : 0.0;
}

bool ContactConstraints::add_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point, int key,
                                  const Vector3& offset_m) {
  return add({.kind = Kind::sphere_push, .body = body, .point = point, .rest_m = offset_m, .key = key},
             lattice);
}

bool ContactConstraints::add_plane_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                                        const Vector3& normal, double offset_m, int key) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  return add({.kind = Kind::plane_push,
              .body = body,
              .point = point,
              .direction = normal,
              .offset_m = offset_m,
              .key = key},
             lattice);
}

bool ContactConstraints::add_grip(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                                  const Vector3& offset_m) {
  return add({.kind = Kind::grip, .body = body, .point = point, .direction = offset_m}, lattice);
}

bool ContactConstraints::add_hold(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                                  const Vector3& offset_m, const Vector3& normal) {
  return add({.kind = Kind::hold, .body = body, .point = point, .direction = offset_m, .normal = normal},
             lattice);
}

bool ContactConstraints::add(const Constraint& constraint, const SpringLattice& lattice) {
  SPOONBILL_ASSERT_DEBUG(constraint.body >= 0 && constraint.body < lattice_capacity);
  if (constraints_.size() == capacity_) return false;
  Constraint& added = constraints_.emplace_back(constraint);
  added.rest_m += constraint.point.rest_m(lattice);
  added.friction = constraint.point.friction(lattice);
  added.is_implicit = lattice.moved_by_solver();
  added.keeps_force =
      !added.is_implicit && constraint.kind != Kind::grip && constraint.key != changing_point_key;
  if (added.keeps_force) added.force_n = last_force_n(added.body, added.key);
  return true;
}

bool ContactConstraints::has_constraint_on(int body) const {
  return std::any_of(constraints_.begin(), constraints_.end(),
                     [&](const Constraint& constraint) { return constraint.body == body; });
}

void ContactConstraints::begin(const ToolMotion& motion, double time_s) {
  SPOONBILL_ASSERT(time_s > 0.0);
  SPOONBILL_ASSERT(motion.radius_m >= 0.0 && motion.coupling_n_per_m >= 0.0);
  motion_ = motion;
  hand_velocity_ = (motion.end_m - motion.start_m) / time_s;
  const bool coupled = motion.coupling_n_per_m > 0.0;
  tool_compliance_ = coupled ? coupling_frequency * coupling_frequency / motion.coupling_n_per_m : 0.0;
  tool_impulse_.fill(Vector3::Zero());
  acted_ = false;
  for (Constraint& constraint : constraints_) constraint.acted = false;
}

void ContactConstraints::start(std::span<const LatticeView> lattices, ToolState& tool, double h_s,
                               double fraction) {
  SPOONBILL_ASSERT_DEBUG(h_s > 0.0 && fraction >= 0.0 && fraction < 1.0);
  const double damped = 1.0 + h_s * coupling_frequency;
  response_compliance_ = tool_compliance_ / (damped * damped);
  follow_hand(tool, h_s, fraction);
  for (Constraint& constraint : constraints_) {
    const LatticeView& lattice = lattices[constraint.body];
    locate(lattice, constraint, tool);
    constraint.drag_ns.setZero();
    if (constraint.normal.isZero(0.0)) constraint.force_n = 0.0;
    if (!(constraint.force_n > 0.0)) continue;
    exchange(lattice, constraint, tool, h_s * constraint.force_n * constraint.normal);
  }
}

void ContactConstraints::pass(std::span<const LatticeView> lattices, ToolState& tool,
                              const ContactPass& pass) {
  passed_ = {tool.velocity_m_per_s, tool_impulse_};
  const bool by_solver = pass.moved_by == MovedBy::solvers;
  for (int c = 0; c < count(); ++c) {
    Constraint& constraint = constraints_[pass.is_reversed ? count() - 1 - c : c];
    if (constraint.is_implicit != by_solver) continue;
    const LatticeView& lattice = lattices[constraint.body];
    if (constraint.compliance + response_compliance_ == 0.0) continue;
    const auto cap = static_cast<double>(pass.push_speed_caps_m_per_s[constraint.body]);
    if (constraint.kind == Kind::grip) {
      solve_grip(lattice, constraint, tool, pass.h_s, cap);
    } else if (constraint.kind == Kind::hold) {
      solve_hold(lattice, constraint, tool, pass.h_s, cap);
    } else {
      solve_push(lattice, constraint, tool, pass.h_s, cap);
    }
  }
}

void ContactConstraints::shorten_pass(ToolState& tool, double fraction) {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  const Vector3& before = passed_.velocity_m_per_s;
  tool.velocity_m_per_s = before + fraction * (tool.velocity_m_per_s - before);
  for (std::size_t body = 0; body < tool_impulse_.size(); ++body) {
    const Vector3& impulse = passed_.impulse_ns[body];
    tool_impulse_[body] = impulse + fraction * (tool_impulse_[body] - impulse);
  }
}

// Sets the tool's velocity by its coupling spring and critical damper, x'' = w^2 (hand - x) + 2 w (hand' -
// x'), implicit in the velocity x'. A tool without coupling moves with the hand.
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

void ContactConstraints::locate(const LatticeView& lattice, Constraint& constraint,
                                const ToolState& tool) const {
  constraint.position_m = constraint.rest_m + constraint.point.displacement_m(lattice);
  const Vector3 from_centre = constraint.position_m - tool.position_m;
  if (constraint.kind == Kind::plane_push) {
    constraint.normal = constraint.direction;
    constraint.gap_m = from_centre.dot(constraint.normal) - constraint.offset_m;
  } else if (constraint.kind == Kind::sphere_push) {
    const double distance = from_centre.norm();
    constraint.normal = distance > 0.0 ? Vector3(from_centre / distance) : Vector3::Zero();
    constraint.gap_m = distance - motion_.radius_m;
  }
  // A grip lasts for many ticks, in which the inertia of its lattice may change.
  const bool is_push = constraint.kind != Kind::grip && !constraint.normal.isZero(0.0);
  if (!motion_.body_yields) {
    constraint.compliance = constraint.slide_compliance = 0.0;
  } else if (lattice.rigid != nullptr && is_push) {
    const Vector3 arm_m = constraint.point.offset_m(*lattice.rigid);
    constraint.compliance = lattice.rigid->compliance(arm_m, constraint.normal);
    constraint.slide_compliance = lattice.rigid->slide_compliance(arm_m, constraint.normal);
  } else {
    constraint.compliance = constraint.slide_compliance = constraint.point.compliance(lattice);
  }
}

ContactPush ContactConstraints::find_push(const LatticeView& lattice, const Constraint& constraint,
                                          const ToolState& tool) const {
  return {constraint.gap_m, constraint.normal,
          constraint.point.velocity_m_per_s(lattice) - tool.velocity_m_per_s,
          1.0 / (constraint.compliance + response_compliance_),
          1.0 / (constraint.slide_compliance + response_compliance_)};
}

void ContactConstraints::solve_push(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  if (constraint.normal.isZero(0.0)) return;
  const ContactPush push = find_push(lattice, constraint, tool);
  const ContactPace& pace = constraint.is_implicit ? stiff_body_pace : tool_pace;
  const double started = h * constraint.force_n, pushed = push.normal_impulse(h, pace, cap, started);
  if (constraint.keeps_force) constraint.force_n = pushed / h;
  if (pushed == 0.0 && started == 0.0) return;
  const Vector3 dragged =
      push.drag(std::max(constraint.friction, motion_.friction) * pushed, constraint.drag_ns);
  const Vector3 impulse = (pushed - started) * push.normal - (dragged - constraint.drag_ns);
  if (constraint.keeps_force) constraint.drag_ns = dragged;
  exchange(lattice, constraint, tool, impulse);
}

// Returns the velocity with which a point that is `miss_m` away from its place in the tool's frame returns.
Vector3 ContactConstraints::find_return_m_per_s(const Vector3& miss_m, const Constraint& constraint, double h,
                                                double cap) {
  const double rate = constraint.is_implicit ? stiff_grip_correction_per_s : grip_correction_per_s;
  const Vector3 target = miss_m * std::min(rate, max_correction / h);
  const double speed = target.norm();
  return speed > cap ? Vector3(target * (cap / speed)) : target;
}

void ContactConstraints::solve_grip(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3 miss = tool.position_m + motion_.orientation * constraint.direction - constraint.position_m;
  const Vector3 target = find_return_m_per_s(miss, constraint, h, cap);
  const Vector3 velocity = constraint.point.velocity_m_per_s(lattice);
  exchange(lattice, constraint, tool,
           (tool.velocity_m_per_s + target - velocity) / (constraint.compliance + response_compliance_));
}

void ContactConstraints::solve_hold(const LatticeView& lattice, Constraint& constraint, ToolState& tool,
                                    double h, double cap) {
  const Vector3& normal = constraint.normal;
  const auto across = [&](const Vector3& vector) -> Vector3 { return vector - vector.dot(normal) * normal; };
  const Vector3 miss = tool.position_m + motion_.orientation * constraint.direction - constraint.position_m;
  const Vector3 target = find_return_m_per_s(across(miss), constraint, h, cap);
  const Vector3 velocity = constraint.point.velocity_m_per_s(lattice);
  exchange(lattice, constraint, tool,
           across(tool.velocity_m_per_s + target - velocity) /
               (constraint.slide_compliance + response_compliance_));
}

void ContactConstraints::mark_touched(int body, std::uint8_t* touched) const {
  for (const Constraint& constraint : constraints_) {
    if (constraint.acted && constraint.body == body) constraint.point.mark(touched);
  }
}

}  // namespace spoonbill
