// A training session in the simulation: a modelled hand carries the spoon where the device asks it to.
#pragma once

#include <cstdint>

#include "app/training/hand_filter.h"
#include "app/training/spoon_hold.h"
#include "app/training/training_scene.h"
#include "engine/base/result.h"
#include "engine/simulation/simulation.h"
#include "haptic/device.h"
#include "haptic/tick.h"

namespace spoonbill {

// Has the owner of the simulation. tick() depends only on its arguments and the state of this object. It does
// not allocate, lock, read a clock or throw.
//
// The pose of a reading is that in which the person wants the bowl: the position of the rim's centre, and the
// turn of the spoon since the start, when the bowl was level. The hand follows at the grip: it is slower,
// stops at the ends of its wrist's range and trembles as its model says. The device feels the spring between
// the place of the bowl and the place where it is wanted, so that one feels what the hand cannot do.
class Training {
 public:
  Training(const TrainingScene& scene, const HandModel& hand, const Vector3& elbow_m, std::uint32_t seed);

  // Lowers the food onto the spoon and lets it settle. Allocates. Fails if the simulation cannot hold a body,
  // and if the spoon does not bear the food.
  static Status lay_food(Simulation& simulation);

  TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                  const DeviceReading& reading);

  // Facts of the last tick.
  const WristAngles& wrist_angles() const { return filter_.wrist_angles(); }
  const SpoonHold& hold() const { return hold_; }
  const Pose& wanted_bowl() const { return wanted_; }
  // Time since the first tick, s.
  double time_s() const { return static_cast<double>(ticks_) * tick_s; }

 private:
  // The hand takes over the spoon, which has been held still, in this time.
  static constexpr int start_ticks = 500;

  Pose find_hand(const Pose& bowl) const;

  HeldSpoon spoon_;
  HandFilter filter_;
  SpoonHold hold_;
  Pose start_;  // of the hand
  Pose wanted_;
  std::uint64_t ticks_ = 0;
};

}  // namespace spoonbill
