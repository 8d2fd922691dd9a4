// One tick of touch: takes a device reading, advances the simulation and computes the force.
//
// tick() depends only on its arguments, and does not allocate, lock, read a clock or throw. The 1 kHz thread
// and a replay call the same code and get the same bits.
#pragma once

#include <cstdint>

#include "engine/simulation/simulation.h"
#include "haptic/device.h"
#include "haptic/tick_history.h"

namespace spoonbill {

// State of the virtual coupling: a critically damped spring, as stiff as the device permits, between the
// device and the proxy. The proxy is the position of the tool that the material permits (after Ruspini et al.
// 1997). The force of the spring goes to the hand, damped, filtered and limited. The opposite of the spring's
// force, divided by the force scale, presses the tool on the material.
//
// The force is late, because it is filtered and constant for a tick. With a delay t, a spring of stiffness K
// returns more energy than it received, as if it had the negative damping -K t (Colgate and Brown 1994, for t
// of half a tick). The hand is therefore damped along the spring by 2 K t, but at most by the maximum damping
// of the device.
//
// A force that is held for several ticks is even later. The stiffness is therefore scaled by 1 ms divided by
// the longest hold of the last 100 ms. A spring that becomes stiffer under load would give energy to the
// hand. Under load, the stiffness therefore recovers only until this energy equals the energy that the
// reduction has withheld; the rest recovers once the tool is free.
//
// Plain data. The ticking thread owns it together with the simulation.
struct CouplingState {
  Vector3 force_n = Vector3::Zero();  // force on the hand
  Vector3 position_m = Vector3::Zero();
  bool position_known = false;
  TickHistory ticks;
  double stiffness_scale = 1.0;
  double length_m = 0.0;    // distance to the proxy in the last tick
  double withheld_j = 0.0;  // energy that the reduction of the stiffness has withheld from the hand
};

struct TickResult {
  Vector3 force_n = Vector3::Zero();  // force on the hand, within the limit of the specification
  bool touching = false;
  std::uint32_t flags = 0;  // TickFlag bits
};

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading);

// Computes the force of the coupling without advancing a simulation. `displacement_m` is the vector from the
// device to the proxy, zero without contact; `missed` is DeviceReading::missed.
TickResult couple(CouplingState& coupling, const DeviceSpecification& specification,
                  const Vector3& position_m, const Vector3& displacement_m, std::uint32_t missed = 0);

// Adds the coupling to the state hash. `ticks` and the members after it are added only if a tick was missed
// in the last 110 ms or the stiffness is still reduced.
void add_to_hash(const CouplingState& coupling, StateHash& hash);

}  // namespace spoonbill
