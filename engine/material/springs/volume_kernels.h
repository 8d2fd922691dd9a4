// The volume force of lattice cells, one part of the lattice's kernels: functions of each instruction set's
// own namespace, for lattice_kernels.cpp alone. Uses no standard library, as
// engine/bspline/evaluate_kernels.h explains.
#pragma once

#include "engine/material/springs/lattice_kernels.h"

#ifndef SPOONBILL_KERNELS
#define SPOONBILL_KERNELS kernels_baseline
#endif

namespace spoonbill::SPOONBILL_KERNELS {

// See LatticeKernels::volume_forces.
void volume_forces(const LatticeView& view);

// The cells' part of LatticeKernels::damp_further.
void damp_volume_further(const LatticeView& view);

// J of the cells around each node, averaged into node_dilation.
void average_dilations(const LatticeView& view);

// Adds each cell's share to the row sums, N/m.
void add_volume_row_sums(const LatticeView& view, float* sum_n_per_m);

// Takes the product of the volume stiffness, ahead in time, and the power vector from the forces.
void take_volume_stiffness(const LatticeView& view);

// See LatticeKernels::measure_rest_volumes.
void measure_rest_volumes(const LatticeView& view);

}  // namespace spoonbill::SPOONBILL_KERNELS
