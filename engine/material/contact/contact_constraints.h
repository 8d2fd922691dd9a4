// Contacts of a tool with the lattices that it touches: velocity constraints on points of their surfaces,
// solved in each substep. They are stable at any stiffness, whereas a penalty force would limit the step.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/contact/contact_push.h"
#include "engine/material/contact/kept_values.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Largest number of lattices that are stepped together.
inline constexpr int lattice_capacity = 9;

// Position and velocity of the tool's proxy, which contacts can hold away from the hand. Plain data, stored
// from tick to tick.
struct ToolState {
  Vector3 position_m = Vector3::Zero();
  Vector3 velocity_m_per_s = Vector3::Zero();
};

// Nodes of a soft tool's lattice that are fixed to the tool and move rigidly with it. Their rest positions
// are in the tool's frame.
struct CarriedNodes {
  int body = -1;  // index of the lattice; -1 for none
  std::span<const int> nodes;
};

// Motion that the hand prescribes for the tool in one tick, in the world frame.
struct ToolMotion {
  Vector3 start_m = Vector3::Zero();
  Vector3 end_m = Vector3::Zero();
  Quaternion orientation = Quaternion::Identity();  // of a soft tool: that at the start of the tick
  double radius_m = 0.0;
  // Stiffness of the critically damped spring between hand and tool; 0 couples them rigidly.
  double coupling_n_per_m = 0.0;
  bool body_yields = true;  // false: the tool meets the body as a rigid wall
  double friction = 0.0;    // friction coefficient of the tool; the larger one of tool and body counts
  CarriedNodes carried;
};

// Keys identify a pushed point from tick to tick, so that its push starts from the force of the last substep.
// A point at a sample of the surface has the sample's number as its key. Some points are or were nearest to
// the tool: their keys are nearest_point_key, nearest_point_key - 1 and so on. Points between samples have
// larger keys than all samples.
inline constexpr int nearest_point_key = -1;
// Key of a point that differs in every tick, whose push starts from zero.
inline constexpr int changing_point_key = -1000;

// Contacts of one tool in one tick, and their forces in the last tick. Has one owner, on one thread.
// Allocates only in its constructor.
class ContactConstraints {
 public:
  explicit ContactConstraints(int capacity);
  // A copy would have no memory for more contacts.
  ContactConstraints(const ContactConstraints&) = delete;
  ContactConstraints& operator=(const ContactConstraints&) = delete;
  ContactConstraints(ContactConstraints&&) = default;
  ContactConstraints& operator=(ContactConstraints&&) = default;

  // Removes the constraints, and remembers their forces for the constraints that are added next.
  void clear();
  // Removes the constraints and their forces.
  void forget();
  // Takes over the constraints of another object of the same capacity. A push on a sample of `body` gets the
  // key new_key[key]; pushes on points between its samples are left out.
  void carry_over(const ContactConstraints& other, int body, std::span<const int> new_key);
  // Each add function returns false if there are already as many constraints as the capacity permits. `body`
  // is the index of the lattice in the views passed to start() and pass().
  //
  // Adds a point that the tool's sphere may push outward but never pulls. The pushed point is at the constant
  // offset `offset_m` from `point`.
  bool add_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point, int key,
                const Vector3& offset_m = Vector3::Zero());
  // Adds a point that must stay beyond a plane that moves with the tool. The unit vector `normal` points to
  // the admissible side; `offset_m` is the plane's distance from the tool's centre along `normal`. Use it for
  // tools smaller than a cell, and for tools whose surface is flat over the distance moved in a tick.
  bool add_plane_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                      const Vector3& normal, double offset_m, int key);
  // Adds a point that the tool grips. The tool holds it at the offset `offset_m` from the tool's centre, in
  // the tool's frame.
  bool add_grip(int body, const SpringLattice& lattice, const EmbeddedPoint& point, const Vector3& offset_m);
  // Holds a point at `offset_m` in the tool's frame, but only across the unit vector `normal`.
  bool add_hold(int body, const SpringLattice& lattice, const EmbeddedPoint& point, const Vector3& offset_m,
                const Vector3& normal);

  // Returns the force in N with which the tool pushed a point at the end of the last tick; 0 if it did not
  // push the point, and for changing_point_key.
  double last_force_n(int body, int key) const;

  // Starts a tick of `time_s`.
  void begin(const ToolMotion& motion, double time_s);

  const ToolMotion& motion() const { return motion_; }
  // frame() returns the frame of a soft tool's lattice. adopt() gives the tool the velocity of the frame, and
  // adds the pushes on the frame to tool_impulse(). Call frame() after start(), and adopt() after all
  // contacts of the lattice are solved and before finish().
  MovingFrame frame(const ToolState& tool) const { return {tool.velocity_m_per_s, response_compliance_}; }
  void adopt(const MovingFrame& frame, ToolState& tool) {
    tool.velocity_m_per_s = frame.velocity_m_per_s;
    tool_impulse_[motion_.carried.body] += frame.impulse_ns;
  }

  // start(), pass() and finish() are the parts of a substep of h_s, after the kick and before the drift of
  // the lattices. start() changes the tool's velocity so that it follows the hand, and pushes with the forces
  // of the last substep; `fraction` [0, 1) is the part of the tick that has passed. Each pass() solves each
  // constraint of one kind once: those on explicitly stepped lattices, or those on implicitly stepped ones.
  // finish() moves the tool. Impulses on nodes and tool are equal and opposite.
  void start(std::span<const LatticeView> lattices, ToolState& tool, double h_s, double fraction);
  void pass(std::span<const LatticeView> lattices, ToolState& tool, const ContactPass& pass);
  void finish(ToolState& tool, double h_s) { tool.position_m += h_s * tool.velocity_m_per_s; }
  // Scales the impulses of the last pass() on the tool by `fraction`. The caller must scale the impulses on
  // the nodes in the same way.
  void shorten_pass(ToolState& tool, double fraction);
  // Returns the dot product of the total impulse of the last pass() on the tool and the velocity change that
  // it caused, J.
  double pass_work_j(const ToolState& tool) const {
    return (tool.velocity_m_per_s - passed_.velocity_m_per_s).squaredNorm() /
           std::max(response_compliance_, std::numeric_limits<double>::min());
  }

  int count() const { return static_cast<int>(constraints_.size()); }
  bool has_constraint_on(int body) const;
  // Returns the sum of the impulses of a body on the tool since begin(), N s. The impulses of all bodies on a
  // soft tool have the index of the tool's own lattice.
  const Vector3& tool_impulse(int body) const { return tool_impulse_[body]; }
  bool acted() const { return acted_; }
  // Sets to 1 the bytes in `touched` of the nodes of a body on which a constraint has acted.
  void mark_touched(int body, std::uint8_t* touched) const;

  // Calls visit(key) for each constraint on a body that has pushed since begin() and has the number of a
  // sample, or of a point between samples, as its key.
  template <class Visit>
  void visit_pushed_samples(int body, const Visit& visit) const {
    for (const Constraint& constraint : constraints_) {
      if (constraint.acted && constraint.body == body && constraint.key >= 0) visit(constraint.key);
    }
  }

  // Calls `visit` with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Constraint& constraint : constraints_) visit(&constraint.force_n, 1);
  }

 private:
  enum class Kind { sphere_push, plane_push, grip, hold };
  struct Constraint {
    Kind kind = Kind::sphere_push;
    int body = 0;
    EmbeddedPoint point;
    // Rest position of the constrained point. In the argument of add(), it is only the offset from `point`.
    Vector3 rest_m = Vector3::Zero();
    Vector3 direction =
        Vector3::Zero();    // normal of a plane push; offset of a grip or hold in the tool's frame
    double offset_m = 0.0;  // distance of the plane from the tool's centre; plane push only
    // The following four values are those of the last start(); they stay the same until the tool moves.
    Vector3 position_m = Vector3::Zero();  // position of the constrained point
    // Unit vector from the tool to a pushed point; zero at the centre of the tool's sphere, and for grips.
    // A hold keeps the normal with which it was added.
    Vector3 normal = Vector3::Zero();
    double gap_m = 0.0;  // distance of a pushed point from the tool; negative inside the tool
    // Velocity change of the point per impulse, 1/kg; 0 if the body does not yield. For a rigid body, it is
    // that along the normal of a push; `slide_compliance` is the largest across the normal.
    double compliance = 0.0, slide_compliance = 0.0;
    double friction = 0.0;  // friction coefficient of the body's surface
    int key = changing_point_key;
    bool is_implicit = false;  // true if an implicit solver steps the lattice
    // True if a push starts from the force of the last substep. False for grips, for changing_point_key, and
    // on implicitly stepped lattices. The contact mass of such a lattice is an estimate, and the force of the
    // last substep would amplify its error.
    bool keeps_force = false;
    double force_n = 0.0;               // push in the last substep
    Vector3 drag_ns = Vector3::Zero();  // friction impulse in this substep; only if `keeps_force`
    bool acted = false;
  };
  bool add(const Constraint& constraint, const SpringLattice& lattice);
  void follow_hand(ToolState& tool, double h, double fraction) const;
  void solve_push(const LatticeView& lattice, Constraint& constraint, ToolState& tool, double h, double cap);
  void solve_grip(const LatticeView& lattice, Constraint& constraint, ToolState& tool, double h, double cap);
  void solve_hold(const LatticeView& lattice, Constraint& constraint, ToolState& tool, double h, double cap);
  static Vector3 find_return_m_per_s(const Vector3& miss_m, const Constraint& constraint, double h,
                                     double cap);
  // Computes the values of a constraint that stay the same until the tool moves.
  void locate(const LatticeView& lattice, Constraint& constraint, const ToolState& tool) const;
  ContactPush find_push(const LatticeView& lattice, const Constraint& constraint,
                        const ToolState& tool) const;
  void exchange(const LatticeView& lattice, Constraint& constraint, ToolState& tool, const Vector3& impulse);

  std::size_t capacity_;
  std::vector<Constraint> constraints_;
  KeptValues<double> kept_;  // forces of the last tick
  ToolMotion motion_;
  Vector3 hand_velocity_ = Vector3::Zero();  // m/s
  double tool_compliance_ = 0.0;  // 1 / mass of the tool, 1/kg; 0 if the hand holds the tool rigidly
  // Velocity change of the tool at the end of a substep per impulse, 1/kg. It includes the response of the
  // coupling spring and its damper.
  double response_compliance_ = 0.0;
  std::array<Vector3, lattice_capacity> tool_impulse_;
  // The tool's velocity and impulses before the last pass().
  struct {
    Vector3 velocity_m_per_s = Vector3::Zero();
    std::array<Vector3, lattice_capacity> impulse_ns;
  } passed_;
  bool acted_ = false;
};

}  // namespace spoonbill
