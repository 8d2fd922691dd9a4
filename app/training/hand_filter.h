// A hand between the device and the spoon: changes the pose that a person asks for to the one that the
// modelled hand reaches.
#pragma once

#include <cstdint>
#include <optional>

#include "app/training/hand_model.h"
#include "engine/base/geometry.h"

namespace spoonbill {

// Filters the pose of a hand tick by tick: limits its speed, then the range of its wrist, and adds its
// tremor. One owner, the thread that ticks; step() allocates nothing and gives the same bits on every
// machine.
class HandFilter {
 public:
  // `start` is the pose of the hand before the first tick: its position and its orientation, whose x axis is
  // along the handle. The elbow does not move.
  HandFilter(const HandModel& model, const Vector3& elbow_m, const Pose& start, std::uint32_t seed);

  // Returns the pose of the hand in this tick, given the one that the person asks for.
  Pose step(const Pose& asked);

  // Returns the turns of the wrist in the last tick, without tremor.
  const WristAngles& wrist_angles() const { return angles_; }

 private:
  void limit_speed(const Pose& asked);
  Pose limit_wrist();

  std::optional<WristModel> wrist_;
  std::optional<HandSpeed> speed_;
  std::optional<Tremor> tremor_;
  Vector3 elbow_m_;
  Pose reached_;  // what the hand has reached of the asked pose, before the wrist's stops
  WristAngles angles_{};
};

}  // namespace spoonbill
