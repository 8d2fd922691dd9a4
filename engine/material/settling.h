// Damping that brings bodies to rest soonest, for sculpting without ringing.
#pragma once

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Of the critical damping of the motion that a body is in: a little more than 1, so that what else it holds
// does not carry it past its rest.
inline constexpr double settling_ratio = 1.1;

// The mass-proportional damping, 1/s, that does so for a motion v whose Rayleigh quotient (v.Kv) / (v.Mv),
// the square of a frequency, is this. As dynamic relaxation adapts its damping (Underwood 1983): fast modes
// die first, then the slow ones get the little that is critical for them.
double settling_damping_per_s(double rayleigh_quotient);

// The quotient of a lattice's velocities; 0 at rest. Its springs must be linearised, and `moved` of the view
// not in use: it is working memory here.
double rayleigh_quotient(const SpringLattice& lattice, const LatticeView& view);

}  // namespace spoonbill
