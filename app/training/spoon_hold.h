// How a hand holds a spoon: where, with which torque, and how the spoon turns in a hand that is too weak for
// it.
#pragma once

#include <optional>

#include "app/training/hand_model.h"
#include "engine/scene/body.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// The spoon of a simulation and the place at which the hand holds it. Plain data; positions are of the spoon
// at rest.
struct HeldSpoon {
  int body = 0;                                // index in the scene
  Vector3 grip_m = Vector3::Zero();            // on the axis of the handle
  Quaternion handle = Quaternion::Identity();  // its x axis is along the handle, its y axis up
  double handle_width_m = 0.01;                // at the grip, across the handle
  HandSpring spring;
};

// The torque of the hand's spring on the spoon about the grip, and what the grip holds.
struct GripTorque {
  double across_nm = 0.0, about_nm = 0.0;            // across and about the handle
  double held_across_nm = 0.0, held_about_nm = 0.0;  // 0 if the grip has no limit

  // Returns the larger of the two torques as a part of what the grip holds; 0 without a limit.
  double used() const;
};

// One owner, the thread that ticks; allocates nothing. In each tick: hold.carry(hand), then the tick, then
// hold.follow(simulation).
class SpoonHold {
 public:
  SpoonHold(const HeldSpoon& spoon, const std::optional<GripModel>& grip);

  // Returns where the hand carries the spoon. `hand` is the grip's position and the hand's orientation, whose
  // x axis is along the handle while the spoon has not turned in the hand.
  CarriedBody carry(const Pose& hand);

  // Measures the torque of the tick. Where it is more than the grip holds, turns the spoon in the hand until
  // the spring that holds it gives way by as much.
  void follow(const Simulation& simulation);

  const GripTorque& torque() const { return torque_; }
  // Returns the angle by which the spoon has turned in the hand, rad.
  double turned_rad() const;

 private:
  HeldSpoon spoon_;
  Quaternion slip_ = Quaternion::Identity();     // of the spoon in the hand, in the frame of the handle
  Vector3 carried_at_m_ = Vector3::Zero();       // position to which the hand carries the spoon
  Quaternion carried_ = Quaternion::Identity();  // orientation of the spoon in which the hand holds it
  GripTorque torque_;
};

}  // namespace spoonbill
