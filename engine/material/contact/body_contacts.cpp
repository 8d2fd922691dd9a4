#include "engine/material/contact/body_contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/contact/contact_push.h"

namespace spoonbill {
namespace {

// The surfaces follow their nodes through the refit, a little more or less than the points do that the
// constraints know: a gap that closes by half at most leaves room for that.
constexpr ContactPace pace{0.5, 0.7};

Vector3 displacement_now(const BodyPoint& side) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < side.point.count; ++i) {
    sum += static_cast<double>(side.point.weight[i]) * side.lattice->displacement(side.point.node[i]);
  }
  return sum;
}

// Of one body the impulses meet in the nodes that both points share.
double compliance_between(const BodyPoint& first, const BodyPoint& second) {
  if (first.body != second.body) {
    return first.point.compliance(*first.lattice) + second.point.compliance(*second.lattice);
  }
  const SpringLattice& lattice = *first.lattice;
  double sum = 0.0;
  for (int i = 0; i < first.point.count; ++i) {
    const int node = first.point.node[i];
    const double share = first.point.weight[i] - second.point.share_of(node);
    sum += share * share * static_cast<double>(lattice.inverse_mass(node));
  }
  for (int i = 0; i < second.point.count; ++i) {
    const int node = second.point.node[i];
    if (first.point.share_of(node) != 0.0) continue;
    const double share = second.point.weight[i];
    sum += share * share * static_cast<double>(lattice.inverse_mass(node));
  }
  return sum;
}

double friction_between(const BodyPoint& first, const BodyPoint& second) {
  return std::min(first.point.friction(*first.lattice), second.point.friction(*second.lattice));
}

}  // namespace

BodyContacts::BodyContacts(int capacity) : constraints_(static_cast<std::size_t>(capacity)) {
  SPOONBILL_ASSERT(capacity >= 0);
}

void BodyContacts::clear() {
  count_ = 0;
}

bool BodyContacts::add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m) {
  SPOONBILL_ASSERT_DEBUG(first.lattice != nullptr && second.lattice != nullptr);
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  if (count_ == static_cast<int>(constraints_.size())) return false;
  const double moved = normal.dot(displacement_now(first) - displacement_now(second));
  constraints_[count_++] = {first.body,    second.body,
                            first.point,   second.point,
                            normal,        compliance_between(first, second),
                            gap_m - moved, friction_between(first, second),
                            false};
  return true;
}

void BodyContacts::begin() {
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
}

void BodyContacts::solve(std::span<const LatticeView> lattices, float h, std::span<const float> caps) {
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.compliance == 0.0) continue;
    solve(lattices, constraint, h, std::min(caps[constraint.first_body], caps[constraint.second_body]));
  }
}

void BodyContacts::solve(std::span<const LatticeView> lattices, Constraint& constraint, double h,
                         double cap) {
  const LatticeView& first = lattices[constraint.first_body];
  const LatticeView& second = lattices[constraint.second_body];
  const Vector3 apart = constraint.first.displacement_m(first) - constraint.second.displacement_m(second);
  const Vector3 relative =
      constraint.first.velocity_m_per_s(first) - constraint.second.velocity_m_per_s(second);
  const ContactPush push{constraint.base_m + constraint.normal.dot(apart), constraint.normal, relative,
                         1.0 / constraint.compliance};
  const auto impulse = push.impulse(h, pace, cap, constraint.friction);
  if (!impulse) return;
  constraint.first.push(first, *impulse);
  constraint.second.push(second, -*impulse);
  constraint.acted = true;
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
