// A training session in the simulation: a modelled hand carries the spoon, or moves the finger, where the
// device asks it to.
#pragma once

#include <cstdint>
#include <optional>

#include "app/training/guidance.h"
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
// With a spoon, the pose of a reading is that in which the person wants the bowl: the position of the rim's
// centre, and the turn of the spoon since the start, when the bowl was level. The hand follows at the grip:
// it is slower, stops at the ends of its wrist's range and trembles as its model says. The device feels the
// spring between the place of the bowl and the place where it is wanted, so that one feels what the hand
// cannot do, and the guidance. It does not feel the weight that the hand bears at the start, because a
// device gets a force only after a quiet moment.
//
// In a palpation, the pose is that in which the person wants the finger. The device feels what the finger
// touches. The main button marks the place of the lump; it does not grip.
class Training {
 public:
  Training(const TrainingScene& scene, const HandModel& hand, const Vector3& elbow_m, std::uint32_t seed,
           Guidance guidance = {});

  // Lowers the food onto the spoon and lets it settle. Allocates. Fails if the simulation cannot hold a body,
  // and if the spoon does not bear the food.
  static Status lay_food(Simulation& simulation);

  TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                  const DeviceReading& reading);

  // Facts of the last tick. hold() is null in a palpation.
  const WristAngles& wrist_angles() const { return filter_.wrist_angles(); }
  const SpoonHold* hold() const { return hold_ ? &*hold_ : nullptr; }
  // Returns the pose that the person wants of the bowl or the finger, and the one that the hand reaches.
  const Pose& wanted() const { return wanted_; }
  const Pose& reached() const { return reached_; }
  // Returns true if the person marks the place of the lump while the finger touches the block.
  bool is_marking() const { return is_marking_; }
  // Time since the first tick, s.
  double time_s() const { return static_cast<double>(ticks_) * tick_s; }

 private:
  // The hand takes over the spoon, which has been held still, in this time.
  static constexpr int start_ticks = 500;

  TickResult carry(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                   const DeviceReading& reading);
  TickResult touch(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                   const DeviceReading& reading);
  Pose find_hand(const Pose& bowl) const;

  std::optional<HeldSpoon> spoon_;
  std::optional<SpoonHold> hold_;
  HandFilter filter_;
  Guidance guidance_;
  Pose start_;  // of the hand
  Pose wanted_, reached_;
  Vector3 rest_lag_m_ = Vector3::Zero();  // of the bowl behind the hand at the start, under its weight
  bool is_marking_ = false;
  std::uint64_t ticks_ = 0;
};

}  // namespace spoonbill
