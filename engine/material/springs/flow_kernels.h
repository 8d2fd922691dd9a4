// How rest lengths flow and creep, one part of the lattice's kernels: functions of each instruction set's own
// namespace, for lattice_kernels.cpp alone. Uses no standard library, as engine/bspline/evaluate_kernels.h
// explains. Each function is described where LatticeKernels names it.
#pragma once

#include "engine/material/springs/lattice_kernels.h"

#ifndef SPOONBILL_KERNELS
#define SPOONBILL_KERNELS kernels_baseline
#endif

namespace spoonbill::SPOONBILL_KERNELS {

void flow(const LatticeView& view, const FlowRule& rule);
void creep(const LatticeView& view, int direction, const CreepRule& rule);

}  // namespace spoonbill::SPOONBILL_KERNELS
