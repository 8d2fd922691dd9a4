// How lattice nodes move, one part of the lattice's kernels: functions of each instruction set's own
// namespace, for lattice_kernels.cpp alone. Uses no standard library, as engine/bspline/evaluate_kernels.h
// explains. Each function is described where LatticeKernels names it.
#pragma once

#include "engine/material/springs/lattice_kernels.h"

#ifndef SPOONBILL_KERNELS
#define SPOONBILL_KERNELS kernels_baseline
#endif

namespace spoonbill::SPOONBILL_KERNELS {

// Adds up a field on the nodes over each of a seam's pairs.
void join_seam(const LatticeView& view, float* of);
void join_seam_forces(const LatticeView& view);

void look_ahead(const LatticeView& view, float tau_s);
void kick(const LatticeView& view, float h_s, float decay, float gx, float gy, float gz);
Drifted drift(const LatticeView& view, const Drift& drift);
void momentum(const LatticeView& view, const float* mass, float sum[4]);

}  // namespace spoonbill::SPOONBILL_KERNELS
