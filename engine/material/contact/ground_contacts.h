// The rigid ground under bodies: velocity constraints on their nodes. Springs meet them within each substep,
// after all others; the implicit method once a tick (BlockOnGround).
#pragma once

#include <span>
#include <vector>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// One node on the ground. Plain data.
//
// Friction holds up to the coefficient times the mean push of the last `friction_memory_s`, not the push of
// the moment: a sliding body whose friction follows each swing of the push feeds that swing and hops along
// below the angle at which it should stick. Friction is seen to answer a change of pressure by and by
// (Prakash 1998), and that it does makes sliding well posed (Ranjith and Rice 2001). Over that time the
// friction adds up to what Coulomb says.
struct GroundContact {
  int body = 0, node = 0;
  double gap_m = 0.0;
  Vector3 at_m = Vector3::Zero();  // the node's displacement, to which the gap belongs
  double friction = 0.0;
  Vector3 impulse_ns = Vector3::Zero();  // in this tick
  // From tick to tick: the force through the last one, the mean push, and how long the node has been here.
  Vector3 force_n = Vector3::Zero();
  double mean_push_n = 0.0;
  double time_s = 0.0;
};

// Of material time; a soft body of a centimetre swings a few times in it, and slides by what nobody sees.
inline constexpr double friction_memory_s = 0.01;

// Working memory for the contacts of one tick, and what they keep for the next. Each is of one node alone, so
// that a single pass solves those of springs exactly and what sticks does not creep. One owner, one thread;
// allocates only in its constructor.
class GroundContacts {
 public:
  explicit GroundContacts(int capacity);

  // Begins a tick of `material_time_s`; `normal`, a unit vector, points out of the ground.
  void begin(const Vector3& normal, double material_time_s);
  // What hangs on a node is `gap_m` above the ground, below zero where it is in it. `body` is the lattice's
  // place in the views that solve() gets. Bodies in order, and the nodes of each: one that was here in the
  // last tick remembers its friction. Held nodes are left out. False when full.
  bool add(int body, const SpringLattice& lattice, int node, double gap_m, double friction);
  // Contacts remember nothing of the ticks before.
  void forget();

  const Vector3& normal() const { return normal_; }
  std::span<GroundContact> of_body(int body);

  // Of a lattice that its springs step, after the kick and before the drift of a substep of h_s.
  void solve(int body, const LatticeView& view, double h_s, double push_speed_cap_m_per_s);

  int count() const { return static_cast<int>(contacts_.size()); }
  // What the ground gave a body since begin(), N s.
  Vector3 impulse_ns(int body) const;
  // Marks the nodes of a body that it pushed.
  void mark_touched(int body, std::uint8_t* touched) const;

  // All that the next tick depends on.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const GroundContact& contact : contacts_) {
      visit(contact.impulse_ns.data(), 3);
      visit(&contact.mean_push_n, 1);
      visit(&contact.time_s, 1);
    }
  }

 private:
  std::size_t capacity_;
  std::vector<GroundContact> contacts_, last_;  // last_: of the tick before
  std::size_t looked_at_ = 0;                   // in last_
  double last_time_s_ = 0.0, time_s_ = 0.0;     // of material, of the tick before and of this
  Vector3 normal_ = Vector3::UnitY();
};

}  // namespace spoonbill
