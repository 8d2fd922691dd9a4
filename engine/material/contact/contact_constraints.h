// What a tool does to the lattices it touches: velocity constraints on points of their surfaces, solved
// within each substep. Stable for every stiffness, where a penalty force would need its own step limit.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// How many lattices are stepped together.
inline constexpr int lattice_capacity = 9;

// Where the tool is and moves: the proxy, which the material holds off the hand. Plain data, kept from tick
// to tick.
struct ToolState {
  Vector3 position_m = Vector3::Zero();
  Vector3 velocity_m_per_s = Vector3::Zero();  // of material time
};

// The held nodes of a lattice that the tool carries about, as if they were part of it: their rest positions
// are in the tool's frame. For a tool that the hand holds rigidly.
struct CarriedNodes {
  int body = -1;  // the lattice's place in the views; -1 for none
  std::span<const int> nodes;
};

// What the hand does with the tool through one tick, in the world frame.
struct ToolMotion {
  Vector3 start_m = Vector3::Zero();
  Vector3 end_m = Vector3::Zero();
  Quaternion orientation = Quaternion::Identity();
  double radius_m = 0.0;
  // The spring by which the hand holds the tool, critically damped; 0 = held rigidly.
  double coupling_n_per_m = 0.0;
  bool body_yields = true;  // false: the tool meets the body as it would a wall
  CarriedNodes carried;
};

// Working memory for the contacts of one tick. One owner, one thread; allocates only in its constructor.
class ContactConstraints {
 public:
  explicit ContactConstraints(int capacity);

  void clear();
  // Each is false when full. `body` is the lattice's place in the views that solve() gets.
  //
  // A point that the tool's sphere may push outward but never pulls.
  bool add_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point);
  // A point that must stay beyond a plane that moves with the tool: on that side to which the unit `normal`
  // points, `offset_m` along it from the tool's centre. Serves tools smaller than a cell and those whose
  // surface is a plane as far as a tick moves them.
  bool add_plane_push(int body, const SpringLattice& lattice, const EmbeddedPoint& point,
                      const Vector3& normal, double offset_m);
  // A point gripped by the tool at `offset_m` from its centre, in the tool's frame.
  bool add_grip(int body, const SpringLattice& lattice, const EmbeddedPoint& point, const Vector3& offset_m);

  // Begins a tick of `material_time_s`.
  void begin(const ToolMotion& motion, double material_time_s);

  const ToolMotion& motion() const { return motion_; }
  // A force on the tool through the coming substep, N, from the nodes that it carries.
  void pull_tool(const Vector3& force_n) { carried_force_ = force_n; }

  // After the kick and before the drift of a substep of h_s that begins at `fraction` [0 to 1) of the tick.
  // Pushes on nodes and tool are equal and opposite; then the tool moves.
  void solve(std::span<const LatticeView> lattices, ToolState& tool, float h_s, double fraction,
             std::span<const float> push_speed_caps_m_per_s);

  int count() const { return count_; }
  // Over the ticks since begin(): the sum of the impulses that a body gave the tool, N s, and whether any
  // acted.
  const Vector3& tool_impulse(int body) const { return tool_impulse_[body]; }
  bool acted() const { return acted_; }
  // Marks the nodes of a body's constraints that acted.
  void mark_touched(int body, std::uint8_t* touched) const;

 private:
  enum class Kind { sphere_push, plane_push, grip };
  struct Constraint {
    Kind kind = Kind::sphere_push;
    int body = 0;
    EmbeddedPoint point;
    Vector3 rest_m = Vector3::Zero();     // of the undeformed embedding
    Vector3 direction = Vector3::Zero();  // plane push: the normal; grip: the offset in the tool's frame
    double offset_m = 0.0;                // plane push
    double compliance = 0.0;              // 1/kg of the point; 0 when every node is held
    double friction = 0.0;                // of the body's surface; the tool is as rough
    bool acted = false;
  };
  bool add(Kind kind, int body, const SpringLattice& lattice, const EmbeddedPoint& point,
           const Vector3& direction, double offset_m);
  double compliance_of(const Constraint& constraint) const;
  void follow_hand(ToolState& tool, double h, double fraction) const;
  void solve_push(const LatticeView& lattice, Constraint& constraint, ToolState& tool, double h, double cap);
  void solve_grip(const LatticeView& lattice, Constraint& constraint, ToolState& tool, double h, double cap);
  void exchange(const LatticeView& lattice, Constraint& constraint, ToolState& tool, const Vector3& impulse);

  std::vector<Constraint> constraints_;
  int count_ = 0;
  ToolMotion motion_;
  Vector3 hand_velocity_ = Vector3::Zero();  // m/s of material time
  Vector3 carried_force_ = Vector3::Zero();
  double tool_compliance_ = 0.0;  // 1/kg; 0 where the hand holds it rigidly
  // What an impulse gives the tool by the end of the substep, when its spring and damper have answered too.
  double answered_compliance_ = 0.0;
  std::array<Vector3, lattice_capacity> tool_impulse_;
  bool acted_ = false;
};

}  // namespace spoonbill
