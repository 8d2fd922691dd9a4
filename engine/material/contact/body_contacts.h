// Contacts of bodies with each other and with themselves, and of points of their surfaces with the ground.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/material/contact/contact_constraints.h"
#include "engine/material/contact/contact_push.h"
#include "engine/material/contact/kept_values.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Index that stands for the ground instead of a body.
inline constexpr int ground_index = lattice_capacity;

// A point of a body. `body` is the index of the body's lattice in the views passed to pass(). A point without
// nodes stands still.
struct BodyPoint {
  int body = 0;
  const SpringLattice* lattice = nullptr;
  EmbeddedPoint point = {};
};

// Approach of an implicitly stepped body to another one in a step, beyond their gap, above which contacts are
// solved further; in cells of the coarser body. A tick may have 16 steps, and bodies may come closer in each.
inline constexpr double unsolved_approach_cells = 0.004;

// How the velocities of nodes and of an embedded point depend on each other.
struct PointMobility {
  // Largest velocity change of a node per impulse on the point, 1/kg, without frames.
  double node_per_kg = 0.0;
  // Sum of the absolute weights. The point's velocity changes at most by this multiple of the nodes' changes.
  double absolute_weight = 0.0;
};

// Contacts between two bodies, or of a body with itself: velocity constraints between points of
// their surfaces, which are solved after the contacts of tools. Impulses are equal and opposite, so momentum
// is conserved. A push on the lattice of a soft tool also acts on its frame (see MovingFrame).
//
// Stores the contacts of one tick, and their forces in the last tick. Where a tick is divided, its parts
// count as ticks here. Has one owner, on one thread. Allocates only in its constructor.
class BodyContacts {
 public:
  explicit BodyContacts(int capacity);
  // A copy would have no memory for more contacts.
  BodyContacts(const BodyContacts&) = delete;
  BodyContacts& operator=(const BodyContacts&) = delete;
  BodyContacts(BodyContacts&&) = default;
  BodyContacts& operator=(BodyContacts&&) = default;

  // Tells whether bodies have their real inertia, which is false at first, and which part of a tick the next
  // step lasts. Call before the first add() of a step; constraints that keep() retains are not affected.
  void set_real_time(bool is_real_time, double tick_fraction = 1.0) {
    is_real_time_ = is_real_time;
    tick_fraction_ = tick_fraction;
  }
  // Removes the constraints, and remembers their forces and present gaps for the constraints that are added
  // next. `lattices` are those of the bodies, by BodyPoint::body.
  void clear(std::span<const SpringLattice* const> lattices);
  // Removes the constraints and all that is remembered of them.
  void forget();
  // Adds a constraint that keeps the first point on one side of the second: the side to which the unit vector
  // `normal` points. `gap_m` is the present distance of the first point beyond the second along `normal`,
  // negative for a penetration. Both points may be of the same body and share nodes. Returns false when full.
  // `sample` is the number of the first point among the samples or vertices of its body; push and friction
  // then start from the force of the last tick. For a point that differs in every tick, `sample` is -1, and
  // the force starts from zero.
  //
  // The gap of a constraint follows the points that the lattices move. A new search finds a slightly
  // different gap, because the surfaces do not follow these points exactly and the normal has turned. If a
  // constraint took over the difference at once, a collision would leave overlaps, and separate() would add
  // energy by correcting them against its forces. Therefore, a constraint of a body with springs keeps its
  // own gap, and takes over a part of the difference in each tick: a smaller one in real time between
  // soft bodies, or of a soft body with itself, which must keep their energy. Between rigid bodies, gaps are
  // exact.
  //
  // A surface may fold locally, as beside the pole of a pressed tube. Its normal then points inwards there,
  // and a point outside seems to be deep inside. A point that is deeper than `deepest_new_m` and had no
  // constraint in the last tick is therefore left out, and a constraint whose normal has turned round keeps
  // its earlier normal and gap. Bodies that begin in each other keep all points of the first search after
  // forget().
  bool add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m,
           double deepest_new_m, int sample);
  // Adds a constraint that keeps a point of a rigid body, or of a body with springs, on the side of the
  // ground to which `normal` points. GroundContacts holds the contacts of nodes.
  bool add_on_ground(const BodyPoint& point, const Vector3& normal, double gap_m, double ground_friction,
                     int sample);

  // Keeps the constraints of the last tick for the next one, which needs no new search, as if they were added
  // again. Bodies must not have turned or moved noticeably since the constraints were added, and inverse
  // masses and frictions must be the same.
  void keep();

  // Returns for each body the highest speed at which a point of it meets another body, itself or the ground
  // within `time_s`, m/s, by constraints of the kind MovedBy::springs.
  std::array<double, lattice_capacity> find_impacts_m_per_s(std::span<const LatticeView> lattices,
                                                            double time_s) const;

  // Starts a step of `time_s`: marks all constraints as not having acted.
  void begin(double time_s);
  // Time of the last step, s; 0 before the first.
  double time_s() const { return time_s_; }

  // Calls visit(node, impulse) for nodes of an implicitly stepped body, whose solver needs at the start of
  // its step the impulses that are known then, N s: the mean forces of the last step times the time of this
  // one. Call after begin().
  template <class Visit>
  void visit_known_impulses(int body, const Visit& visit) const {
    for (const Constraint& constraint : constraints_) {
      const Vector3& impulse_ns = constraint.responded_ns;
      if (impulse_ns.isZero(0.0)) continue;
      if (constraint.first_body == body) constraint.first.visit_shares(impulse_ns, visit);
      if (constraint.second_body == body) constraint.second.visit_shares(-impulse_ns, visit);
    }
  }

  // Acts with the forces of the last substep, friction included. Implicitly stepped bodies already include
  // the impulses of visit_known_impulses(). Call after the kick of a substep of h_s.
  void start(std::span<const LatticeView> lattices, double h_s);
  // Solves each constraint of the kind pass.moved_by once, or only those with an implicitly stepped body.
  // Call after start() and before the drift of a substep of h_s. A reversed pass solves the last constraint
  // first.
  // Returns whether it changed a velocity.
  bool pass(std::span<const LatticeView> lattices, const ContactPass& pass);
  // Moves the points of bodies with springs out of each other, out of their own body and out of rigid ones,
  // by a part of the overlap and at most by the distance that the caps allow in a substep of h_s. Velocities
  // do not change, so that the correction adds no kinetic energy and does not shake bodies at rest. Points
  // without a sample are not moved, because each would begin with an overlap of its own in every tick. Call
  // after the drift.
  void separate(std::span<const LatticeView> lattices, double h_s, std::span<const float> caps_m_per_s);
  // Multiplies by `fraction` the changes that the last pass() with MovedBy::solvers made to the forces. The
  // caller must scale the impulses on the nodes in the same way.
  void shorten_solver_pass(double fraction);
  // Returns the work that the impulses of the constraints of the kind MovedBy::springs between an implicitly
  // stepped body and others, to which the body has not responded yet, have done on both, J, with the velocity
  // changes that each constraint alone would cause.
  double find_assumed_work_j(int body) const;
  // Tells that an implicitly stepped body has responded to these impulses, multiplied by `fraction`. Takes
  // back the rest from the other bodies.
  void respond(int body, double fraction, std::span<const LatticeView> lattices);
  // Returns whether a constraint of this kind with an implicitly stepped body would let it approach another
  // one in a step of `time_s` by more than unsolved_approach_cells beyond their gap.
  bool are_approaching(std::span<const LatticeView> lattices, MovedBy moved_by, double time_s) const;
  // Returns whether there is a constraint of the kind MovedBy::solvers.
  bool has_constraint_between_solvers() const;

  int count() const { return static_cast<int>(constraints_.size()); }
  // Returns the largest overlap of two bodies when their constraints were added, m; 0 if none overlap.
  double largest_overlap_m() const;
  // Returns the impulse of all other bodies on a body since begin(), N s, for a tick of `time_s`. Constraints
  // of a body with itself have no effect on it.
  Vector3 impulse_ns(int body, double time_s) const;
  // Returns the impulse of the ground on a body since begin(), N s.
  const Vector3& ground_impulse_ns(int body) const { return ground_impulse_ns_[body]; }
  // Returns the work that a body with a prescribed motion has done on other bodies since begin(), J, in a
  // tick of `time_s`. `lattice` is the frame to which the body is attached, after the tick.
  double work_j(int body, const SpringLattice& lattice, double time_s) const;
  // Returns whether any constraint of a body, or between two bodies, has acted since begin().
  bool acted(int body) const;
  bool acted(int body, int other) const;
  // Sets to 1 the bytes in `touched` of the nodes of a body on which a constraint has acted.
  void mark_touched(int body, std::uint8_t* touched) const;

  // Calls visit(sample, other) for each sample of a body that a constraint with the body `other` has pushed
  // since begin(), or that was closer than `reach_m` when its constraint was added.
  template <class Visit>
  void visit_pushed_samples(int body, double reach_m, const Visit& visit) const {
    for (const Constraint& constraint : constraints_) {
      if (constraint.first_body != body || constraint.sample < 0) continue;
      if (constraint.second_body == ground_index) continue;
      if (constraint.added_gap_m < reach_m || (constraint.acted && !constraint.force_n.isZero(0.0))) {
        visit(constraint.sample, constraint.second_body);
      }
    }
  }

  // Calls `visit` with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Constraint& constraint : constraints_) {
      visit(constraint.force_n.data(), 3);
      visit(constraint.normal.data(), 3);
      for (const double* value : {&constraint.base_m, &constraint.difference_m, &constraint.compliance})
        visit(value, 1);
      if (constraint.is_implicit() && constraint.moved_by == MovedBy::springs)
        visit(constraint.impulse_ns.data(), 3);
    }
  }

 private:
  struct Constraint {
    int first_body = 0, second_body = 0;
    EmbeddedPoint first, second;
    Vector3 first_rest_m, second_rest_m;  // of the points of rigid bodies that contacts can move
    Vector3 normal = Vector3::UnitY();
    // Relative velocity change of the points per impulse, 1/kg, without frames and rigid bodies.
    double compliance = 0.0;
    bool has_response = false;  // whether find_response() has been called in the present substep
    // Found by the last find_response():
    double shift_per_kg = 0.0;   // the same with rigid bodies
    double normal_per_kg = 0.0;  // the same with rigid bodies and frames, along the normal
    double slide_per_kg = 0.0;   // the same with rigid bodies and frames, at most across the normal
    double base_m = 0.0;         // gap minus the part due to displacements since rest
    double difference_m = 0.0;   // gap that the search found, minus the gap of the constraint
    double taken_over = 0.0;     // part of this difference that is taken over in a tick
    double added_gap_m = 0.0;    // gap when the constraint was added
    double unsolved_m = 0.0;     // distance by which the bodies may approach each other beyond their gap
    double gap_m = 0.0;          // gap at the last start()
    // Separation speed at the last start() above the smallest admissible one, for a constraint without a
    // force. While it is larger than what pushes can have changed, the constraint does not act.
    double spare_m_per_s = 0.0;
    PointMobility first_mobility, second_mobility;
    double friction = 0.0;  // the smaller coefficient of the two surfaces
    MovedBy moved_by = MovedBy::springs;
    bool is_first_implicit = false, is_second_implicit = false;  // whether an implicit solver steps the body
    bool separates = false;  // whether separate() corrects an overlap, instead of the push
    int sample = -1;
    Vector3 force_n = Vector3::Zero();  // force on the first point in the last substep: push and friction
    // Mean force in the last step, if a body is stepped implicitly. The force of the last of many substeps
    // may be far larger, when bodies have just met.
    Vector3 known_force_n = Vector3::Zero();
    // Impulse since begin() to which such a body has responded, N s, and `force_n` then.
    Vector3 responded_ns = Vector3::Zero(), responded_force_n = Vector3::Zero();
    Vector3 passed_force_n = Vector3::Zero();  // `force_n` before the last pass()
    Vector3 impulse_ns = Vector3::Zero();      // impulse on the first point since begin(), N s
    bool acted = false;

    ContactKey key() const { return {first_body, second_body, sample}; }
    bool is_implicit() const { return is_first_implicit || is_second_implicit; }
  };
  bool add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m,
           double deepest_new_m, int sample, double friction);
  // Returns whether a constraint of the kind MovedBy::springs is between a body and another one.
  static bool is_with_others(const Constraint& constraint, int body);
  // Finds how the bodies of a constraint respond to it in the present substep.
  static void find_response(std::span<const LatticeView> lattices, Constraint& constraint);
  // One of the two points of a constraint, on a body with a view. That of the ground is empty.
  struct Side {
    const LatticeView& view;
    const EmbeddedPoint& point;
    const Vector3& rest_m;

    Vector3 displacement_m() const;
    Vector3 velocity_m_per_s() const;
    void push(const Vector3& impulse_ns) const;
    void shift(const Vector3& impulse_ns, double time_s) const;
  };
  static Side first_side(std::span<const LatticeView> lattices, const Constraint& constraint);
  static Side second_side(std::span<const LatticeView> lattices, const Constraint& constraint);
  static double find_gap_m(std::span<const LatticeView> lattices, const Constraint& constraint);
  static Vector3 find_relative_m_per_s(std::span<const LatticeView> lattices, const Constraint& constraint);
  // Returns whether the pushes since start() may have made a constraint act that did not act then.
  bool may_act(const Constraint& constraint) const;
  // Returns whether it changed a velocity.
  bool solve(std::span<const LatticeView> lattices, Constraint& constraint, double h, double cap);
  // Pushes the bodies of a constraint, N s. Of the impulse, `known_ns` has already acted on those that are
  // stepped implicitly.
  void push(std::span<const LatticeView> lattices, Constraint& constraint, const Vector3& impulse,
            const Vector3& known_ns = Vector3::Zero());

  struct Kept {
    Vector3 force_n, mean_force_n;
    Vector3 normal;
    double gap_m;
  };

  std::size_t capacity_;
  std::vector<Constraint> constraints_;
  KeptValues<Kept> kept_;  // of the last tick
  // Impulses on each body since begin() of the constraints that substeps solve, N s.
  std::array<Vector3, lattice_capacity> impulse_ns_, ground_impulse_ns_;
  // Bound of how much pushes have changed the velocity of a node of each body since start(), m/s.
  std::array<double, lattice_capacity + 1> changed_m_per_s_{};
  bool has_searched_ = false;  // whether a tick has begun since forget()
  bool is_real_time_ = false;
  double tick_fraction_ = 1.0;
  double time_s_ = 0.0;  // duration of the present step, see begin()
};

}  // namespace spoonbill
