#include "app/training/training.h"

#include "engine/simulation/rigid_body.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

constexpr double longest_settling_s = 1.5;

}  // namespace

Training::Training(const TrainingScene& scene, const HandModel& hand, const Vector3& elbow_m,
                   std::uint32_t seed)
    : spoon_(scene.spoon),
      filter_(hand, elbow_m, {scene.spoon.grip_m, scene.spoon.handle}, seed),
      hold_(scene.spoon, hand.grip),
      start_{scene.spoon.grip_m, scene.spoon.handle} {}

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
  return {bowl.position_m + bowl.orientation * spoon_.grip_m, bowl.orientation * spoon_.handle};
}

TickResult Training::tick(Simulation& simulation, CouplingState& coupling,
                          const DeviceSpecification& specification, const DeviceReading& reading) {
  wanted_ = reading.pose();
  Pose hand = filter_.step(find_hand(wanted_));
  ++ticks_;
  if (ticks_ < start_ticks) {
    const double t = static_cast<double>(ticks_) / start_ticks;
    hand = find_pose_between(start_, hand, t * t * (3.0 - 2.0 * t));
  }
  ToolInput input = trial_input();
  input.carried = hold_.carry(hand);
  const Reaction reaction = simulation.advance(input);
  hold_.follow(simulation);
  const Vector3 bowl_m = simulation.rigid_dynamics(spoon_.body)->pose().position_m;
  TickResult result =
      couple(coupling, specification, wanted_.position_m, bowl_m - wanted_.position_m, reading.missed);
  result.flags |= reaction.flags;
  return result;
}

}  // namespace spoonbill
