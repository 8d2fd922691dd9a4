// Contacts of bodies with each other, with themselves and with the ground.
#pragma once

#include <span>
#include <vector>

#include "engine/material/contact/kept_forces.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// A point of a body. `body` is the index of its lattice in the views passed to solve().
struct BodyPoint {
  int body = 0;
  const SpringLattice* lattice = nullptr;
  EmbeddedPoint point;
};

// Contacts between two deformable bodies, or of a body with itself: velocity constraints between points of
// their surfaces. They are solved in each substep after the contacts of tools. Impulses are equal and
// opposite, so momentum is conserved.
//
// Contacts of one tick, and their forces in the last tick. One owner, one thread; allocates only in its
// constructor.
class BodyContacts {
 public:
  explicit BodyContacts(int capacity);

  // Removes the constraints, and remembers their forces for those that are added next.
  void clear();
  // Removes the constraints and their forces.
  void forget();
  // Adds a constraint that keeps the first point on one side of the second: the side to which the unit vector
  // `normal` points. `gap_m` is the present distance of the first point beyond the second along `normal`,
  // negative for a penetration. Both points may be of the same body and share nodes. Returns false when full.
  // `sample` numbers the first point among the samples or vertices of its body, so that its push starts from
  // the force of the last substep; -1 for a point that differs in every tick, whose push starts from zero.
  bool add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m, int sample);

  // Starts a tick: marks all constraints as not having acted.
  void begin();

  // The constraints between two lattices that the implicit solver moves are solved once a tick, all others in
  // each substep.
  enum class Moved { by_springs, by_solvers };
  // Calls visit(node, impulse) with the impulses, N s, of constraints that are solved once a tick on the
  // nodes of a body: those that the forces of the last tick give in a tick of `time_s`. The solvers must know
  // them when they start their steps.
  template <class Visit>
  void visit_known_impulses(int body, double time_s, const Visit& visit) const {
    for (int c = 0; c < count_; ++c) {
      const Constraint& constraint = constraints_[static_cast<std::size_t>(c)];
      if (constraint.moved != Moved::by_solvers || !(constraint.force_n > 0.0)) continue;
      const Vector3 impulse = time_s * constraint.force_n * constraint.normal;
      if (constraint.first_body == body) constraint.first.visit_shares(impulse, visit);
      if (constraint.second_body == body) constraint.second.visit_shares(-impulse, visit);
    }
  }

  // Pushes with the forces of the last substep, other than those that solvers know. Call after the kick of a
  // substep of h_s.
  void start(std::span<const LatticeView> lattices, double h_s);
  // Solves the constraints once. Call after start() and before the drift of a substep of h_s. A reversed pass
  // solves the last constraint first.
  struct Pass {
    double h_s;
    Moved moved;
    bool is_reversed;
    std::span<const float> push_speed_caps_m_per_s;  // by body
  };
  void pass(std::span<const LatticeView> lattices, const Pass& pass);
  // Shortens the changes of the forces in the last pass() by_solvers to this fraction. The caller does so
  // with the impulses on the nodes.
  void shorten_solver_pass(double fraction);
  // Returns whether a constraint acts between two lattices that the implicit solver moves.
  bool has_constraint_between_solvers() const;

  int count() const { return count_; }
  // Returns whether any constraint of a body, or between two bodies, has acted since begin().
  bool acted(int body) const;
  bool acted(int body, int other) const;
  // Sets to 1 the bytes in `touched` of the nodes of a body on which a constraint has acted.
  void mark_touched(int body, std::uint8_t* touched) const;

  // Visits what the next tick depends on.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (int c = 0; c < count_; ++c) visit(&constraints_[static_cast<std::size_t>(c)].force_n, 1);
  }

 private:
  struct Constraint {
    int first_body = 0, second_body = 0;
    EmbeddedPoint first, second;
    Vector3 normal = Vector3::UnitY();
    double compliance = 0.0;  // velocity change per impulse between the points, 1/kg
    double base_m = 0.0;      // gap minus the part due to displacements since rest
    double friction = 0.0;    // the smaller coefficient of the two surfaces
    Moved moved = Moved::by_springs;
    int sample = -1;
    double force_n = 0.0;         // push in the last substep; 0 for a push that starts from zero
    double passed_force_n = 0.0;  // that force before the last pass()
    bool acted = false;

    ContactKey key() const { return {first_body, second_body, sample}; }
    bool keeps_force() const { return sample >= 0; }
  };
  void solve(std::span<const LatticeView> lattices, Constraint& constraint, double h, double cap);
  void push(std::span<const LatticeView> lattices, Constraint& constraint, const Vector3& impulse);

  std::vector<Constraint> constraints_;
  KeptForces kept_;  // of the last tick
  int count_ = 0;
};

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

// Rigid ground under bodies: velocity constraints on their nodes. Lattices with springs solve them in each
// substep, after all other contacts. Implicit solvers solve them once a tick.
//
// Stores the contacts of one tick and the friction state that the next tick continues from. Each contact
// constrains a single node, so one pass solves the contacts of spring-stepped lattices exactly, and sticking
// contacts do not creep. One owner, one thread; allocates only in its constructor.
class GroundContacts {
 public:
  explicit GroundContacts(int capacity);

  // Starts a tick of `time_s`; the unit vector `normal` points out of the ground.
  void begin(const Vector3& normal, double time_s);
  // Adds a node whose attached surface is `gap_m` above the ground, negative if below it. `body` is the index
  // of the lattice in the views passed to solve(). Call in ascending order of bodies and nodes; a contact of
  // the last tick keeps its friction state. Fixed nodes are ignored. Returns false when full.
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

  // Visits everything that the next tick depends on.
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
