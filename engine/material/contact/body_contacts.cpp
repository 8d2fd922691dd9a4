#include "engine/material/contact/body_contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {
namespace {

// Pace of contacts of a body that an implicit solver steps. The surfaces are fitted to the samples in each
// tick, so they may move slightly more or less than the constrained points. Closing at most half of a gap in
// a substep leaves a margin for this difference. A push starts from the force of the last substep, so a
// moderate rate of correction suffices; a faster one would shake bodies at rest.
constexpr double body_closing = 0.5;
constexpr ContactPace body_pace{body_closing, 400.0};
// Pace of contacts whose overlaps separate() corrects.
constexpr ContactPace separated_pace{body_closing, 0.0};

// Rate at which separate() corrects an overlap. A correction against the force of a collision adds energy, so
// it is slow. Points that push the same nodes correct together, so the part of an overlap that is corrected
// in a substep must be small.
constexpr double separation_per_s = 200.0, max_separation = 0.1;

// Part of the difference between a gap that is found and the gap of its constraint that is taken over in a
// tick. If it were taken over faster, colliding bodies would gain energy; if more slowly, their drawn
// surfaces would overlap.
constexpr double taken_over_in_tick = 0.18;

// Returns the relative velocity change of two points per impulse between them, 1/kg. Within one body, the
// impulses overlap in the nodes that both points use.
double mutual_compliance(const BodyPoint& first, const BodyPoint& second) {
  if (first.body != second.body) {
    return first.point.compliance(*first.lattice) + second.point.compliance(*second.lattice);
  }
  const SpringLattice& lattice = *first.lattice;
  double sum = 0.0;
  for (int i = 0; i < first.point.count; ++i) {
    const int node = first.point.node[i];
    const double fraction = first.point.weight[i] - second.point.weight_of_node(node);
    sum += fraction * fraction * static_cast<double>(lattice.inverse_mass(node));
  }
  for (int i = 0; i < second.point.count; ++i) {
    const int node = second.point.node[i];
    if (first.point.weight_of_node(node) != 0.0) continue;
    const double fraction = second.point.weight[i];
    sum += fraction * fraction * static_cast<double>(lattice.inverse_mass(node));
  }
  return sum;
}

// Returns the relative velocity change of two lattices' frames per impulse between the lattices, 1/kg.
double mutual_frame_compliance(const LatticeView& first, const LatticeView& second) {
  return first.frame == second.frame ? 0.0 : frame_compliance(first) + frame_compliance(second);
}

double mutual_friction(const BodyPoint& first, const BodyPoint& second) {
  return std::min(first.point.friction(*first.lattice), second.point.friction(*second.lattice));
}

PointMobility find_mobility(const BodyPoint& point) {
  PointMobility found;
  for (int i = 0; i < point.point.count; ++i) {
    const double weight = std::abs(static_cast<double>(point.point.weight[i]));
    const auto inverse_mass = static_cast<double>(point.lattice->inverse_mass(point.point.node[i]));
    found.node_per_kg = std::max(found.node_per_kg, weight * inverse_mass);
    found.absolute_weight += weight;
  }
  return found;
}

// Limits a contact force of the last tick to what push and friction allow with the present normal. A force
// that pulls or is not a number becomes zero.
Vector3 limit_to_cone(const Vector3& force_n, const Vector3& normal, double friction) {
  const double push_n = force_n.dot(normal);
  if (!(push_n > 0.0) || !force_n.allFinite()) return Vector3::Zero();
  const Vector3 drag_n = force_n - push_n * normal;
  const double most_n = friction * push_n, size_n = drag_n.norm();
  return push_n * normal + (size_n > most_n ? most_n / size_n : 1.0) * drag_n;
}

}  // namespace

BodyContacts::BodyContacts(int capacity)
    : constraints_(static_cast<std::size_t>(capacity)), kept_(constraints_.size()) {
  SPOONBILL_ASSERT(capacity >= 0);
  impulse_ns_.fill(Vector3::Zero());
}

void BodyContacts::clear(std::span<const SpringLattice* const> lattices) {
  kept_.clear();
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[c];
    if (constraint.sample < 0) continue;
    const Vector3 apart = constraint.first.displacement_m(*lattices[constraint.first_body]) -
                          constraint.second.displacement_m(*lattices[constraint.second_body]);
    const double gap_m = constraint.base_m + constraint.normal.dot(apart);
    if (!std::isfinite(gap_m)) continue;
    kept_.add(constraint.key(), {constraint.force_n, constraint.normal, gap_m});
  }
  kept_.sort();
  count_ = 0;
}

void BodyContacts::forget() {
  kept_.clear();
  count_ = 0;
  has_searched_ = false;
}

bool BodyContacts::add(const BodyPoint& first, const BodyPoint& second, const Vector3& found_normal,
                       double found_gap_m, double deepest_new_m, int sample) {
  SPOONBILL_ASSERT_DEBUG(first.lattice != nullptr && second.lattice != nullptr);
  SPOONBILL_ASSERT_DEBUG(std::abs(found_normal.squaredNorm() - 1.0) < 1e-5);
  const ContactKey key{first.body, second.body, sample};
  const Kept* const kept = sample >= 0 ? kept_.find(key) : nullptr;
  if (kept == nullptr && has_searched_ && found_gap_m < -deepest_new_m) return true;
  const bool is_folded = kept != nullptr && kept->normal.dot(found_normal) < 0.0;
  const Vector3 normal = is_folded ? kept->normal : found_normal;
  const double gap_m = is_folded ? kept->gap_m : found_gap_m;
  if (count_ == static_cast<int>(constraints_.size())) return false;
  // A rigid body next to an implicitly stepped one counts as such a one.
  const auto is_rigid = [](const BodyPoint& point) { return point.lattice->mesh().is_frame; };
  const auto has_springs = [&](const BodyPoint& point) {
    return !point.lattice->moved_by_solver() && !is_rigid(point);
  };
  const bool by_solvers = !has_springs(first) && !has_springs(second);
  const double moved =
      normal.dot(first.point.displacement_m(*first.lattice) - second.point.displacement_m(*second.lattice));
  const double compliance = mutual_compliance(first, second);
  const double friction = mutual_friction(first, second);
  const bool separates = !by_solvers && !first.lattice->moved_by_solver() &&
                         !second.lattice->moved_by_solver() && compliance > 0.0;
  const double difference_m =
      separates && kept != nullptr ? (1.0 - taken_over_in_tick) * (gap_m - kept->gap_m) : 0.0;
  Constraint& added = constraints_[count_++];
  added = {.first_body = first.body,
           .second_body = second.body,
           .first = first.point,
           .second = second.point,
           .normal = normal,
           .compliance = compliance,
           .base_m = gap_m - difference_m - moved,
           .difference_m = difference_m,
           .added_gap_m = gap_m,
           .first_mobility = find_mobility(first),
           .second_mobility = find_mobility(second),
           .friction = friction,
           .moved_by = by_solvers ? MovedBy::solvers : MovedBy::springs,
           .separates = separates,
           .sample = sample};
  if (kept != nullptr) added.force_n = limit_to_cone(kept->force_n, normal, friction);
  return true;
}

void BodyContacts::keep() {
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.sample < 0) {
      constraint.force_n.setZero();
      continue;
    }
    const double taken_over_m = taken_over_in_tick * constraint.difference_m;
    constraint.difference_m -= taken_over_m;
    constraint.base_m += taken_over_m;
  }
}

void BodyContacts::begin() {
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
  impulse_ns_.fill(Vector3::Zero());
  has_searched_ = true;
}

Vector3 BodyContacts::impulse_ns(int body, double time_s) const {
  SPOONBILL_ASSERT(body >= 0 && body < lattice_capacity);
  Vector3 sum = impulse_ns_[static_cast<std::size_t>(body)];
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[c];
    if (constraint.moved_by != MovedBy::solvers) continue;
    if (constraint.first_body == body) sum += time_s * constraint.force_n;
    if (constraint.second_body == body) sum -= time_s * constraint.force_n;
  }
  return sum;
}

bool BodyContacts::has_constraint_between_solvers() const {
  return std::any_of(constraints_.begin(), constraints_.begin() + count_,
                     [](const Constraint& constraint) { return constraint.moved_by == MovedBy::solvers; });
}

double BodyContacts::find_gap_m(std::span<const LatticeView> lattices, const Constraint& constraint) {
  const Vector3 apart = constraint.first.displacement_m(lattices[constraint.first_body]) -
                        constraint.second.displacement_m(lattices[constraint.second_body]);
  return constraint.base_m + constraint.normal.dot(apart);
}

Vector3 BodyContacts::find_relative_m_per_s(std::span<const LatticeView> lattices,
                                            const Constraint& constraint) {
  return constraint.first.velocity_m_per_s(lattices[constraint.first_body]) -
         constraint.second.velocity_m_per_s(lattices[constraint.second_body]);
}

void BodyContacts::start(std::span<const LatticeView> lattices, double h_s) {
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.moved_by != MovedBy::springs) continue;
    constraint.gap_m = find_gap_m(lattices, constraint);
    constraint.spare_m_per_s = -infinity;
    if (!constraint.force_n.isZero(0.0)) push(lattices, constraint, h_s * constraint.force_n);
  }
  changed_m_per_s_.fill(0.0);
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.moved_by != MovedBy::springs || !constraint.force_n.isZero(0.0)) continue;
    if (!(constraint.gap_m > 0.0)) continue;
    const double separation = find_relative_m_per_s(lattices, constraint).dot(constraint.normal);
    constraint.spare_m_per_s = separation + constraint.gap_m * body_closing / h_s;
  }
}

void BodyContacts::push(std::span<const LatticeView> lattices, Constraint& constraint,
                        const Vector3& impulse) {
  const auto first = static_cast<std::size_t>(constraint.first_body);
  const auto second = static_cast<std::size_t>(constraint.second_body);
  constraint.first.push(lattices[first], impulse);
  constraint.second.push(lattices[second], -impulse);
  if (constraint.moved_by == MovedBy::springs) {
    impulse_ns_[first] += impulse;
    impulse_ns_[second] -= impulse;
    const double size_ns = impulse.norm();
    changed_m_per_s_[first] +=
        size_ns * (constraint.first_mobility.node_per_kg + frame_compliance(lattices[first]));
    changed_m_per_s_[second] +=
        size_ns * (constraint.second_mobility.node_per_kg + frame_compliance(lattices[second]));
  }
  constraint.acted = true;
}

bool BodyContacts::may_act(const Constraint& constraint) const {
  const double changed_m_per_s =
      constraint.first_mobility.absolute_weight * changed_m_per_s_[constraint.first_body] +
      constraint.second_mobility.absolute_weight * changed_m_per_s_[constraint.second_body];
  return !(constraint.spare_m_per_s > changed_m_per_s);
}

void BodyContacts::pass(std::span<const LatticeView> lattices, const ContactPass& pass) {
  const std::span<const float> caps = pass.push_speed_caps_m_per_s;
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[pass.is_reversed ? count_ - 1 - c : c];
    if (constraint.moved_by != pass.moved_by) continue;
    if (pass.moved_by == MovedBy::solvers) {
      constraint.gap_m = find_gap_m(lattices, constraint);
    } else if (!may_act(constraint)) {
      continue;
    }
    const auto cap = static_cast<double>(std::min(caps[constraint.first_body], caps[constraint.second_body]));
    solve(lattices, constraint, pass.h_s, cap);
  }
}

void BodyContacts::separate(std::span<const LatticeView> lattices, double h_s,
                            std::span<const float> caps_m_per_s) {
  const double part = std::min(max_separation, separation_per_s * h_s);
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[c];
    // The constraint lets at most a part of a gap close. Where other pushes close it all the same, the
    // overlap is corrected from the next substep on.
    if (!constraint.separates || constraint.sample < 0 || constraint.gap_m > 0.0) continue;
    const auto first = static_cast<std::size_t>(constraint.first_body);
    const auto second = static_cast<std::size_t>(constraint.second_body);
    const double gap_m = find_gap_m(lattices, constraint);
    if (!(gap_m < 0.0)) continue;
    const double cap = static_cast<double>(std::min(caps_m_per_s[first], caps_m_per_s[second]));
    const double speed = std::min(-gap_m * part / h_s, cap);
    const Vector3 impulse = speed / constraint.compliance * constraint.normal;
    constraint.first.shift(lattices[first], impulse, h_s);
    constraint.second.shift(lattices[second], -impulse, h_s);
  }
}

void BodyContacts::shorten_solver_pass(double fraction) {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.moved_by != MovedBy::solvers) continue;
    const Vector3& before = constraint.passed_force_n;
    constraint.force_n = before + fraction * (constraint.force_n - before);
  }
}

void BodyContacts::solve(std::span<const LatticeView> lattices, Constraint& constraint, double h,
                         double cap) {
  const LatticeView& first = lattices[constraint.first_body];
  const LatticeView& second = lattices[constraint.second_body];
  const double compliance = constraint.compliance + mutual_frame_compliance(first, second);
  if (compliance == 0.0) {
    constraint.force_n.setZero();
    return;
  }
  const ContactPush state{constraint.gap_m, constraint.normal, find_relative_m_per_s(lattices, constraint),
                          1.0 / compliance};
  const Vector3 started = h * constraint.force_n;
  const double started_push = started.dot(constraint.normal);
  const ContactPace& pace = constraint.separates ? separated_pace : body_pace;
  const double pushed = state.normal_impulse(h, pace, cap, started_push);
  constraint.passed_force_n = constraint.force_n;
  if (pushed == 0.0 && started.isZero(0.0)) return;
  const Vector3 drag = state.drag(constraint.friction * pushed, started_push * constraint.normal - started);
  const Vector3 impulse = pushed * constraint.normal - drag;
  constraint.force_n = impulse / h;
  constraint.spare_m_per_s = -infinity;
  push(lattices, constraint, impulse - started);
}

bool BodyContacts::acted(int body) const {
  return std::any_of(constraints_.begin(), constraints_.begin() + count_, [&](const Constraint& constraint) {
    return constraint.acted && (constraint.first_body == body || constraint.second_body == body);
  });
}

bool BodyContacts::acted(int body, int other) const {
  return std::any_of(constraints_.begin(), constraints_.begin() + count_, [&](const Constraint& constraint) {
    const bool between = (constraint.first_body == body && constraint.second_body == other) ||
                         (constraint.first_body == other && constraint.second_body == body);
    return constraint.acted && between;
  });
}

void BodyContacts::mark_touched(int body, std::uint8_t* touched) const {
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[c];
    if (!constraint.acted) continue;
    if (constraint.first_body == body) constraint.first.mark(touched);
    if (constraint.second_body == body) constraint.second.mark(touched);
  }
}

}  // namespace spoonbill
