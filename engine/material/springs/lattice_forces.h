// Forces on the nodes of a lattice in the substeps of a tick: springs, volumes, further damping, loads and
// weight. Called by the thread that runs the tick; allocates nothing.
#pragma once

#include "engine/base/geometry.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Longest motion of a node since the linearisation, in cells, before the springs are linearised again within
// the tick. The linearised strain of a spring has an error of about half the square of the angle by which the
// spring has rotated since. Its force then does work that its energy does not account for: with ten times
// this limit, an undamped ball that is thrown against another one gains energy without end.
inline constexpr double linear_cells = 0.01;

// The last linearisation of a lattice's springs in a tick.
struct LinearisedSprings {
  Linearised stored = Linearised::tangents;
  int age_substeps = 0;  // number of substeps that have used it
};

// linearise() linearises the springs, and returns what it stored. linearise_and_follow() also performs one
// step of the power iteration that tracks the fastest frequency as the lattice deforms.
LinearisedSprings linearise(const SpringLattice& lattice, const LatticeView& view, Linearised stored);
LinearisedSprings linearise_and_follow(SpringLattice& lattice, const LatticeView& view, Linearised stored);

// Computes all forces on the nodes in a substep. `moved_square` is the largest squared change of an
// extrapolated node displacement since the linearisation; if it is too large, the springs are linearised
// again.
void compute_forces(const SpringLattice& lattice, const LatticeView& view, float moved_square,
                    const Vector3& gravity_m_per_s2, LinearisedSprings& springs);

}  // namespace spoonbill
