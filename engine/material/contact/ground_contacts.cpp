#include "engine/material/contact/ground_contacts.h"

#include "engine/material/contact/contact_push.h"
#include "engine/material/springs/node_motion.h"

namespace spoonbill {
namespace {

constexpr ContactPace pace{1.0, 0.7};

}  // namespace

GroundContacts::GroundContacts(int capacity) : constraints_(static_cast<std::size_t>(capacity)) {}

void GroundContacts::clear() {
  count_ = 0;
}

bool GroundContacts::add(int body, const SpringLattice& lattice, int node, double gap_m, double friction) {
  if (count_ == static_cast<int>(constraints_.size())) return false;
  constraints_[static_cast<std::size_t>(count_++)] = {
      body, node, gap_m, lattice.displacement(node), friction, Vector3::Zero()};
  return true;
}

void GroundContacts::begin(const Vector3& normal) {
  normal_ = normal;
}

void GroundContacts::solve(std::span<const LatticeView> lattices, std::span<const double> times_s,
                           std::span<const float> caps) {
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[static_cast<std::size_t>(c)];
    const auto body = static_cast<std::size_t>(constraint.body);
    const LatticeView& view = lattices[body];
    const int n = constraint.node;
    const double inverse_mass = static_cast<double>(view.inverse_mass[n]);
    if (inverse_mass == 0.0) continue;
    const Vector3 displacement(view.dx[n], view.dy[n], view.dz[n]);
    const Vector3 velocity(view.vx[n], view.vy[n], view.vz[n]);
    const double gap_m = constraint.gap_m + normal_.dot(displacement - constraint.at_m);
    const ContactPush push{gap_m, normal_, velocity, 1.0 / inverse_mass};
    const auto impulse =
        push.impulse(times_s[body], pace, static_cast<double>(caps[body]), constraint.friction);
    if (!impulse) continue;
    set_velocity(view, n, velocity + inverse_mass * *impulse);
    constraint.impulse_ns += *impulse;
  }
}

Vector3 GroundContacts::impulse_ns(int body) const {
  Vector3 sum = Vector3::Zero();
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[static_cast<std::size_t>(c)];
    if (constraint.body == body) sum += constraint.impulse_ns;
  }
  return sum;
}

void GroundContacts::mark_touched(int body, std::uint8_t* touched) const {
  for (int c = 0; c < count_; ++c) {
    const Constraint& constraint = constraints_[static_cast<std::size_t>(c)];
    if (constraint.body == body && !constraint.impulse_ns.isZero(0.0)) touched[constraint.node] = 1;
  }
}

}  // namespace spoonbill
