#include "app/training/training.h"

#include <algorithm>
#include <utility>

#include "engine/simulation/rigid_body.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

constexpr double longest_settling_s = 1.5;

// Returns the pose of the hand before the first tick.
Pose find_start(const TrainingScene& scene) {
  if (scene.spoon) return {scene.spoon->grip_m, scene.spoon->handle};
  return {scene.start_m, Quaternion::Identity()};
}

}  // namespace

Training::Training(const TrainingScene& scene, const HandModel& hand, const Vector3& elbow_m,
                   std::uint32_t seed, Guidance guidance)
    : spoon_(scene.spoon),
      filter_(hand, elbow_m, find_start(scene), seed),
      guidance_(std::move(guidance)),
      start_(find_start(scene)) {
  wanted_.position_m = scene.start_m;
  reached_ = wanted_;
  if (spoon_) hold_.emplace(*spoon_, hand.grip);
}

Status Training::lay_food(Simulation& simulation) {
  TrialSettings settings;
  settings.longest_settling_s = longest_settling_s;
  Trial trial(simulation.scene(), settings);
  while (trial.phase() <= TrialPhase::settling) {
    while (const std::optional<Command> command = trial.next_command()) {
      if (Status applied = simulation.apply(*command); !applied) return applied;
    }
    const Reaction reaction = simulation.advance(trial_input());
    if (Status held = trial.follow(simulation, reaction.flags); !held) return held;
  }
  return {};
}

Pose Training::find_hand(const Pose& bowl) const {
  return {bowl.position_m + bowl.orientation * spoon_->grip_m, bowl.orientation * spoon_->handle};
}

TickResult Training::tick(Simulation& simulation, CouplingState& coupling,
                          const DeviceSpecification& specification, const DeviceReading& reading) {
  wanted_ = reading.pose();
  ++ticks_;
  return spoon_ ? carry(simulation, coupling, specification, reading)
                : touch(simulation, coupling, specification, reading);
}

TickResult Training::carry(Simulation& simulation, CouplingState& coupling,
                           const DeviceSpecification& specification, const DeviceReading& reading) {
  Pose hand = filter_.step(find_hand(wanted_));
  if (ticks_ < start_ticks) {
    const double t = static_cast<double>(ticks_) / start_ticks;
    hand = find_pose_between(start_, hand, t * t * (3.0 - 2.0 * t));
  }
  ToolInput input = trial_input();
  input.carried = hold_->carry(hand);
  const Reaction reaction = simulation.advance(input);
  hold_->follow(simulation);
  reached_ = simulation.rigid_dynamics(spoon_->body)->pose();
  if (ticks_ == 1) rest_lag_m_ = reached_.position_m;
  // A force of the coupling's spring, so that the guidance gets its filter, its damping and its limit.
  const Vector3 guided_m =
      guidance_.force_n(wanted_.position_m) / std::max(specification.maximum_stiffness_n_per_m, 1e-3);
  TickResult result =
      couple(coupling, specification, wanted_.position_m,
             reached_.position_m - rest_lag_m_ - wanted_.position_m + guided_m, reading.missed);
  result.flags |= reaction.flags;
  return result;
}

TickResult Training::touch(Simulation& simulation, CouplingState& coupling,
                           const DeviceSpecification& specification, const DeviceReading& reading) {
  reached_ = filter_.step(wanted_);
  DeviceReading felt = DeviceReading::from(reached_, reading.buttons & ~button_main);
  felt.missed = reading.missed;
  TickResult result = spoonbill::tick(simulation, coupling, specification, felt);
  is_marking_ = result.touching && (reading.buttons & button_main) != 0;
  return result;
}

}  // namespace spoonbill
