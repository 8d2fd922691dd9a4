#include "engine/material/springs/lattice_kernels.h"
#include "engine/material/springs/speed_cap.h"

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

// Moves a block of nodes along one axis with the velocities v, and adds the squares of the changes of d + tau
// u since the linearisation to `squares`. u are the velocities for damping.
inline void drift_along(float* __restrict d, const float* v, const float* u,
                        const float* __restrict reference, float* __restrict moved, float* __restrict squares,
                        const Drift& drift) {
  const float h = drift.h_s, tau = drift.tau_s;
  for (int l = 0; l < block; ++l) {
    d[l] += h * v[l];
    moved[l] = d[l] + tau * u[l] - reference[l];
    squares[l] += moved[l] * moved[l];
  }
}

}  // namespace

Drifted drift(const LatticeView& view, const Drift& drift) {
  alignas(64) float ratio[block], squares[block], damped_ratio[block], damped[3][block];
  Drifted drifted;
  follow_seam(view, view.vx);
  follow_seam(view, view.vy);
  follow_seam(view, view.vz);
  for (int i = 0; i < view.padded_count; i += block) {
    if (view.free_block[i / block] == 0) continue;
    float *vx = view.vx + i, *vy = view.vy + i, *vz = view.vz + i;
    const float fastest = speed_ratios({vx, vy, vz}, view.free_node + i, drift.speeds, ratio);
    if (fastest > 1.0f) {
      cap_speeds(vx, ratio, drift.speeds.mean_x, vx);
      cap_speeds(vy, ratio, drift.speeds.mean_y, vy);
      cap_speeds(vz, ratio, drift.speeds.mean_z, vz);
    }
    const float *ux = vx, *uy = vy, *uz = vz;
    const SpeedCap& cap = view.damped_speeds;
    if (cap.cap_m_per_s > 0.0f && speed_ratios({vx, vy, vz}, view.free_node + i, cap, damped_ratio) > 1.0f) {
      cap_speeds(vx, damped_ratio, cap.mean_x, damped[0]);
      cap_speeds(vy, damped_ratio, cap.mean_y, damped[1]);
      cap_speeds(vz, damped_ratio, cap.mean_z, damped[2]);
      ux = damped[0];
      uy = damped[1];
      uz = damped[2];
    }
    for (int l = 0; l < block; ++l) squares[l] = 0.0f;
    drift_along(view.dx + i, vx, ux, view.reference_x + i, view.moved_x + i, squares, drift);
    drift_along(view.dy + i, vy, uy, view.reference_y + i, view.moved_y + i, squares, drift);
    drift_along(view.dz + i, vz, uz, view.reference_z + i, view.moved_z + i, squares, drift);
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
