#include "engine/material/contact/body_contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {
namespace {

// Pace of contacts between bodies. The surfaces follow their nodes through the refit and may move slightly
// more or less than the constrained points. Closing at most half of a gap in a substep leaves a margin for
// this difference. A push starts from the force of the last substep, so a moderate rate of correction
// suffices; a faster one would shake bodies at rest.
constexpr ContactPace body_pace{0.5, 400.0};

Vector3 current_displacement(const BodyPoint& side) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < side.point.count; ++i) {
    sum += static_cast<double>(side.point.weight[i]) * side.lattice->displacement(side.point.node[i]);
  }
  return sum;
}

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

double mutual_friction(const BodyPoint& first, const BodyPoint& second) {
  return std::min(first.point.friction(*first.lattice), second.point.friction(*second.lattice));
}

}  // namespace

BodyContacts::BodyContacts(int capacity)
    : constraints_(static_cast<std::size_t>(capacity)), kept_(constraints_.size()) {
  SPOONBILL_ASSERT(capacity >= 0);
}

void BodyContacts::clear() {
  kept_.clear();
  for (int c = 0; c < count_; ++c) {
    if (constraints_[c].force_n > 0.0) kept_.add(constraints_[c].key(), constraints_[c].force_n);
  }
  kept_.sort();
  count_ = 0;
}

void BodyContacts::forget() {
  kept_.clear();
  count_ = 0;
}

bool BodyContacts::add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m,
                       int sample) {
  SPOONBILL_ASSERT_DEBUG(first.lattice != nullptr && second.lattice != nullptr);
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  if (count_ == static_cast<int>(constraints_.size())) return false;
  const bool by_solvers = first.lattice->moved_by_solver() && second.lattice->moved_by_solver();
  const double moved = normal.dot(current_displacement(first) - current_displacement(second));
  Constraint& added = constraints_[count_++];
  added = {.first_body = first.body,
           .second_body = second.body,
           .first = first.point,
           .second = second.point,
           .normal = normal,
           .compliance = mutual_compliance(first, second),
           .base_m = gap_m - moved,
           .friction = mutual_friction(first, second),
           .moved = by_solvers ? Moved::by_solvers : Moved::by_springs,
           .sample = sample};
  if (added.keeps_force() && added.compliance > 0.0) added.force_n = kept_.find(added.key());
  return true;
}

void BodyContacts::begin() {
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
}

bool BodyContacts::has_constraint_between_solvers() const {
  return std::any_of(constraints_.begin(), constraints_.begin() + count_,
                     [](const Constraint& constraint) { return constraint.moved == Moved::by_solvers; });
}

void BodyContacts::start(std::span<const LatticeView> lattices, double h_s) {
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.moved != Moved::by_springs || !(constraint.force_n > 0.0)) continue;
    push(lattices, constraint, h_s * constraint.force_n * constraint.normal);
  }
}

void BodyContacts::push(std::span<const LatticeView> lattices, Constraint& constraint,
                        const Vector3& impulse) {
  constraint.first.push(lattices[constraint.first_body], impulse);
  constraint.second.push(lattices[constraint.second_body], -impulse);
  constraint.acted = true;
}

void BodyContacts::pass(std::span<const LatticeView> lattices, const Pass& pass) {
  const std::span<const float> caps = pass.push_speed_caps_m_per_s;
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[pass.is_reversed ? count_ - 1 - c : c];
    if (constraint.moved != pass.moved || constraint.compliance == 0.0) continue;
    const auto cap = static_cast<double>(std::min(caps[constraint.first_body], caps[constraint.second_body]));
    solve(lattices, constraint, pass.h_s, cap);
  }
}

void BodyContacts::shorten_solver_pass(double fraction) {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.moved != Moved::by_solvers || !constraint.keeps_force()) continue;
    const double before = constraint.passed_force_n;
    constraint.force_n = before + fraction * (constraint.force_n - before);
  }
}

void BodyContacts::solve(std::span<const LatticeView> lattices, Constraint& constraint, double h,
                         double cap) {
  const LatticeView& first = lattices[constraint.first_body];
  const LatticeView& second = lattices[constraint.second_body];
  const Vector3 apart = constraint.first.displacement_m(first) - constraint.second.displacement_m(second);
  const Vector3 relative =
      constraint.first.velocity_m_per_s(first) - constraint.second.velocity_m_per_s(second);
  const ContactPush state{constraint.base_m + constraint.normal.dot(apart), constraint.normal, relative,
                          1.0 / constraint.compliance};
  const double target = state.target_m_per_s(h, body_pace, cap), started = h * constraint.force_n;
  const double pushed = std::max(0.0, started + (target - relative.dot(constraint.normal)) * state.mass_kg);
  constraint.passed_force_n = constraint.force_n;
  if (constraint.keeps_force()) constraint.force_n = pushed / h;
  if (pushed == 0.0 && started == 0.0) return;
  push(lattices, constraint,
       (pushed - started) * constraint.normal - state.drag(constraint.friction * pushed));
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

namespace {

auto contact_key(const GroundContact& contact) {
  return std::make_tuple(contact.body, contact.node);
}

// Updates the mean push. It is the plain mean since the node touched the ground, and exponentially weighted
// after friction_memory_s.
void remember(GroundContact& contact, double push_n, double h_s) {
  contact.time_s = std::min(contact.time_s + h_s, friction_memory_s + h_s);
  contact.mean_push_n += h_s / contact.time_s * (push_n - contact.mean_push_n);
}

}  // namespace

GroundContacts::GroundContacts(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {
  SPOONBILL_ASSERT(capacity >= 0);
  contacts_.reserve(capacity_);
  last_.reserve(capacity_);
}

void GroundContacts::begin(const Vector3& normal, double time_s) {
  SPOONBILL_ASSERT(time_s > 0.0);
  SPOONBILL_ASSERT(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  std::swap(contacts_, last_);
  contacts_.clear();
  search_position_ = 0;
  last_time_s_ = time_s_;
  time_s_ = time_s;
  normal_ = normal;
}

void GroundContacts::forget() {
  contacts_.clear();
}

bool GroundContacts::add(int body, const SpringLattice& lattice, int node, double gap_m, double friction) {
  SPOONBILL_ASSERT_DEBUG(contacts_.empty() || contacts_.back().body < body ||
                         (contacts_.back().body == body && contacts_.back().node <= node));
  if (lattice.is_fixed(node)) return true;
  if (contacts_.size() == capacity_) return false;
  GroundContact contact{body, node, gap_m, lattice.displacement(node), friction};
  while (search_position_ < last_.size() && contact_key(last_[search_position_]) < contact_key(contact))
    ++search_position_;
  if (search_position_ < last_.size() && contact_key(last_[search_position_]) == contact_key(contact)) {
    const GroundContact& before = last_[search_position_];
    contact.force_n = before.impulse_ns / last_time_s_;
    contact.mean_push_n = before.mean_push_n;
    contact.time_s = before.time_s;
  }
  contacts_.push_back(contact);
  return true;
}

std::span<GroundContact> GroundContacts::of_body(int body) {
  const auto [first, last] =
      std::equal_range(contacts_.begin(), contacts_.end(), GroundContact{body},
                       [](const GroundContact& a, const GroundContact& b) { return a.body < b.body; });
  return {first, last};
}

void GroundContacts::solve(int body, const LatticeView& view, double h_s, double cap_m_per_s) {
  for (GroundContact& contact : of_body(body)) {
    const int n = contact.node;
    const double inverse_mass = static_cast<double>(view.inverse_mass[n]);
    const Vector3 displacement(view.dx[n], view.dy[n], view.dz[n]);
    const Vector3 velocity(view.vx[n], view.vy[n], view.vz[n]);
    const ContactPush push{contact.gap_m + normal_.dot(displacement - contact.at_m), normal_, velocity,
                           1.0 / inverse_mass};
    const double pushed_ns = push.normal_impulse(h_s, ground_pace, cap_m_per_s);
    remember(contact, pushed_ns / h_s, h_s);
    if (pushed_ns == 0.0) continue;
    const Vector3 impulse = pushed_ns * normal_ - push.drag(contact.friction * contact.mean_push_n * h_s);
    set_velocity(view, n, velocity + inverse_mass * impulse);
    contact.impulse_ns += impulse;
  }
}

Vector3 GroundContacts::impulse_ns(int body) const {
  Vector3 sum = Vector3::Zero();
  for (const GroundContact& contact : contacts_) {
    if (contact.body == body) sum += contact.impulse_ns;
  }
  return sum;
}

void GroundContacts::mark_touched(int body, std::uint8_t* touched) const {
  for (const GroundContact& contact : contacts_) {
    if (contact.body == body && !contact.impulse_ns.isZero(0.0)) touched[contact.node] = 1;
  }
}

}  // namespace spoonbill
