#include "haptic/tick.h"

#include <algorithm>

#include "engine/base/processor.h"

namespace spoonbill {
namespace {

// Weight of the new force in the low pass. 0.5 gives a cut-off of about 110 Hz, above the motion of a hand
// and below the jitter of nodes that gain and lose contact.
constexpr double force_filter_weight = 0.5;

// Delay of the force, in seconds: the delay of the filter plus half of the tick during which the force is
// constant.
constexpr double force_lag_s = ((1.0 - force_filter_weight) / force_filter_weight + 0.5) * tick_s;

// Factor by which the damping exceeds the smallest damping that keeps the coupling passive.
constexpr double damping_reserve = 2.0;

// Force scale below which no force reaches the hand, and the hand moves the tool rigidly.
constexpr double minimum_force_scale = 1e-9;

// Returns the force of the damped spring along the displacement to the proxy. The force never pushes away
// from the proxy, so that nothing sticks.
Vector3 damped_spring(const DeviceSpecification& specification, const Vector3& displacement_m,
                      const Vector3& velocity_m_per_s) {
  const double length_m = displacement_m.norm();
  if (!(length_m > 0.0)) return Vector3::Zero();
  const double stiffness = specification.maximum_stiffness_n_per_m;
  const double damping =
      std::min(specification.maximum_damping_n_s_per_m, damping_reserve * stiffness * force_lag_s);
  const Vector3 direction = displacement_m / length_m;
  const double force_n = stiffness * length_m - damping * velocity_m_per_s.dot(direction);
  return std::max(0.0, force_n) * direction;
}

}  // namespace

TickResult couple(CouplingState& coupling, const DeviceSpecification& specification,
                  const Vector3& position_m, const Vector3& displacement_m, std::uint32_t missed) {
  const double elapsed_s = (1.0 + missed) * tick_s;
  Vector3 velocity_m_per_s = Vector3::Zero();
  if (coupling.position_known) velocity_m_per_s = (position_m - coupling.position_m) / elapsed_s;
  coupling.position_m = position_m;
  coupling.position_known = true;

  TickResult result;
  Vector3 requested_n = damped_spring(specification, displacement_m, velocity_m_per_s);
  const double norm = requested_n.norm();
  if (norm > specification.maximum_force_n) {
    requested_n *= specification.maximum_force_n / norm;
    result.flags |= tick_flag_force_limited;
  }
  coupling.force_n += force_filter_weight * (requested_n - coupling.force_n);
  if (!coupling.force_n.allFinite()) coupling.force_n.setZero();
  result.force_n = coupling.force_n;
  return result;
}

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading) {
  const DenormalsFlushed flushed;  // decaying forces must be the same on every thread
  const double stiffness = specification.maximum_stiffness_n_per_m;
  const double scale = simulation.scene().sculpting.force_scale;
  ToolInput input;
  input.pose = reading.pose();
  input.gripping = (reading.buttons & button_main) != 0;
  input.hovering = (reading.buttons & button_hover) != 0;
  input.coupling_n_per_m = scale > minimum_force_scale ? stiffness / scale : 0.0;
  const Reaction reaction = simulation.advance(input);

  Vector3 displacement_m = Vector3::Zero();
  if (reaction.touching) displacement_m = reaction.proxy.position_m - input.pose.position_m;
  TickResult result = couple(coupling, specification, input.pose.position_m, displacement_m, reading.missed);
  result.flags |= reaction.flags;
  result.touching = reaction.touching || reaction.mirror_touching;
  return result;
}

void add_to_hash(const CouplingState& coupling, StateHash& hash) {
  for (const Vector3& vector : {coupling.force_n, coupling.position_m}) {
    for (int axis = 0; axis < 3; ++axis) hash.add(vector[axis]);
  }
}

}  // namespace spoonbill
