// The cells of an implicit body, eight side by side, in the loops of a tick: corotated hexahedra, as
// engine/material/cells/corotated_cell.h derives them. Compiled once for each instruction set, with the same
// bits. Uses no standard library, as engine/bspline/evaluate_kernels.h explains.
#pragma once

namespace spoonbill {

inline constexpr int cell_lanes = 8;
inline constexpr int cell_axes = 24;             // corner by corner, x, y and z
inline constexpr int cell_stiffness_size = 300;  // the lower half, row by row

// Lanes that hold no cell have no stiffness, and the nodes of another.
struct CellBatch {
  int node[8][cell_lanes];
  // N/m. To all digits: what rounding makes of a rigid motion's nothing must stay far below the mass.
  double stiffness[cell_stiffness_size][cell_lanes];
  double rest[cell_axes][cell_lanes];      // from the middle, m
  double gradient[cell_axes][cell_lanes];  // of the shape functions there, 1/m

  // As the cells are now: set by take_forces().
  double quaternion[4][cell_lanes];    // w, x, y, z
  double turn[9][cell_lanes];          // R - 1, row by row
  double turning[9][cell_lanes];       // (tr S - S)^-1
  double back[cell_axes][cell_lanes];  // R^T (X + d)
};

struct CellKernels {
  // Turns the cells with the displacements `moved` (3 n + axis, m) and subtracts from `force`, N, what they
  // need to be held so. The turn follows by a few steps of Newton's method from the last one.
  void (*take_forces)(CellBatch* batches, int count, const double* moved, double* force);
  // Adds `scale` times the forces that hold the cells where they move by `field`, of the plain tangent
  // R P^T K P R^T.
  void (*apply)(const CellBatch* batches, int count, double scale, const double* field, double* out);
};

namespace kernels_baseline {
extern const CellKernels cell_kernels;
}
namespace kernels_avx2 {
extern const CellKernels cell_kernels;
}
namespace kernels_avx512 {
extern const CellKernels cell_kernels;
}

}  // namespace spoonbill
