// Motion of a rigid body that is free, or that a hand holds by a spring: momentum, gravity and the response
// to contacts. Its surface is attached to a frame of eight nodes (rigid_frame()), whose positions and
// velocities follow the body.
#pragma once

#include <array>

#include "engine/base/geometry.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/rigid/rigid_mass.h"
#include "engine/material/springs/lattice_kernels.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Target of the hand that holds a rigid body: a pose that maps the rest shape to where the hand would hold
// it, and the velocity of this pose.
struct HoldTarget {
  Pose pose;
  Vector3 velocity_m_per_s = Vector3::Zero();  // of the body's centre of mass
  Vector3 spin_rad_per_s = Vector3::Zero();
};

// Owned by the simulation's state of the body, and used by the thread that runs the tick. Nothing but the
// constructor allocates.
//
// kick(), push(), shift() and drift() are the parts of a substep. Only shift() and drift() set the velocities
// of the frame's nodes in a view; velocity_m_per_s() is exact at any time. An impulse at a point, distributed
// to the nodes by the point's weights, has the same momentum and angular momentum as the impulse itself,
// because the weights reproduce linear functions.
class RigidDynamics {
 public:
  // `mass` is that of the body at rest, with a positive mass and a positive definite inertia tensor. `frame`
  // is its frame.
  RigidDynamics(const RigidMass& mass, const LatticeMesh& frame);

  const Pose& pose() const { return pose_; }
  const RigidMass& mass() const { return mass_; }
  Vector3 centre_m() const { return pose_.position_m + pose_.orientation * mass_.centre_m; }
  const Vector3& velocity_m_per_s() const { return velocity_m_per_s_; }  // of the centre of mass
  const Vector3& spin_rad_per_s() const { return spin_rad_per_s_; }
  // Returns the velocity of the body at a point with the offset `arm_m` from the centre of mass.
  Vector3 velocity_m_per_s(const Vector3& arm_m) const {
    return velocity_m_per_s_ + spin_rad_per_s_.cross(arm_m);
  }
  // Kinetic and gravitational energy; the gravitational energy is zero at the origin.
  double energy_j(const Vector3& gravity_m_per_s2) const;
  // Impulse of the hand on the body since clear_hand_impulse(), N s.
  const Vector3& hand_impulse_ns() const { return hand_impulse_ns_; }

  // Puts the body at rest at `pose`.
  void place(const Pose& pose);
  void set_velocity(const Vector3& velocity_m_per_s, const Vector3& spin_rad_per_s);
  // Makes the present pose the rest shape, at rest. `frame` is the body's frame there.
  void keep_shape(const LatticeMesh& frame);
  // Multiplies mass and inertia, as a change of density does.
  void scale_mass(double factor);
  // Multiplies the inertia, but neither the weight nor any other force.
  void set_inertia_scale(double scale);

  void clear_hand_impulse() { hand_impulse_ns_.setZero(); }
  // Sets the positions and velocities of the frame's nodes. Call after a change outside a substep.
  void place_nodes(const LatticeView& view);
  // Accelerates the body by gravity, and by the hand if there is one, in a substep of h_s. The spring and its
  // damper are implicit in the velocity. `drag_per_s` damps the motion of a free body, without a change of
  // static forces. Call before the contacts are solved.
  void kick(double h_s, const Vector3& gravity_m_per_s2, double drag_per_s, const HandSpring* hand,
            const HoldTarget& target);
  // Returns the offset from the centre of mass, and the displacement, of the point that is at `rest_m` when
  // the body is at rest, m.
  Vector3 arm_m(const Vector3& rest_m) const { return turn_ * (rest_m - mass_.centre_m); }
  Vector3 displacement_m(const Vector3& rest_m) const { return pose_.position_m + turn_ * rest_m - rest_m; }
  // Returns the offset of a node of the frame from the centre of mass, m.
  const Vector3& offset_m(int node) const { return offsets_m_[static_cast<std::size_t>(node)]; }
  // Pushes the body at a point with the offset `arm_m` from the centre of mass. The spring of the hand
  // resists within the substep.
  void push(const Vector3& arm_m, const Vector3& impulse_ns);
  // Moves the body as an impulse would in `time_s`, without a change of velocity.
  void shift(const LatticeView& view, const Vector3& arm_m, const Vector3& impulse_ns, double time_s);
  // Moves the body at its velocity. Angular momentum is conserved exactly, energy to second order in h_s.
  void drift(const LatticeView& view, double h_s);

  // Velocity change along a unit vector per impulse along it, at a point with the offset `arm_m`, 1/kg.
  double compliance(const Vector3& arm_m, const Vector3& direction) const;
  // The largest such change along any vector perpendicular to the unit vector `normal`.
  double slide_compliance(const Vector3& arm_m, const Vector3& normal) const;
  // Upper bound of the change along any vector, at a point with the offset `arm_m`; at most sqrt(3) times the
  // largest.
  double any_compliance(const Vector3& arm_m) const;
  // Bound of the velocity change of any point of the frame per impulse at any point of the frame, 1/kg.
  double largest_compliance() const { return largest_per_kg_; }

  // Calls visit(const double*, count) with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit(pose_.position_m.data(), 3);
    visit(pose_.orientation.coeffs().data(), 4);
    visit(velocity_m_per_s_.data(), 3);
    visit(spin_rad_per_s_.data(), 3);
  }

 private:
  Eigen::Matrix3d inertia_of(const Quaternion& orientation) const;  // about the centre, scaled
  Vector3 spin_of(const Quaternion& orientation, const Vector3& angular_momentum) const;
  void move_centre_to(const Vector3& centre_m, const Quaternion& orientation);
  void adopt_frame(const LatticeMesh& frame);

  RigidMass mass_;
  Eigen::Matrix3d inverse_inertia_;  // of the body at rest, not scaled
  std::array<Vector3, 8> nodes_m_;   // of the frame, at rest
  double scale_ = 1.0;
  Pose pose_;
  Vector3 velocity_m_per_s_ = Vector3::Zero(), spin_rad_per_s_ = Vector3::Zero();
  Vector3 hand_impulse_ns_ = Vector3::Zero();
  // The following values are those of the present substep.
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();       // orientation of the body
  std::array<Vector3, 8> offsets_m_;                         // of the nodes from the centre of mass
  double inverse_mass_per_kg_ = 0.0;                         // with the response of the hand
  Eigen::Matrix3d turn_response_ = Eigen::Matrix3d::Zero();  // inverse inertia, with the hand
  double largest_per_kg_ = 0.0;
  double largest_inertia_kg_m2_ = 0.0;  // of the three principal ones, scaled
};

}  // namespace spoonbill
