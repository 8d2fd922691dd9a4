#include "engine/material/lattice_kernels.h"

#include "engine/material/volume_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = lattice_block;
constexpr float tiny = 1e-30f;

struct BlockForces {
  alignas(64) float x[block], y[block], z[block];
};

inline float min_of(float a, float b) {
  return a < b ? a : b;
}
inline float max_of(float a, float b) {
  return a > b ? a : b;
}

inline void clear(BlockForces& force) {
  for (int l = 0; l < block; ++l) force.x[l] = force.y[l] = force.z[l] = 0.0f;
}

inline void add(const BlockForces& force, const LatticeView& view, int start) {
  for (int l = 0; l < block; ++l) view.fx[start + l] += force.x[l];
  for (int l = 0; l < block; ++l) view.fy[start + l] += force.y[l];
  for (int l = 0; l < block; ++l) view.fz[start + l] += force.z[l];
}

// Each spring pulls its two ends: the near end first, then the far one, so that overlapping offsets cannot
// clash.
inline void scatter(const BlockForces& force, float* __restrict f_x, float* __restrict f_y,
                    float* __restrict f_z, int start, int offset) {
  for (int l = 0; l < block; ++l) f_x[start + l] += force.x[l];
  for (int l = 0; l < block; ++l) f_y[start + l] += force.y[l];
  for (int l = 0; l < block; ++l) f_z[start + l] += force.z[l];
  for (int l = 0; l < block; ++l) f_x[start + offset + l] -= force.x[l];
  for (int l = 0; l < block; ++l) f_y[start + offset + l] -= force.y[l];
  for (int l = 0; l < block; ++l) f_z[start + offset + l] -= force.z[l];
}

void clear_forces(const LatticeView& view) {
  float* const forces[3] = {view.fx, view.fy, view.fz};
  for (float* f : forces) {
    for (int i = 0; i < view.padded_count; ++i) f[i] = 0.0f;
  }
}

// What one block of springs of one direction adds to their near ends, and takes from their far ends at once.
// With n the rest vector, a = n + e the present one and s = |a|^2 - L0^2 = e.(n + a) + (|n|^2 - L0^2), the
// force is k (s / (L + L0) + tau v.a / L) a / L, in which a small extension keeps all its digits, brought to
// one root and one quotient.
inline void spring_block(const LatticeView& view, const SpringArrays& s, int start, float tau,
                         BlockForces& near) {
  const int o = s.offset;
  const float *dx = view.dx + start, *dy = view.dy + start, *dz = view.dz + start;
  const float *vx = view.vx + start, *vy = view.vy + start, *vz = view.vz + start;
  const float *rx = s.rest_x + start, *ry = s.rest_y + start, *rz = s.rest_z + start;
  const float *k = s.stiffness + start, *rest = s.rest_length + start, *q = s.square_difference + start;
  float* __restrict far_x = view.fx + start + o;
  float* __restrict far_y = view.fy + start + o;
  float* __restrict far_z = view.fz + start + o;
#pragma GCC ivdep
  for (int l = 0; l < block; ++l) {
    const float ex = dx[l + o] - dx[l], ey = dy[l + o] - dy[l], ez = dz[l + o] - dz[l];
    const float ax = rx[l] + ex, ay = ry[l] + ey, az = rz[l] + ez;
    const float squares = ex * (rx[l] + ax) + ey * (ry[l] + ay) + ez * (rz[l] + az) + q[l];
    const float rest_square = rest[l] * rest[l];
    const float square = max_of(rest_square + squares, 1e-6f * rest_square);
    const float length = __builtin_sqrtf(square), both = length + rest[l];
    const float rate = (vx[l + o] - vx[l]) * ax + (vy[l + o] - vy[l]) * ay + (vz[l + o] - vz[l]) * az;
    const float scale = k[l] * (squares * length + (tau * rate) * both) / (square * both);
    const float fx = scale * ax, fy = scale * ay, fz = scale * az;
    near.x[l] += fx;
    near.y[l] += fy;
    near.z[l] += fz;
    far_x[l] -= fx;
    far_y[l] -= fy;
    far_z[l] -= fz;
  }
}

// A tile of blocks, direction by direction: displacements and forces stay in the first cache, and few enough
// arrays are read at once for the processor to fetch them ahead. Near ends are summed apart, so that no load
// waits for an overlapping store just before it.
void spring_forces(const LatticeView& view, float tau) {
  constexpr int tile_blocks = 8, tile = tile_blocks * block;
  BlockForces near[tile_blocks];
  for (int first = 0; first < view.padded_count; first += tile) {
    const int end = first + tile < view.padded_count ? first + tile : view.padded_count;
    for (int b = 0; b < tile_blocks; ++b) clear(near[b]);
    for (const SpringArrays& s : view.springs) {
      for (int start = first; start < end; start += block) {
        if (view.active_block[start / block] == 0) continue;
        spring_block(view, s, start, tau, near[(start - first) / block]);
      }
    }
    for (int start = first; start < end; start += block) add(near[(start - first) / block], view, start);
  }
}

void kick(const LatticeView& view, float h, float decay, float gx, float gy, float gz) {
  const float gravity[3] = {gx, gy, gz};
  float* velocity[3] = {view.vx, view.vy, view.vz};
  const float* force[3] = {view.fx, view.fy, view.fz};
  for (int axis = 0; axis < 3; ++axis) {
    float* __restrict v = velocity[axis];
    const float* __restrict f = force[axis];
    const float g = gravity[axis];
    for (int i = 0; i < view.padded_count; ++i) {
      v[i] = (v[i] + h * (f[i] * view.inverse_mass[i] + g)) * decay * view.free_node[i];
    }
  }
}

// Limits one block's velocities and returns the squared ratios of speed to cap.
inline void cap_block(float* __restrict vx, float* __restrict vy, float* __restrict vz,
                      const float* __restrict free, float* __restrict lanes, float inverse_square, float mx,
                      float my, float mz) {
  for (int l = 0; l < 16; ++l) {
    const float rx = vx[l] - mx, ry = vy[l] - my, rz = vz[l] - mz;
    const float ratio = (rx * rx + ry * ry + rz * rz) * inverse_square * free[l];
    const float keep = 1.0f / __builtin_sqrtf(max_of(ratio, 1.0f));
    // Exactly 1 below the cap, where the velocity must keep its bits.
    vx[l] = keep < 1.0f ? mx + rx * keep : vx[l];
    vy[l] = keep < 1.0f ? my + ry * keep : vy[l];
    vz[l] = keep < 1.0f ? mz + rz * keep : vz[l];
    lanes[l] = max_of(lanes[l], ratio);
  }
}

float drift(const LatticeView& view, float h, float cap, float mx, float my, float mz) {
  alignas(64) float lanes[16] = {};
  const float inverse_square = 1.0f / (cap * cap);
  for (int start = 0; start < view.padded_count; start += 16) {
    cap_block(view.vx + start, view.vy + start, view.vz + start, view.free_node + start, lanes,
              inverse_square, mx, my, mz);
  }
  float* const displacement[3] = {view.dx, view.dy, view.dz};
  const float* const velocity[3] = {view.vx, view.vy, view.vz};
  for (int axis = 0; axis < 3; ++axis) {
    float* __restrict d = displacement[axis];
    const float* __restrict v = velocity[axis];
    for (int i = 0; i < view.padded_count; ++i) d[i] += h * v[i];
  }
  float largest = 0.0f;
  for (float lane : lanes) largest = max_of(largest, lane);
  return largest;
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

// Two Newton steps from the tangent at 1: within 1e-4 for J from 0.5 to 2, exact at 1. 0 outside 0.3 to 3:
// about a node whose cells are crushed or torn, flow would take the distortion for the new shape.
inline float cube_root(float j) {
  const float a = min_of(max_of(j, 0.3f), 3.0f);
  float y = 1.0f + (a - 1.0f) * (1.0f / 3.0f);
  y = y - (y * y * y - a) / (3.0f * y * y);
  y = y - (y * y * y - a) / (3.0f * y * y);
  return a == j ? y : 0.0f;
}

// The present length of each spring of a block.
inline void length_block(const LatticeView& view, const SpringArrays& s, int start,
                         float* __restrict length) {
  const int o = s.offset;
  const float *dx = view.dx + start, *dy = view.dy + start, *dz = view.dz + start;
  const float *rx = s.rest_x + start, *ry = s.rest_y + start, *rz = s.rest_z + start;
  for (int l = 0; l < block; ++l) {
    const float ax = rx[l] + (dx[l + o] - dx[l]), ay = ry[l] + (dy[l + o] - dy[l]),
                az = rz[l] + (dz[l + o] - dz[l]);
    length[l] = __builtin_sqrtf(ax * ax + ay * ay + az * az + tiny);
  }
}

inline void flow_block(const float* __restrict length, const float* __restrict root,
                       const float* __restrict root_far, const float* __restrict stiffness,
                       const float* __restrict first, float* __restrict rest_length,
                       float* __restrict square_difference, float yield, float rate_step) {
  for (int l = 0; l < block; ++l) {
    const float rest = rest_length[l];
    const float strain = length[l] / (rest * max_of(0.5f * (root[l] + root_far[l]), 0.1f)) - 1.0f;
    const float beyond = max_of(strain - yield, 0.0f) + min_of(strain + yield, 0.0f);
    const float limited = min_of(max_of(beyond * rate_step, -0.1f), 0.1f) * rest;
    const float next = min_of(max_of(rest + limited, 0.5f * first[l]), 2.0f * first[l]);
    const float change = stiffness[l] > 0.0f && root[l] > 0.0f && root_far[l] > 0.0f ? next - rest : 0.0f;
    square_difference[l] -= change * (2.0f * rest + change);
    rest_length[l] = rest + change;
  }
}

void flow(const LatticeView& view, float yield, float rate_step) {
  average_dilations(view);
  float* __restrict root = view.fx;
  const float* __restrict dilation = view.node_dilation;
  for (int i = 0; i < view.padded_count; ++i) root[i] = cube_root(dilation[i]);
  alignas(64) float length[block];
  for (const SpringArrays& s : view.springs) {
    for (int start = 0; start < view.padded_count; start += block) {
      if (view.active_block[start / block] == 0) continue;
      length_block(view, s, start, length);
      flow_block(length, root + start, root + start + s.offset, s.stiffness + start,
                 s.first_rest_length + start, s.rest_length + start, s.square_difference + start, yield,
                 rate_step);
    }
  }
}

void stiffness_product_springs(const LatticeView& view) {
  BlockForces force;
  for (const SpringArrays& s : view.springs) {
    const int o = s.offset;
    for (int start = 0; start < view.padded_count; start += block) {
      if (view.active_block[start / block] == 0) continue;
      for (int l = 0; l < block; ++l) {
        const int i = start + l;
        const float ax = s.rest_x[i] + (view.dx[i + o] - view.dx[i]);
        const float ay = s.rest_y[i] + (view.dy[i + o] - view.dy[i]);
        const float az = s.rest_z[i] + (view.dz[i + o] - view.dz[i]);
        const float wx = view.power_x[i + o] - view.power_x[i];
        const float wy = view.power_y[i + o] - view.power_y[i];
        const float wz = view.power_z[i + o] - view.power_z[i];
        const float scale =
            s.stiffness[i] * (wx * ax + wy * ay + wz * az) / (ax * ax + ay * ay + az * az + tiny);
        force.x[l] = -scale * ax;
        force.y[l] = -scale * ay;
        force.z[l] = -scale * az;
      }
      scatter(force, view.fx, view.fy, view.fz, start, o);
    }
  }
}

void row_sums(const LatticeView& view, float* sum) {
  for (int i = 0; i < view.padded_count; ++i) sum[i] = 0.0f;
  for (const SpringArrays& s : view.springs) {
    const float* __restrict k = s.stiffness;
    for (int start = 0; start < view.padded_count; start += block) {
      float* __restrict near = sum + start;
      for (int l = 0; l < block; ++l) near[l] += 2.0f * k[start + l];
      float* __restrict far = sum + start + s.offset;
      for (int l = 0; l < block; ++l) far[l] += 2.0f * k[start + l];
    }
  }
  add_volume_row_sums(view, sum);
}

inline float mass_norm(const float* mass, const float* x, const float* y, const float* z, int count) {
  alignas(64) float lanes[16] = {};
  for (int start = 0; start < count; start += 16) {
    for (int l = 0; l < 16; ++l) {
      const int i = start + l;
      lanes[l] += mass[i] * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    }
  }
  for (int l = 1; l < 16; ++l) lanes[0] += lanes[l];
  return __builtin_sqrtf(lanes[0]);
}

inline void take_power_step(float* __restrict w, const float* __restrict f, const float* __restrict noise,
                            const float* __restrict free, float scale, float sign, int count) {
  for (int i = 0; i < count; ++i) w[i] = (f[i] * scale + sign * noise[i]) * free[i];
}

inline void divide_by_mass(float* __restrict f, const float* __restrict inverse_mass, int count) {
  for (int i = 0; i < count; ++i) f[i] *= inverse_mass[i];
}

float power_step(const LatticeView& view, const float* mass) {
  clear_forces(view);
  stiffness_product_springs(view);
  add_volume_stiffness(view);
  const int count = view.padded_count;
  const float before = mass_norm(mass, view.power_x, view.power_y, view.power_z, count);
  divide_by_mass(view.fx, view.inverse_mass, count);
  divide_by_mass(view.fy, view.inverse_mass, count);
  divide_by_mass(view.fz, view.inverse_mass, count);
  const float after = mass_norm(mass, view.fx, view.fy, view.fz, count);
  const float scale = after > 0.0f ? 1.0f / after : 0.0f;
  take_power_step(view.power_x, view.fx, view.power_noise, view.free_node, scale, 1.0f, count);
  take_power_step(view.power_y, view.fy, view.power_noise, view.free_node, scale, -1.0f, count);
  take_power_step(view.power_z, view.fz, view.power_noise, view.free_node, scale, 1.0f, count);
  return before > 0.0f ? after / before : 0.0f;
}

}  // namespace

const LatticeKernels lattice_kernels = {
    clear_forces, spring_forces, volume_forces,        kick,       drift, momentum,
    flow,         row_sums,      measure_rest_volumes, power_step,
};

}  // namespace spoonbill::SPOONBILL_KERNELS
