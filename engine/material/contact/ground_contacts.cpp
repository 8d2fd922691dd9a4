#include "engine/material/contact/ground_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

auto contact_key(const GroundContact& contact) {
  return std::make_tuple(contact.body, contact.node);
}

// Updates the mean push. For the first friction_memory_s after the node touched the ground it is the plain
// mean of all pushes, and later an exponentially weighted mean.
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
    const double pushed_ns = push.normal_impulse(h_s, ground_pace, cap_m_per_s, 0.0);
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
