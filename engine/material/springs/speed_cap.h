// Caps the speeds of a block of nodes. Included by the kernels of springs and of motion only.
#pragma once

#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

// These functions are static, so that no kernel exports a copy of them.

// Returns the largest of the values of a block of nodes, none of which is negative.
static inline float largest_value(const float* values) {
  alignas(64) float lanes[16] = {};
  for (int i = 0; i < lattice_block; i += 16) {
    for (int l = 0; l < 16; ++l) lanes[l] = lanes[l] > values[i + l] ? lanes[l] : values[i + l];
  }
  float largest = 0.0f;
  for (const float lane : lanes) largest = largest > lane ? largest : lane;
  return largest;
}

// Velocities of a block of nodes along the three axes, m/s.
struct BlockVelocities {
  const float *x, *y, *z;
};

// Computes the squared ratio of speed to cap for each node of a block, 0 for fixed nodes. Returns the
// largest.
static inline float speed_ratios(const BlockVelocities& v, const float* __restrict free, const SpeedCap& cap,
                                 float* __restrict ratio) {
  const float inverse_square = 1.0f / (cap.cap_m_per_s * cap.cap_m_per_s);
  for (int l = 0; l < lattice_block; ++l) {
    const float rx = v.x[l] - cap.mean_x, ry = v.y[l] - cap.mean_y, rz = v.z[l] - cap.mean_z;
    ratio[l] = (rx * rx + ry * ry + rz * rz) * inverse_square * free[l];
  }
  return largest_value(ratio);
}

// Caps the velocities of a block of nodes along one axis. Those below the cap stay the same to the last bit.
static inline void cap_speeds(const float* v, const float* __restrict ratio, float mean, float* capped) {
  for (int l = 0; l < lattice_block; ++l) {
    const float scale = 1.0f / __builtin_sqrtf(ratio[l] > 1.0f ? ratio[l] : 1.0f);
    capped[l] = ratio[l] > 1.0f ? mean + (v[l] - mean) * scale : v[l];
  }
}

}  // namespace spoonbill::SPOONBILL_KERNELS
