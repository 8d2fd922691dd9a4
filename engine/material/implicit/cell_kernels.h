// Kernels for the cells of an implicit body, which process eight cells side by side. The cells are corotated
// hexahedra (see engine/material/cells/corotated_cell.h). They are compiled once for each instruction set and
// give the same bits on each. This header uses no standard library; engine/bspline/evaluate_kernels.h
// explains why.
#pragma once

namespace spoonbill {

inline constexpr int cell_lanes = 8;
inline constexpr int cell_axes = 24;             // coordinates of a cell: x, y and z, corner by corner
inline constexpr int cell_stiffness_size = 300;  // lower half of a cell's stiffness, row by row

// Eight cells side by side. Lanes without a cell have zero stiffness and refer to the nodes of another cell.
struct CellBatch {
  int node[8][cell_lanes];
  // Stiffness of each cell, N/m, in double precision, because the rounding errors in a rigid motion must stay
  // far below the mass terms.
  double stiffness[cell_stiffness_size][cell_lanes];
  double rest[cell_axes][cell_lanes];      // corners at rest relative to the cell's centre, m
  double gradient[cell_axes][cell_lanes];  // gradients of the shape functions at the centre, 1/m

  // State of the cells at the last compute_forces(): the rotation R, the stretch S and the displacements d of
  // the corners X.
  double quaternion[4][cell_lanes];            // w, x, y, z
  double turn[9][cell_lanes];                  // R - 1, row by row
  double spin_map[9][cell_lanes];              // (tr S - S)^-1
  double rotated_back[cell_axes][cell_lanes];  // R^T (X + d)
};

struct CellKernels {
  // Updates the rotations of the cells for the displacements `moved`, m, and subtracts the elastic forces of
  // the cells from `force`, N. Both arrays have entry 3 n + axis for node n. A few Newton steps from the last
  // rotation find the new one.
  void (*compute_forces)(CellBatch* batches, int count, const double* moved, double* force);
  // Adds `scale` times the product of the cells' tangent and `field` to `out`. The tangent is R P^T K P R^T,
  // without the contribution of stress (see CorotatedCell::respond()).
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
