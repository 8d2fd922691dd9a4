// How supports move the nodes that they hold through the substeps of a tick, and what they bear.
#pragma once

#include <span>

#include "engine/material/springs/spring_lattice.h"
#include "engine/material/supports/supported_nodes.h"

namespace spoonbill {

// Shortens the ways of supports that would outrun the lattice: `reach_m` is how far a node may go beside
// another in the tick. Where one support has all held nodes, the whole lattice rides with it; then it may go
// twice as far as its motion ever does, so that it comes back from where an undone stroke left it. Returns
// whether any way was shortened.
bool limit_ways(std::span<SupportedNodes> supports, const SpringLattice& lattice, double reach_m);

// The velocity of the support that the lattice rides with; zero of all others.
Vector3 riding_velocity(std::span<const SupportedNodes> supports, const SpringLattice& lattice,
                        double time_s);

// After the kick, which stops held nodes: their velocities.
void hand_to_supports(std::span<const SupportedNodes> supports, const LatticeView& view, double time_s);

// Adds what the supports bear through a substep of h_s, with the forces just taken.
void bear(std::span<SupportedNodes> supports, const SpringLattice& lattice, const LatticeView& view,
          const Vector3& gravity_m_per_s2, double h_s);

// After the drift: places the nodes at this share of the way. Returns the largest square of what one has
// moved since the springs were linearised.
float place_supported(std::span<const SupportedNodes> supports, const LatticeView& view, double share,
                      float damping_time_s);

}  // namespace spoonbill
