#include "haptic/tick.h"

#include <algorithm>

namespace spoonbill {
namespace {

// The share of the way to the newly computed force that one tick takes: a low pass at about 17 Hz. Contact forces
// jitter by up to a fifth from tick to tick as nodes come and go.
constexpr double force_filter_share = 0.1;

Vector3 limited(const Vector3& force, double limit, bool& met) {
  const double norm = force.norm();
  met = norm > limit;
  return met ? Vector3(force * (limit / norm)) : force;
}

// Where nothing gives way, the force that takes the device's own depth: the proxy's, and what the force already holds
// off.
Vector3 blocking_force(const Reaction& reaction, const Vector3& force, double stiffness) {
  if (reaction.blocked_depth_m <= 0.0) return Vector3::Zero();
  const Vector3& n = reaction.blocked_normal;
  return std::max(0.0, stiffness * reaction.blocked_depth_m + force.dot(n)) * n;
}

}  // namespace

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading) {
  const Pose device = reading.pose();
  const double stiffness = specification.maximum_stiffness_n_per_m;
  coupling.proxy.position_m = device.position_m + coupling.force_n / stiffness;
  coupling.proxy.orientation = device.orientation;
  const Reaction reaction = simulation.advance(coupling.proxy, (reading.buttons & button_main) != 0);

  TickResult result;
  result.flags = reaction.flags;
  result.touching = reaction.touching;
  const Vector3 contact = simulation.scene().sculpting.force_scale * reaction.force_n;
  bool met = false;
  const Vector3 wanted =
      limited(contact + blocking_force(reaction, coupling.force_n, stiffness), specification.maximum_force_n, met);
  coupling.force_n += force_filter_share * (wanted - coupling.force_n);
  if (!coupling.force_n.allFinite()) coupling.force_n.setZero();
  if (met) result.flags |= tick_flag_force_limited;
  result.force_n = coupling.force_n;
  return result;
}

void add_to_hash(const CouplingState& coupling, StateHash& hash) {
  for (int axis = 0; axis < 3; ++axis) hash.add(coupling.force_n[axis]);
}

}  // namespace spoonbill
