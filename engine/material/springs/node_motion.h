// Nodes that something else than their lattice moves, within a substep.
#pragma once

#include "engine/base/geometry.h"
#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill {

inline void set_velocity(const LatticeView& view, int n, const Vector3& velocity) {
  view.vx[n] = static_cast<float>(velocity.x());
  view.vy[n] = static_cast<float>(velocity.y());
  view.vz[n] = static_cast<float>(velocity.z());
}

// As drift() leaves a node; returns the square of what it moved since the springs were linearised.
inline float place_node(const LatticeView& view, int n, const Vector3& displacement, float tau) {
  float* const d[3] = {view.dx, view.dy, view.dz};
  float* const ahead[3] = {view.ahead_x, view.ahead_y, view.ahead_z};
  float* const moved[3] = {view.moved_x, view.moved_y, view.moved_z};
  const float* const v[3] = {view.vx, view.vy, view.vz};
  const float* const reference[3] = {view.reference_x, view.reference_y, view.reference_z};
  float square = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    d[axis][n] = static_cast<float>(displacement[axis]);
    ahead[axis][n] = d[axis][n] + tau * v[axis][n];
    moved[axis][n] = ahead[axis][n] - reference[axis][n];
    square += moved[axis][n] * moved[axis][n];
  }
  return square;
}

}  // namespace spoonbill
