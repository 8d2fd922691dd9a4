#include "haptic/tick.h"

#include "engine/denormals.h"

namespace spoonbill {
namespace {

// The share of the way to the newly computed force that one tick takes: a low pass at about 60 Hz, above what
// a hand moves and below the jitter of nodes that come and go.
constexpr double force_filter_share = 0.3;

// Below this a scaled force is none, and the hand holds the tool rigidly.
constexpr double least_force_scale = 1e-9;

}  // namespace

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading) {
  const DenormalsFlushed flushed;  // the fading force too must be the same on every thread
  const double stiffness = specification.maximum_stiffness_n_per_m;
  const double scale = simulation.scene().sculpting.force_scale;
  ToolInput input;
  input.pose = reading.pose();
  input.gripping = (reading.buttons & button_main) != 0;
  input.coupling_n_per_m = scale > least_force_scale ? stiffness / scale : 0.0;
  const Reaction reaction = simulation.advance(input);

  TickResult result;
  result.flags = reaction.flags;
  result.touching = reaction.touching || reaction.mirror_touching;
  Vector3 wanted = Vector3::Zero();
  if (reaction.touching) wanted = stiffness * (reaction.proxy.position_m - input.pose.position_m);
  const double norm = wanted.norm();
  if (norm > specification.maximum_force_n) {
    wanted *= specification.maximum_force_n / norm;
    result.flags |= tick_flag_force_limited;
  }
  coupling.force_n += force_filter_share * (wanted - coupling.force_n);
  if (!coupling.force_n.allFinite()) coupling.force_n.setZero();
  result.force_n = coupling.force_n;
  return result;
}

void add_to_hash(const CouplingState& coupling, StateHash& hash) {
  for (int axis = 0; axis < 3; ++axis) hash.add(coupling.force_n[axis]);
}

}  // namespace spoonbill
