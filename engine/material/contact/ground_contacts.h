// Contacts of deformable bodies with the ground.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/material/contact/contact_push.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Pace of ground contacts. Each node on the ground has its own contact and closes its gap within a substep.
inline constexpr ContactPace ground_pace{1.0, 4200.0};

// Contact of one node with the ground. Plain data.
//
// Friction is limited by the coefficient times the mean push of the last `friction_memory_s`, not by the
// present push. If friction followed every oscillation of the push, it would amplify the oscillation, and a
// body would hop down a slope on which it should stick.
//
// In experiments, friction follows a change of pressure gradually (Prakash 1998), which makes sliding well
// posed (Ranjith and Rice 2001). Summed over `friction_memory_s`, the impulses obey Coulomb's law.
struct GroundContact {
  int body = 0, node = 0;
  double gap_m = 0.0;
  Vector3 at_m = Vector3::Zero();  // displacement of the node when gap_m was measured
  double friction = 0.0;
  Vector3 impulse_ns = Vector3::Zero();  // impulse on the node in the present tick
  // Carried from tick to tick: the mean force in the last tick, the mean push and the contact time.
  Vector3 force_n = Vector3::Zero();
  double mean_push_n = 0.0;
  double time_s = 0.0;
};

// Averaging time of the push. In this time, a soft body of a centimetre oscillates a few times and slides
// imperceptibly.
inline constexpr double friction_memory_s = 0.01;

// Rigid ground under bodies: velocity constraints on their nodes. In lattices stepped by their springs, the
// constraints are solved in each substep, after all other contacts. Implicit solvers solve them once a tick.
//
// Stores the contacts of one tick and the friction state that the next tick continues from. Each contact
// constrains a single node, so one pass solves the contacts of spring-stepped lattices exactly, and sticking
// contacts do not creep. Has one owner, on one thread. Allocates only in its constructor.
class GroundContacts {
 public:
  explicit GroundContacts(int capacity);

  // Starts a tick of `time_s`; the unit vector `normal` points out of the ground.
  void begin(const Vector3& normal, double time_s);
  // Adds a node whose attached surface is `gap_m` above the ground, negative if below it. `body` is the
  // number that selects the contacts of this lattice in solve(). Call in ascending order of bodies and nodes;
  // a contact of the last tick keeps its friction state. Fixed nodes are ignored. Returns false when full.
  bool add(int body, const SpringLattice& lattice, int node, double gap_m, double friction);
  // Discards all contacts and their friction state.
  void forget();

  const Vector3& normal() const { return normal_; }
  std::span<GroundContact> of_body(int body);

  // Solves the contacts of a lattice that is stepped by its springs. Call after the kick and before the drift
  // of a substep of h_s.
  void solve(int body, const LatticeView& view, double h_s, double push_speed_cap_m_per_s);

  int count() const { return static_cast<int>(contacts_.size()); }
  // Impulse of the ground on a body since begin(), N s.
  Vector3 impulse_ns(int body) const;
  // Sets to 1 the bytes in `touched` of the nodes of a body that the ground has pushed.
  void mark_touched(int body, std::uint8_t* touched) const;

  // Calls `visit` with the state on which the next tick depends.
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
  std::vector<GroundContact> contacts_, last_;  // contacts of this tick, and of the last one
  std::size_t search_position_ = 0;             // position in last_ at which the next search starts
  double last_time_s_ = 0.0, time_s_ = 0.0;     // durations of the last tick and of this one
  Vector3 normal_ = Vector3::UnitY();
};

}  // namespace spoonbill
