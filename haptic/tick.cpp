#include "haptic/tick.h"

#include <algorithm>
#include <cmath>

#include "engine/base/processor.h"

namespace spoonbill {
namespace {

// Number of times per tick that the low-pass filter halves the weight of the old force. With one halving, the
// cut-off frequency is about 110 Hz, above the motion of a hand and below the jitter of nodes that gain and
// lose contact.
constexpr double filter_halvings = 1.0;

// Returns the filter weight of a new force that follows a force held for this many ticks.
double filter_weight(double hold_ticks) {
  return 1.0 - std::exp2(-hold_ticks * filter_halvings);
}

// Returns the delay of a force that is held for this many ticks, in seconds: the delay of the filter plus
// half of the hold.
double force_lag_s(double hold_ticks) {
  const double weight = filter_weight(hold_ticks);
  return ((1.0 - weight) / weight + 0.5) * (hold_ticks * tick_s);
}

// Factor by which the damping exceeds the smallest damping that keeps the coupling passive.
constexpr double damping_reserve = 2.0;

// At or below this force scale, the coupling is rigid and no force reaches the hand. If a body has an
// implicit solver, the engine uses a spring instead of the rigid coupling. The tool can then be away from the
// hand.
constexpr double minimum_force_scale = 1e-9;

// Sets the stiffness for a tick that follows `missed` missed ticks.
void scale_stiffness(CouplingState& coupling, const DeviceSpecification& specification,
                     std::uint32_t missed) {
  coupling.ticks.add(missed);
  const double allowed = 1.0 / static_cast<double>(coupling.ticks.find_longest_hold());
  const double full_j = 0.5 * specification.maximum_stiffness_n_per_m * coupling.length_m * coupling.length_m;
  const double change = allowed - coupling.stiffness_scale;
  if (full_j == 0.0) {
    coupling.stiffness_scale = allowed;
    coupling.withheld_j = 0.0;
  } else if (change <= 0.0) {
    coupling.stiffness_scale = allowed;
    coupling.withheld_j -= change * full_j;
  } else if (change * full_j <= coupling.withheld_j) {
    coupling.stiffness_scale = allowed;
    coupling.withheld_j = allowed < 1.0 ? coupling.withheld_j - change * full_j : 0.0;
  } else {
    coupling.stiffness_scale += coupling.withheld_j / full_j;
    coupling.withheld_j = 0.0;
  }
}

// Returns the force of the damped spring along the displacement to the proxy. The force never points away
// from the proxy, so the tool does not stick to the material.
Vector3 damped_spring(const CouplingState& coupling, const DeviceSpecification& specification,
                      const Vector3& displacement_m, const Vector3& velocity_m_per_s) {
  const double length_m = displacement_m.norm();
  if (!(length_m > 0.0)) return Vector3::Zero();
  const double stiffness = coupling.stiffness_scale * specification.maximum_stiffness_n_per_m;
  const double lag_s = force_lag_s(static_cast<double>(coupling.ticks.find_longest_hold()));
  const double damping =
      std::min(specification.maximum_damping_n_s_per_m, damping_reserve * stiffness * lag_s);
  const Vector3 direction = displacement_m / length_m;
  const double force_n = stiffness * length_m - damping * velocity_m_per_s.dot(direction);
  return std::max(0.0, force_n) * direction;
}

// Computes the force with the stiffness that scale_stiffness() has set.
TickResult compute_force(CouplingState& coupling, const DeviceSpecification& specification,
                         const Vector3& position_m, const Vector3& displacement_m, std::uint32_t missed) {
  const double elapsed_s = (1.0 + missed) * tick_s;
  Vector3 velocity_m_per_s = Vector3::Zero();
  if (coupling.position_known) velocity_m_per_s = (position_m - coupling.position_m) / elapsed_s;
  coupling.position_m = position_m;
  coupling.position_known = true;
  coupling.length_m = displacement_m.norm();

  TickResult result;
  Vector3 requested_n = damped_spring(coupling, specification, displacement_m, velocity_m_per_s);
  const double norm = requested_n.norm();
  if (norm > specification.maximum_force_n) {
    requested_n *= specification.maximum_force_n / norm;
    result.flags |= tick_flag_force_limited;
  }
  coupling.force_n += filter_weight(1.0 + missed) * (requested_n - coupling.force_n);
  if (!coupling.force_n.allFinite()) coupling.force_n.setZero();
  result.force_n = coupling.force_n;
  return result;
}

}  // namespace

TickResult couple(CouplingState& coupling, const DeviceSpecification& specification,
                  const Vector3& position_m, const Vector3& displacement_m, std::uint32_t missed) {
  scale_stiffness(coupling, specification, missed);
  return compute_force(coupling, specification, position_m, displacement_m, missed);
}

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading) {
  const DenormalsFlushed flushed;  // flushes denormals on any thread, so that all threads get the same forces
  scale_stiffness(coupling, specification, reading.missed);
  const double stiffness = coupling.stiffness_scale * specification.maximum_stiffness_n_per_m;
  const double scale = simulation.scene().sculpting.force_scale;
  ToolInput input;
  input.pose = reading.pose();
  input.gripping = (reading.buttons & button_main) != 0;
  input.hovering = (reading.buttons & button_hover) != 0;
  input.coupling_n_per_m = scale > minimum_force_scale ? stiffness / scale : 0.0;
  const Reaction reaction = simulation.advance(input);

  Vector3 displacement_m = Vector3::Zero();
  if (reaction.touching && scale > minimum_force_scale) {
    displacement_m = reaction.proxy.position_m - input.pose.position_m;
  }
  TickResult result =
      compute_force(coupling, specification, input.pose.position_m, displacement_m, reading.missed);
  result.flags |= reaction.flags;
  result.touching = reaction.touching || reaction.mirror_touching;
  return result;
}

void add_to_hash(const CouplingState& coupling, StateHash& hash) {
  for (const Vector3& vector : {coupling.force_n, coupling.position_m}) {
    for (int axis = 0; axis < 3; ++axis) hash.add(vector[axis]);
  }
  if (!coupling.ticks.has_missed() && coupling.stiffness_scale == 1.0) return;
  for (const double value : {coupling.stiffness_scale, coupling.length_m, coupling.withheld_j})
    hash.add(value);
  for (const std::uint64_t word : coupling.ticks.words()) hash.add(word);
}

}  // namespace spoonbill
