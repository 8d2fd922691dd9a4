#include "engine/material/springs/lattice_kernels.h"

#include "engine/material/springs/speed_cap.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = lattice_block;
constexpr float tiny = 1e-30f;

struct BlockForces {
  alignas(64) float x[block], y[block], z[block];
};

inline float min(float a, float b) {
  return a < b ? a : b;
}
inline float max(float a, float b) {
  return a > b ? a : b;
}

inline void clear(BlockForces& force) {
  for (int l = 0; l < block; ++l) force.x[l] = force.y[l] = force.z[l] = 0.0f;
}

inline void add(const BlockForces& force, float* __restrict fx, float* __restrict fy, float* __restrict fz) {
  for (int l = 0; l < block; ++l) fx[l] += force.x[l];
  for (int l = 0; l < block; ++l) fy[l] += force.y[l];
  for (int l = 0; l < block; ++l) fz[l] += force.z[l];
}

struct ConstField {
  const float *x, *y, *z;
};

struct Field {
  float *x, *y, *z;
};

void set_to(float* __restrict to, const float* __restrict from, int count) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

void clear(float* x, float* y, float* z, int count) {
  for (int i = 0; i < count; ++i) x[i] = y[i] = z[i] = 0.0f;
}

// Variants of the spring law. The springs of one block and direction add their forces to their near ends and
// subtract them from their far ends.
//
// For the rest vector n, the difference e of the ends' displacements and the present vector a = n + e, let
// s = |a|^2 - L0^2 = e.(n + a) + (|n|^2 - L0^2). The force is k (L - L0) a / L = k s / (L^2 + L0 L) a. This
// form keeps all digits of a small extension.
//
// The derivative of the force is transverse I + axial a a^T with transverse = k (L - L0) / L and axial = k L0
// / L^3. `transverse` is limited to -k or more, its value for a spring compressed to half its length.
enum class Springs { linear, stiffening, softening, mixed };

struct Stiffened {
  float secant, tangent;  // stiffness relative to that of a linear spring
};

// Returns the stiffening factors; `by` is b e^2 for the stiffening b and the strain e.
template <Springs springs>
inline Stiffened stiffened(float by) {
  const Stiffened more = {1.0f + min(by, 1.0f), by < 1.0f ? 1.0f + 3.0f * by : 2.0f};
  if (springs == Springs::stiffening) return more;
  const float square = 1.0f / (1.0f - (springs == Springs::mixed ? min(by, 0.0f) : by));
  const float root = __builtin_sqrtf(square);
  const Stiffened less = {root, root * square};
  if (springs == Springs::softening) return less;
  return {by > 0.0f ? more.secant : less.secant, by > 0.0f ? more.tangent : less.tangent};
}

template <Springs springs>
inline void linearise_block(const LatticeView& view, const SpringArrays& s, int start,
                            float* __restrict tangent, BlockForces& near) {
  const int o = s.offset;
  const float *wx = view.reference_x + start, *wy = view.reference_y + start, *wz = view.reference_z + start;
  const float *rx = s.rest_x + start, *ry = s.rest_y + start, *rz = s.rest_z + start;
  const float *k = s.stiffness + start, *rest = s.rest_length + start, *q = s.square_difference + start;
  float* __restrict far_x = view.spring_x + start + o;
  float* __restrict far_y = view.spring_y + start + o;
  float* __restrict far_z = view.spring_z + start + o;
  const float* const own_stiffening = springs == Springs::mixed ? s.stiffening + start : nullptr;
#pragma GCC ivdep
  for (int l = 0; l < block; ++l) {
    const float ex = wx[l + o] - wx[l], ey = wy[l + o] - wy[l], ez = wz[l + o] - wz[l];
    const float ax = rx[l] + ex, ay = ry[l] + ey, az = rz[l] + ez;
    const float squares = ex * (rx[l] + ax) + ey * (ry[l] + ay) + ez * (rz[l] + az) + q[l];
    const float rest_square = rest[l] * rest[l];
    const float square = max(rest_square + squares, 1e-6f * rest_square);
    const float length = __builtin_sqrtf(square), both = square + rest[l] * length;
    const float inverse = 1.0f / (square * both);
    float scale = k[l] * squares * (square * inverse), stiffness = k[l];
    if (springs != Springs::linear) {
      const float strain = squares / (rest[l] * (length + rest[l]));
      const float stiffening = springs == Springs::mixed ? own_stiffening[l] : view.stiffening;
      const Stiffened by = stiffened<springs>(stiffening * strain * strain);
      scale *= by.secant;
      stiffness *= by.tangent;
    }
    const float softened = max(scale, -stiffness);
    const float fx = scale * ax, fy = scale * ay, fz = scale * az;
    tangent[l] = ax;
    tangent[block + l] = ay;
    tangent[2 * block + l] = az;
    tangent[3 * block + l] = (stiffness - softened) * (both * inverse);
    tangent[4 * block + l] = softened;
    near.x[l] += fx;
    near.y[l] += fy;
    near.z[l] += fz;
    far_x[l] -= fx;
    far_y[l] -= fy;
    far_z[l] -= fz;
  }
}

inline void tangent_block(const LatticeView& view, int offset, const ConstField& field, int start,
                          const float* tangent, BlockForces& near) {
  const int o = offset;
  const float *ux = field.x + start, *uy = field.y + start, *uz = field.z + start;
  float* __restrict far_x = view.fx + start + o;
  float* __restrict far_y = view.fy + start + o;
  float* __restrict far_z = view.fz + start + o;
#pragma GCC ivdep
  for (int l = 0; l < block; ++l) {
    const float mx = ux[l + o] - ux[l], my = uy[l + o] - uy[l], mz = uz[l + o] - uz[l];
    const float ax = tangent[l], ay = tangent[block + l], az = tangent[2 * block + l];
    const float axial = tangent[3 * block + l], transverse = tangent[4 * block + l];
    const float pull = axial * (mx * ax + my * ay + mz * az);
    const float fx = pull * ax + transverse * mx;
    const float fy = pull * ay + transverse * my;
    const float fz = pull * az + transverse * mz;
    near.x[l] += fx;
    near.y[l] += fy;
    near.z[l] += fz;
    far_x[l] -= fx;
    far_y[l] -= fy;
    far_z[l] -= fz;
  }
}

// Calls for_block(springs, start, near) for every active block of every direction. The call adds the block's
// forces on near ends to `near`, and these are later added to `sums`. Because they are collected separately,
// no load waits for an overlapping store just before it. Blocks are grouped into tiles, direction by
// direction: positions and forces stay in the first-level cache, and few enough arrays are read at once for
// prefetching.
template <int count, class ForBlock>
inline void over_springs(const LatticeView& view, const Field (&sums)[count], const ForBlock& for_block) {
  constexpr int tile_blocks = 8, tile = tile_blocks * block;
  BlockForces near[tile_blocks][count];
  for (int first = 0; first < view.padded_count; first += tile) {
    const int end = first + tile < view.padded_count ? first + tile : view.padded_count;
    for (int b = 0; b < tile_blocks; ++b) {
      for (int i = 0; i < count; ++i) clear(near[b][i]);
    }
    for (const SpringArrays& s : view.springs) {
      for (int start = first; start < end; start += block) {
        if (view.active_block[start / block] != 0) for_block(s, start, near[(start - first) / block]);
      }
    }
    for (int start = first; start < end; start += block) {
      for (int i = 0; i < count; ++i) {
        add(near[(start - first) / block][i], sums[i].x + start, sums[i].y + start, sums[i].z + start);
      }
    }
  }
}

// Destination of a block's tangents: the lattice's own arrays, or a scratch buffer, which avoids most of the
// memory traffic of a linearisation.
struct Tangents {
  Linearised stored;
  alignas(64) float scratch[tangent_runs * block];

  float* destination(const SpringArrays& s, int start) {
    return stored == Linearised::tangents ? s.tangent + tangent_runs * start : scratch;
  }
};

template <Springs springs>
void linearise_all(const LatticeView& view, Tangents& tangents, bool powers) {
  const Field forces[2] = {{view.spring_x, view.spring_y, view.spring_z}, {view.fx, view.fy, view.fz}};
  const ConstField power = {view.power_x, view.power_y, view.power_z};
  if (!powers) {
    const Field springs_alone[1] = {forces[0]};
    over_springs(view, springs_alone, [&](const SpringArrays& s, int start, BlockForces(&near)[1]) {
      linearise_block<springs>(view, s, start, tangents.destination(s, start), near[0]);
    });
    return;
  }
  over_springs(view, forces, [&](const SpringArrays& s, int start, BlockForces(&near)[2]) {
    float* const tangent = tangents.destination(s, start);
    linearise_block<springs>(view, s, start, tangent, near[0]);
    tangent_block(view, s.offset, power, start, tangent, near[1]);
  });
}

void extrapolate(float* __restrict to, const float* __restrict d, const float* __restrict v, float tau,
                 int count) {
  for (int i = 0; i < count; ++i) to[i] = d[i] + tau * v[i];
}

// Extrapolates the displacements of all nodes by the damping time, within the speeds for damping.
void extrapolate(const LatticeView& view, float tau) {
  extrapolate(view.reference_x, view.dx, view.vx, tau, view.padded_count);
  extrapolate(view.reference_y, view.dy, view.vy, tau, view.padded_count);
  extrapolate(view.reference_z, view.dz, view.vz, tau, view.padded_count);
  const SpeedCap& cap = view.damped_speeds;
  if (!(cap.cap_m_per_s > 0.0f)) return;
  alignas(64) float ratio[lattice_block], capped[lattice_block];
  for (int i = 0; i < view.padded_count; i += lattice_block) {
    const float *vx = view.vx + i, *vy = view.vy + i, *vz = view.vz + i;
    if (!(speed_ratios({vx, vy, vz}, view.free_node + i, cap, ratio) > 1.0f)) continue;
    cap_speeds(vx, ratio, cap.mean_x, capped);
    extrapolate(view.reference_x + i, view.dx + i, capped, tau, lattice_block);
    cap_speeds(vy, ratio, cap.mean_y, capped);
    extrapolate(view.reference_y + i, view.dy + i, capped, tau, lattice_block);
    cap_speeds(vz, ratio, cap.mean_z, capped);
    extrapolate(view.reference_z + i, view.dz + i, capped, tau, lattice_block);
  }
}

// Linearises all springs at the extrapolated positions. If `powers` is true, also sets the forces to the
// product of the springs' derivative and the power vector.
void linearise_extrapolated(const LatticeView& view, Linearised stored, bool powers) {
  const int count = view.padded_count;
  clear(view.spring_x, view.spring_y, view.spring_z, count);
  if (powers) clear(view.fx, view.fy, view.fz, count);
  Tangents tangents;
  tangents.stored = stored;
  if (view.springs[0].stiffening) {
    linearise_all<Springs::mixed>(view, tangents, powers);
  } else if (view.stiffening > 0.0f) {
    linearise_all<Springs::stiffening>(view, tangents, powers);
  } else if (view.stiffening < 0.0f) {
    linearise_all<Springs::softening>(view, tangents, powers);
  } else {
    linearise_all<Springs::linear>(view, tangents, powers);
  }
}

void linearise(const LatticeView& view, float tau, Linearised stored, bool powers) {
  extrapolate(view, tau);
  clear(view.moved_x, view.moved_y, view.moved_z, view.padded_count);
  linearise_extrapolated(view, stored, powers);
}

void linearise_springs(const LatticeView& view, float tau, Linearised stored) {
  linearise(view, tau, stored, false);
}

void store_tangents(const LatticeView& view) {
  linearise_extrapolated(view, Linearised::tangents, false);
}

void start_forces(const LatticeView& view) {
  set_to(view.fx, view.spring_x, view.padded_count);
  set_to(view.fy, view.spring_y, view.padded_count);
  set_to(view.fz, view.spring_z, view.padded_count);
}

void add_weights(float* __restrict to, const float* mass, float g, int count) {
  for (int i = 0; i < count; ++i) to[i] += mass[i] * g;
}

void add_weights(const LatticeView& view, const float* mass, const float g[3]) {
  add_weights(view.fx, mass, g[0], view.padded_count);
  add_weights(view.fy, mass, g[1], view.padded_count);
  add_weights(view.fz, mass, g[2], view.padded_count);
}

void add_spring_tangent(const LatticeView& view, const ConstField& field) {
  const Field forces[1] = {{view.fx, view.fy, view.fz}};
  over_springs(view, forces, [&](const SpringArrays& s, int start, BlockForces(&near)[1]) {
    tangent_block(view, s.offset, field, start, s.tangent + tangent_runs * start, near[0]);
  });
}

void spring_forces(const LatticeView& view) {
  add_spring_tangent(view, {view.moved_x, view.moved_y, view.moved_z});
}

inline void damp_block(const LatticeView& view, const SpringArrays& s, int start, BlockForces& near) {
  const int o = s.offset;
  const float *vx = view.vx + start, *vy = view.vy + start, *vz = view.vz + start;
  const float *const tangent = s.tangent + tangent_runs * start, *c = s.further_damping + start;
  float* __restrict far_x = view.fx + start + o;
  float* __restrict far_y = view.fy + start + o;
  float* __restrict far_z = view.fz + start + o;
#pragma GCC ivdep
  for (int l = 0; l < block; ++l) {
    const float mx = vx[l + o] - vx[l], my = vy[l + o] - vy[l], mz = vz[l + o] - vz[l];
    const float ax = tangent[l], ay = tangent[block + l], az = tangent[2 * block + l];
    const float pull = c[l] * (mx * ax + my * ay + mz * az) / (ax * ax + ay * ay + az * az + tiny);
    const float fx = pull * ax, fy = pull * ay, fz = pull * az;
    near.x[l] += fx;
    near.y[l] += fy;
    near.z[l] += fz;
    far_x[l] -= fx;
    far_y[l] -= fy;
    far_z[l] -= fz;
  }
}

void damp_further(const LatticeView& view) {
  const Field forces[1] = {{view.fx, view.fy, view.fz}};
  over_springs(view, forces, [&](const SpringArrays& s, int start, BlockForces(&near)[1]) {
    damp_block(view, s, start, near[0]);
  });
}

void row_sums(const LatticeView& view, float* sum) {
  for (int i = 0; i < view.padded_count; ++i) sum[i] = 0.0f;
  // The tangent of a stiffening spring is at most four times its stiffness.
  const float twice = view.spring_weight * (view.stiffening > 0.0f ? 8.0f : 2.0f);
  for (const SpringArrays& s : view.springs) {
    const float* __restrict k = s.stiffness;
    for (int start = 0; start < view.padded_count; start += block) {
      float* __restrict near = sum + start;
      for (int l = 0; l < block; ++l) near[l] += twice * k[start + l];
      float* __restrict far = sum + start + s.offset;
      for (int l = 0; l < block; ++l) far[l] += twice * k[start + l];
    }
  }
  add_volume_row_sums(view, sum);
  join_seam(view, sum);
}

// Returns the power of two that brings the largest component to between 1 and 2, or to between 2 and 4 if it
// is near the largest float. Returns 1 if that component is zero, subnormal or not finite. Products with the
// result are exact, unless they are too small to matter.
inline float find_norm_scale(const float* x, const float* y, const float* z, int count) {
  alignas(64) float lanes[16] = {};
  for (int start = 0; start < count; start += 16) {
    for (int l = 0; l < 16; ++l) {
      const int i = start + l;
      const float ax = __builtin_fabsf(x[i]), ay = __builtin_fabsf(y[i]), az = __builtin_fabsf(z[i]);
      const float xy = ax > ay ? ax : ay, largest = xy > az ? xy : az;
      lanes[l] = largest > lanes[l] ? largest : lanes[l];
    }
  }
  for (int l = 1; l < 16; ++l) lanes[0] = lanes[l] > lanes[0] ? lanes[l] : lanes[0];
  constexpr unsigned exponent_bits = 23, largest_exponent = 254;
  const unsigned exponent = __builtin_bit_cast(unsigned, lanes[0]) >> exponent_bits;
  if (exponent == 0 || exponent > largest_exponent) return 1.0f;
  const unsigned inverse = exponent == largest_exponent ? 1 : largest_exponent - exponent;
  return __builtin_bit_cast(float, inverse << exponent_bits);
}

// Returns sqrt(sum m (x^2 + y^2 + z^2)) with the masses m. The components are multiplied by `scale` before
// they are squared.
inline float scaled_mass_norm(const float* mass, const float* x, const float* y, const float* z, int count,
                              float scale) {
  alignas(64) float lanes[16] = {};
  for (int start = 0; start < count; start += 16) {
    for (int l = 0; l < 16; ++l) {
      const int i = start + l;
      const float sx = x[i] * scale, sy = y[i] * scale, sz = z[i] * scale;
      lanes[l] += mass[i] * (sx * sx + sy * sy + sz * sz);
    }
  }
  for (int l = 1; l < 16; ++l) lanes[0] += lanes[l];
  return __builtin_sqrtf(lanes[0]) / scale;
}

// Returns sqrt(sum m (x^2 + y^2 + z^2)) with the masses m. If the squares overflow or underflow, as those of
// the accelerations of fast lattices do, the sum is scaled.
inline float mass_norm(const float* mass, const float* x, const float* y, const float* z, int count) {
  const float norm = scaled_mass_norm(mass, x, y, z, count, 1.0f);
  if (norm > 1e-10f && norm < 1e18f) return norm;
  return scaled_mass_norm(mass, x, y, z, count, find_norm_scale(x, y, z, count));
}

inline void update_power_vector(float* __restrict w, const float* __restrict f, const float* __restrict noise,
                                const float* __restrict free, float scale, float sign, int count) {
  for (int i = 0; i < count; ++i) w[i] = (f[i] * scale + sign * noise[i]) * free[i];
}

inline void multiply(float* __restrict f, float factor, int count) {
  for (int i = 0; i < count; ++i) f[i] *= factor;
}

inline void divide_by_mass(float* __restrict f, const float* __restrict inverse_mass, int count) {
  for (int i = 0; i < count; ++i) f[i] *= inverse_mass[i];
}

// Finishes a power step after the springs have added their part of -K w to the forces. K is the stiffness, w
// the vector of the power iteration.
float finish_power_step(const LatticeView& view, const float* mass) {
  const int count = view.padded_count;
  multiply(view.fx, view.spring_weight, count);
  multiply(view.fy, view.spring_weight, count);
  multiply(view.fz, view.spring_weight, count);
  subtract_volume_stiffness(view);
  join_seam_forces(view);
  const float before = mass_norm(mass, view.power_x, view.power_y, view.power_z, count);
  divide_by_mass(view.fx, view.inverse_mass, count);
  divide_by_mass(view.fy, view.inverse_mass, count);
  divide_by_mass(view.fz, view.inverse_mass, count);
  const float after = mass_norm(mass, view.fx, view.fy, view.fz, count);
  const float scale = after > 0.0f ? -1.0f / after : 0.0f;  // the forces are -K w
  update_power_vector(view.power_x, view.fx, view.power_noise, view.free_node, scale, 1.0f, count);
  update_power_vector(view.power_y, view.fy, view.power_noise, view.free_node, scale, -1.0f, count);
  update_power_vector(view.power_z, view.fz, view.power_noise, view.free_node, scale, 1.0f, count);
  return before > 0.0f ? after / before : 0.0f;
}

float power_step(const LatticeView& view, const float* mass) {
  clear(view.fx, view.fy, view.fz, view.padded_count);
  add_spring_tangent(view, {view.power_x, view.power_y, view.power_z});
  return finish_power_step(view, mass);
}

float linearise_with_power_step(const LatticeView& view, float tau, Linearised stored, const float* mass) {
  linearise(view, tau, stored, true);
  return finish_power_step(view, mass);
}

}  // namespace

const LatticeKernels lattice_kernels = {
    linearise_springs,
    store_tangents,
    start_forces,
    spring_forces,
    add_weights,
    volume_forces,
    find_flat_cells,
    damp_further,
    kick,
    drift,
    momentum,
    find_range,
    find_largest_square,
    flow,
    creep,
    row_sums,
    measure_rest_volumes,
    power_step,
    linearise_with_power_step,
};

}  // namespace spoonbill::SPOONBILL_KERNELS
