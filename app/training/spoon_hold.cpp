#include "app/training/spoon_hold.h"

#include <algorithm>
#include <cmath>

#include "app/training/exact_angles.h"
#include "engine/base/assert.h"

namespace spoonbill {

double GripTorque::used() const {
  const double across = held_across_nm > 0.0 ? across_nm / held_across_nm : 0.0;
  const double about = held_about_nm > 0.0 ? about_nm / held_about_nm : 0.0;
  return std::max(across, about);
}

SpoonHold::SpoonHold(const HeldSpoon& spoon, const std::optional<GripModel>& grip) : spoon_(spoon) {
  if (!grip) return;
  torque_.held_across_nm = held_across_nm(*grip);
  torque_.held_about_nm = held_about_nm(*grip, spoon.handle_width_m);
}

CarriedBody SpoonHold::carry(const Pose& hand) {
  carried_ = (hand.orientation * slip_ * spoon_.handle.conjugate()).normalized();
  carried_at_m_ = hand.position_m - carried_ * spoon_.grip_m;
  return {spoon_.body, {carried_at_m_, carried_}};
}

void SpoonHold::follow(const Simulation& simulation) {
  const RigidDynamics* const dynamics = simulation.rigid_dynamics(spoon_.body);
  SPOONBILL_ASSERT(dynamics != nullptr);
  const Pose& pose = dynamics->pose();
  // The spring acts at the centre of mass. Its damper is left out: it would jerk the spoon as the hand gives
  // way.
  const Vector3 held_centre_m = carried_at_m_ + carried_ * dynamics->mass().centre_m;
  const Vector3 force_n = spoon_.spring.stiffness_n_per_m * (held_centre_m - dynamics->centre_m());
  const Vector3 arm_m = dynamics->centre_m() - (pose.position_m + pose.orientation * spoon_.grip_m);
  const Vector3 lag_rad = rotation_vector(carried_ * pose.orientation.conjugate());
  const Quaternion handle = carried_ * spoon_.handle;
  const Vector3 torque_nm =
      handle.conjugate() * (spoon_.spring.turn_stiffness_nm_per_rad * lag_rad + arm_m.cross(force_n));
  const Vector3 across_nm(0.0, torque_nm.y(), torque_nm.z());
  torque_.about_nm = std::abs(torque_nm.x());
  torque_.across_nm = across_nm.norm();
  // A turn of the hold by 1 rad changes the torque by at most this.
  const double stiffness_nm_per_rad =
      spoon_.spring.turn_stiffness_nm_per_rad + spoon_.spring.stiffness_n_per_m * arm_m.squaredNorm();
  Vector3 turn_rad = Vector3::Zero();
  const auto give_way = [&](const Vector3& part_nm, double size_nm, double held_nm) {
    if (held_nm <= 0.0 || size_nm <= held_nm) return;
    turn_rad -= (size_nm - held_nm) / (size_nm * stiffness_nm_per_rad) * part_nm;
  };
  give_way(Vector3(torque_nm.x(), 0.0, 0.0), torque_.about_nm, torque_.held_about_nm);
  give_way(across_nm, torque_.across_nm, torque_.held_across_nm);
  // A spoon that is held back far from the hand has a torque by which it would turn round at once.
  constexpr double largest_turn_rad = 0.1;
  if (const double angle = turn_rad.norm(); angle > largest_turn_rad) turn_rad *= largest_turn_rad / angle;
  if (!turn_rad.isZero(0.0)) slip_ = (slip_ * turn_by(turn_rad)).normalized();
}

double SpoonHold::turned_rad() const {
  return rotation_vector(slip_).norm();
}

}  // namespace spoonbill
