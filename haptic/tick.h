// One tick of touch: reading in, simulation advanced, force out. A pure function of its arguments: it
// allocates nothing, locks nothing, reads no clock and never throws, so that the 1 kHz thread and the
// lock-step replay call the same code and get the same bits.
#pragma once

#include <cstdint>

#include "engine/simulation/simulation.h"
#include "haptic/device.h"

namespace spoonbill {

// The virtual coupling: a critically damped spring of the device's highest stiffness joins the device and the
// proxy, the tool as the material lets it move (after the proxy of Ruspini et al. 1997). Its force goes to
// the hand, damped, filtered and limited; the spring's opposite, divided by the force scale, presses the tool
// on the material.
//
// The force comes late: it is held for a tick and filtered. Late by t, a spring K gives back more than it
// took, as if damped by -K t (Colgate & Brown 1994 for t = half a tick), so the hand is damped along the
// spring by twice that, and within the device's highest damping.
//
// Plain data, owned with the simulation by whoever ticks.
struct CouplingState {
  Vector3 force_n = Vector3::Zero();  // on the hand
  Vector3 position_m = Vector3::Zero();
  bool position_known = false;
};

struct TickResult {
  Vector3 force_n = Vector3::Zero();  // on the hand, within the specification's limit
  bool touching = false;
  std::uint32_t flags = 0;  // TickFlag bits
};

TickResult tick(Simulation& simulation, CouplingState& coupling, const DeviceSpecification& specification,
                const DeviceReading& reading);

// The coupling alone. `displacement_m` leads from the device to where something stops it, zero where nothing does.
TickResult couple(CouplingState& coupling, const DeviceSpecification& specification,
                  const Vector3& position_m, const Vector3& displacement_m);

// The coupling's part of the state hash.
void add_to_hash(const CouplingState& coupling, StateHash& hash);

}  // namespace spoonbill
