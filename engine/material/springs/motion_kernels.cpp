#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = lattice_block;

inline float max(float a, float b) {
  return a > b ? a : b;
}

inline void kick_block(float* __restrict v, const float* __restrict f, const float* __restrict inverse_mass,
                       const float* __restrict free, float h, float decay) {
  for (int l = 0; l < block; ++l) v[l] = (v[l] * decay + h * (f[l] * inverse_mass[l])) * free[l];
}

// Copies the value of the first node of each seam pair to the second.
void follow_seam(const LatticeView& view, float* field) {
  for (int s = 0; s < view.seam_count; ++s) field[view.seam[2 * s + 1]] = field[view.seam[2 * s]];
}

}  // namespace

void join_seam(const LatticeView& view, float* field) {
  for (int s = 0; s < view.seam_count; ++s) field[view.seam[2 * s]] += field[view.seam[2 * s + 1]];
  follow_seam(view, field);
}

void join_seam_forces(const LatticeView& view) {
  join_seam(view, view.fx);
  join_seam(view, view.fy);
  join_seam(view, view.fz);
}

void kick(const LatticeView& view, float h, float decay) {
  join_seam_forces(view);
  for (int i = 0; i < view.padded_count; i += block) {
    if (view.free_block[i / block] == 0) continue;
    const float *inverse_mass = view.inverse_mass + i, *free = view.free_node + i;
    kick_block(view.vx + i, view.fx + i, inverse_mass, free, h, decay);
    kick_block(view.vy + i, view.fy + i, inverse_mass, free, h, decay);
    kick_block(view.vz + i, view.fz + i, inverse_mass, free, h, decay);
  }
}

namespace {

// Moves a block of nodes along one axis, and adds the squares of the changes of d + tau v since the
// linearisation to `squares`.
inline void drift_along(float* __restrict d, const float* __restrict v, const float* __restrict reference,
                        float* __restrict moved, float* __restrict squares, float h, float tau) {
  for (int l = 0; l < block; ++l) {
    d[l] += h * v[l];
    moved[l] = d[l] + tau * v[l] - reference[l];
    squares[l] += moved[l] * moved[l];
  }
}

// Computes the squared ratio of speed to cap for each node of a block.
inline void speed_ratios(const float* __restrict vx, const float* __restrict vy, const float* __restrict vz,
                         const float* __restrict free, float* __restrict ratio, const Drift& drift,
                         float inverse_square) {
  for (int l = 0; l < block; ++l) {
    const float rx = vx[l] - drift.mean_x, ry = vy[l] - drift.mean_y, rz = vz[l] - drift.mean_z;
    ratio[l] = (rx * rx + ry * ry + rz * rz) * inverse_square * free[l];
  }
}

// Caps the speeds of a block of nodes. Velocities below the cap stay the same to the last bit.
inline void cap_speeds(float* __restrict v, const float* __restrict ratio, float mean) {
  for (int l = 0; l < block; ++l) {
    const float scale = 1.0f / __builtin_sqrtf(max(ratio[l], 1.0f));
    v[l] = ratio[l] > 1.0f ? mean + (v[l] - mean) * scale : v[l];
  }
}

inline float largest_value(const float* values) {
  alignas(64) float lanes[16] = {};
  for (int i = 0; i < block; i += 16) {
    for (int l = 0; l < 16; ++l) lanes[l] = max(lanes[l], values[i + l]);
  }
  float largest = 0.0f;
  for (const float lane : lanes) largest = max(largest, lane);
  return largest;
}

}  // namespace

Drifted drift(const LatticeView& view, const Drift& drift) {
  alignas(64) float ratio[block], squares[block];
  const float inverse_square = 1.0f / (drift.cap_m_per_s * drift.cap_m_per_s);
  Drifted drifted;
  follow_seam(view, view.vx);
  follow_seam(view, view.vy);
  follow_seam(view, view.vz);
  for (int i = 0; i < view.padded_count; i += block) {
    if (view.free_block[i / block] == 0) continue;
    speed_ratios(view.vx + i, view.vy + i, view.vz + i, view.free_node + i, ratio, drift, inverse_square);
    const float fastest = largest_value(ratio);
    if (fastest > 1.0f) {
      cap_speeds(view.vx + i, ratio, drift.mean_x);
      cap_speeds(view.vy + i, ratio, drift.mean_y);
      cap_speeds(view.vz + i, ratio, drift.mean_z);
    }
    for (int l = 0; l < block; ++l) squares[l] = 0.0f;
    drift_along(view.dx + i, view.vx + i, view.reference_x + i, view.moved_x + i, squares, drift.h_s,
                drift.tau_s);
    drift_along(view.dy + i, view.vy + i, view.reference_y + i, view.moved_y + i, squares, drift.h_s,
                drift.tau_s);
    drift_along(view.dz + i, view.vz + i, view.reference_z + i, view.moved_z + i, squares, drift.h_s,
                drift.tau_s);
    drifted.speed_square = max(drifted.speed_square, fastest);
    drifted.moved_square = max(drifted.moved_square, largest_value(squares));
  }
  return drifted;
}

void momentum(const LatticeView& view, const float* mass, float sum[4]) {
  float x[16] = {}, y[16] = {}, z[16] = {}, m[16] = {};
  for (int start = 0; start < view.padded_count; start += 16) {
    for (int l = 0; l < 16; ++l) {
      const int i = start + l;
      x[l] += mass[i] * view.vx[i];
      y[l] += mass[i] * view.vy[i];
      z[l] += mass[i] * view.vz[i];
      m[l] += mass[i];
    }
  }
  for (int l = 1; l < 16; ++l) {
    x[0] += x[l];
    y[0] += y[l];
    z[0] += z[l];
    m[0] += m[l];
  }
  sum[0] = x[0];
  sum[1] = y[0];
  sum[2] = z[0];
  sum[3] = m[0];
}

FieldRange find_range(const float* field, int count) {
  constexpr int lane_count = 32;
  alignas(64) float low[lane_count], high[lane_count], sum[lane_count] = {};
  for (int l = 0; l < lane_count; ++l) low[l] = high[l] = field[0];
  const int whole = count - count % lane_count;
  for (int start = 0; start < whole; start += lane_count) {
    for (int l = 0; l < lane_count; ++l) {
      const float value = field[start + l];
      low[l] = value < low[l] ? value : low[l];
      high[l] = value > high[l] ? value : high[l];
      sum[l] += value;
    }
  }
  for (int i = whole; i < count; ++i) {
    low[0] = field[i] < low[0] ? field[i] : low[0];
    high[0] = max(field[i], high[0]);
    sum[0] += field[i];
  }
  for (int l = 1; l < lane_count; ++l) {
    low[0] = low[l] < low[0] ? low[l] : low[0];
    high[0] = max(high[l], high[0]);
    sum[0] += sum[l];
  }
  return {low[0], high[0], __builtin_isfinite(sum[0]) != 0};
}

double find_largest_square(const float* x, const float* y, const float* z, int padded_count) {
  alignas(64) double largest[block] = {};
  for (int start = 0; start < padded_count; start += block) {
    for (int l = 0; l < block; ++l) {
      const double vx = x[start + l], vy = y[start + l], vz = z[start + l];
      const double square = vx * vx + (vy * vy + vz * vz);
      largest[l] = square > largest[l] ? square : largest[l];
    }
  }
  for (int l = 1; l < block; ++l) largest[0] = largest[l] > largest[0] ? largest[l] : largest[0];
  return largest[0];
}

}  // namespace spoonbill::SPOONBILL_KERNELS
