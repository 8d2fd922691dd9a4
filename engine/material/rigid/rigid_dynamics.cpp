#include "engine/material/rigid/rigid_dynamics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {
namespace {

using Matrix3 = Eigen::Matrix3d;

// Returns the axis of the shortest turn from one orientation to another, times twice the sine of half its
// angle, which is nearly the angle while it is small.
Vector3 turn_between(const Quaternion& from, const Quaternion& to) {
  const Quaternion turn = to * from.conjugate();
  return (turn.w() < 0.0 ? -2.0 : 2.0) * turn.vec();
}

double largest_eigenvalue(const Matrix3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().z();
}

}  // namespace

RigidDynamics::RigidDynamics(const RigidMass& mass, const LatticeMesh& frame) : mass_(mass) {
  SPOONBILL_ASSERT(mass.mass_kg > 0.0 && largest_eigenvalue(-mass.inertia_kg_m2) < 0.0);
  adopt_frame(frame);
}

void RigidDynamics::keep_shape(const LatticeMesh& frame) {
  const Matrix3 turn = pose_.orientation.toRotationMatrix();
  mass_.centre_m = centre_m();
  mass_.inertia_kg_m2 = turn * mass_.inertia_kg_m2 * turn.transpose();
  adopt_frame(frame);
}

void RigidDynamics::adopt_frame(const LatticeMesh& frame) {
  SPOONBILL_ASSERT(frame.is_frame && frame.nodes.size() == nodes_m_.size());
  std::copy(frame.nodes.begin(), frame.nodes.end(), nodes_m_.begin());
  inverse_inertia_ = mass_.inertia_kg_m2.inverse();
  set_inertia_scale(scale_);
  place({});
}

double RigidDynamics::energy_j(const Vector3& gravity_m_per_s2) const {
  const Vector3 angular_momentum = inertia_of(pose_.orientation) * spin_rad_per_s_;
  return 0.5 * scale_ * mass_.mass_kg * velocity_m_per_s_.squaredNorm() +
         0.5 * spin_rad_per_s_.dot(angular_momentum) - mass_.mass_kg * gravity_m_per_s2.dot(centre_m());
}

void RigidDynamics::place(const Pose& pose) {
  pose_ = pose;
  set_velocity(Vector3::Zero(), Vector3::Zero());
  hand_impulse_ns_.setZero();
}

void RigidDynamics::set_velocity(const Vector3& velocity_m_per_s, const Vector3& spin_rad_per_s) {
  velocity_m_per_s_ = velocity_m_per_s;
  spin_rad_per_s_ = spin_rad_per_s;
}

void RigidDynamics::set_inertia_scale(double scale) {
  SPOONBILL_ASSERT(scale >= 1.0);
  scale_ = scale;
  double radius_square = 0.0;
  for (const Vector3& node : nodes_m_)
    radius_square = std::max(radius_square, (node - mass_.centre_m).squaredNorm());
  largest_inertia_kg_m2_ = scale_ * largest_eigenvalue(mass_.inertia_kg_m2);
  largest_per_kg_ = (1.0 / mass_.mass_kg + radius_square * largest_eigenvalue(inverse_inertia_)) / scale_;
}

void RigidDynamics::scale_mass(double factor) {
  SPOONBILL_ASSERT(factor > 0.0);
  mass_.mass_kg *= factor;
  mass_.inertia_kg_m2 *= factor;
  inverse_inertia_ /= factor;
  set_inertia_scale(scale_);
}

Matrix3 RigidDynamics::inertia_of(const Quaternion& orientation) const {
  const Matrix3 turn = orientation.toRotationMatrix();
  return scale_ * (turn * mass_.inertia_kg_m2 * turn.transpose());
}

Vector3 RigidDynamics::spin_of(const Quaternion& orientation, const Vector3& angular_momentum) const {
  return orientation * (inverse_inertia_ * (orientation.conjugate() * angular_momentum)) / scale_;
}

void RigidDynamics::kick(double h_s, const Vector3& gravity_m_per_s2, double drag_per_s,
                         const HandSpring* hand, const HoldTarget& target) {
  SPOONBILL_ASSERT_DEBUG(h_s > 0.0);
  const double inertial_kg = scale_ * mass_.mass_kg;
  const Vector3 weight_n = mass_.mass_kg * gravity_m_per_s2;
  if (hand == nullptr) {
    const double decay = 1.0 / (1.0 + h_s * drag_per_s);
    velocity_m_per_s_ = decay * velocity_m_per_s_ + h_s / inertial_kg * weight_n;
    spin_rad_per_s_ *= decay;
    inverse_mass_per_kg_ = 1.0 / inertial_kg;
    turn_response_ = inertia_of(pose_.orientation).inverse();
    return;
  }
  // With a stiffness k and critical damping c, the end velocity v' of a substep obeys
  // m v' = m v + h (m g + k (x_t + h v_t - x - h v') + c (v_t - v')); rotations likewise.
  const double k = hand->stiffness_n_per_m, c = 2.0 * std::sqrt(k * inertial_kg);
  const Vector3 stretch_m = target.pose.position_m + target.pose.orientation * mass_.centre_m - centre_m();
  const double response_kg = inertial_kg + h_s * c + h_s * h_s * k;
  const Vector3 pull_n = k * (stretch_m + h_s * target.velocity_m_per_s) + c * target.velocity_m_per_s;
  const Vector3 before = velocity_m_per_s_;
  velocity_m_per_s_ = (inertial_kg * before + h_s * (weight_n + pull_n)) / response_kg;
  hand_impulse_ns_ += inertial_kg * (velocity_m_per_s_ - before) - h_s * weight_n;
  inverse_mass_per_kg_ = 1.0 / response_kg;

  const Matrix3 inertia = inertia_of(pose_.orientation);
  // With one damping for all axes, turns about that of the largest inertia are critically damped.
  const double turn_k = hand->turn_stiffness_nm_per_rad;
  const double turn_c = 2.0 * std::sqrt(turn_k * largest_inertia_kg_m2_);
  const Matrix3 response = inertia + (h_s * turn_c + h_s * h_s * turn_k) * Matrix3::Identity();
  turn_response_ = response.inverse();
  const Vector3 turn = turn_between(pose_.orientation, target.pose.orientation);
  const Vector3 torque_nm = turn_k * (turn + h_s * target.spin_rad_per_s) + turn_c * target.spin_rad_per_s;
  spin_rad_per_s_ = turn_response_ * (inertia * spin_rad_per_s_ + h_s * torque_nm);
}

void RigidDynamics::push(const Vector3& arm_m, const Vector3& impulse_ns) {
  velocity_m_per_s_ += inverse_mass_per_kg_ * impulse_ns;
  hand_impulse_ns_ -= (1.0 - scale_ * mass_.mass_kg * inverse_mass_per_kg_) * impulse_ns;
  spin_rad_per_s_ += turn_response_ * arm_m.cross(impulse_ns);
}

void RigidDynamics::shift(const LatticeView& view, const Vector3& arm_m, const Vector3& impulse_ns,
                          double time_s) {
  const Vector3 centre = centre_m() + time_s * inverse_mass_per_kg_ * impulse_ns;
  const Vector3 turn = time_s * (turn_response_ * arm_m.cross(impulse_ns));
  move_centre_to(centre, rotation_about(turn) * pose_.orientation);
  place_nodes(view);
}

void RigidDynamics::drift(const LatticeView& view, double h_s) {
  const Vector3 momentum = inertia_of(pose_.orientation) * spin_rad_per_s_;
  const Quaternion halfway = rotation_about(0.5 * h_s * spin_rad_per_s_) * pose_.orientation;
  const Quaternion end = rotation_about(h_s * spin_of(halfway, momentum)) * pose_.orientation;
  move_centre_to(centre_m() + h_s * velocity_m_per_s_, end);
  spin_rad_per_s_ = spin_of(pose_.orientation, momentum);
  place_nodes(view);
}

double RigidDynamics::compliance(const Vector3& arm_m, const Vector3& direction) const {
  const Vector3 arm = arm_m.cross(direction);
  return inverse_mass_per_kg_ + arm.dot(turn_response_ * arm);
}

double RigidDynamics::any_compliance(const Vector3& arm_m) const {
  Matrix3 cross;
  cross << 0.0, -arm_m.z(), arm_m.y(), arm_m.z(), 0.0, -arm_m.x(), -arm_m.y(), arm_m.x(), 0.0;
  return inverse_mass_per_kg_ + (cross.transpose() * turn_response_ * cross).norm();
}

double RigidDynamics::slide_compliance(const Vector3& arm_m, const Vector3& normal) const {
  const Vector3 first = normal.unitOrthogonal(), second = normal.cross(first);
  const Vector3 one = arm_m.cross(first), other = arm_m.cross(second);
  const double a = one.dot(turn_response_ * one), c = other.dot(turn_response_ * other);
  const double b = one.dot(turn_response_ * other);
  return inverse_mass_per_kg_ + 0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b);
}

void RigidDynamics::move_centre_to(const Vector3& centre, const Quaternion& orientation) {
  pose_.orientation = orientation.normalized();
  pose_.position_m = centre - pose_.orientation * mass_.centre_m;
}

void RigidDynamics::place_nodes(const LatticeView& view) {
  turn_ = pose_.orientation.toRotationMatrix();
  for (std::size_t n = 0; n < nodes_m_.size(); ++n) {
    offsets_m_[n] = arm_m(nodes_m_[n]);
    set_node_displacement(view, static_cast<int>(n), displacement_m(nodes_m_[n]), 0.0f);
    spoonbill::set_velocity(view, static_cast<int>(n), velocity_m_per_s(offsets_m_[n]));
  }
}

}  // namespace spoonbill
