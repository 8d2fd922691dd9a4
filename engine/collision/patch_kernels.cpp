#include "engine/collision/patch_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

namespace {

// Of a slab's size: what rounding may add to an extent.
constexpr double rounding = 1e-14;

// Lanes that no compiler takes apart again; they need not begin on a whole vector.
typedef double Lanes __attribute__((vector_size(slab_lanes * sizeof(double)), aligned(sizeof(double))));

// Four neighbouring sums, each of weights[k] * values[k][j].
template <int bandwidth>
inline __attribute__((always_inline)) void sum_lanes(const double* weights, long weight_stride,
                                                     const double* values, long value_stride, double* sums) {
  Lanes sum = {0.0, 0.0, 0.0, 0.0};
#pragma GCC unroll 10
  for (int k = 0; k < bandwidth; ++k) {
    sum += weights[k * weight_stride] * *reinterpret_cast<const Lanes*>(values + k * value_stride);
  }
  *reinterpret_cast<Lanes*>(sums) = sum;
}

template <int bandwidth_u, int bandwidth_v>
void sample_tile_of(const TileBand& u, const TileBand& v, const PlanarPoints& net, long net_columns,
                    double* lines, const PlanarOutput& samples, long columns) {
  const double* const controls[3] = {net.x, net.y, net.z};
  double* const out[3] = {samples.x, samples.y, samples.z};
  const long padded = v.padded, line_size = 3 * padded;
  for (int k = 0; k < bandwidth_u; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const double* const row = controls[axis] + u.controls[k] * net_columns;
      double picked[bandwidth_v];
      for (int m = 0; m < bandwidth_v; ++m) picked[m] = row[v.controls[m]];
      double* const line = lines + k * line_size + axis * padded;
      for (long j = 0; j < padded; j += slab_lanes) {
        sum_lanes<bandwidth_v>(picked, 1, v.values + j, padded, line + j);
      }
    }
  }
  for (int row = 0; row < u.samples; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      const double* const from = lines + axis * padded;
      double* const to = out[axis] + row * columns;
      long j = 0;
      for (; j + slab_lanes <= v.samples; j += slab_lanes) {
        sum_lanes<bandwidth_u>(u.values + row, u.padded, from + j, line_size, to + j);
      }
      double rest[slab_lanes];
      sum_lanes<bandwidth_u>(u.values + row, u.padded, from + j, line_size, rest);
      for (long k = j; k < v.samples; ++k) to[k] = rest[k - j];
    }
  }
}

using SampleTile = void (*)(const TileBand&, const TileBand&, const PlanarPoints&, long, double*,
                            const PlanarOutput&, long);

template <int bandwidth_u>
constexpr SampleTile tiles_by_bandwidth[] = {nullptr,
                                             nullptr,
                                             sample_tile_of<bandwidth_u, 2>,
                                             sample_tile_of<bandwidth_u, 3>,
                                             sample_tile_of<bandwidth_u, 4>,
                                             sample_tile_of<bandwidth_u, 5>,
                                             sample_tile_of<bandwidth_u, 6>,
                                             sample_tile_of<bandwidth_u, 7>,
                                             sample_tile_of<bandwidth_u, 8>,
                                             sample_tile_of<bandwidth_u, 9>,
                                             sample_tile_of<bandwidth_u, 10>};

constexpr const SampleTile* tiles_by_bandwidths[] = {nullptr,
                                                     nullptr,
                                                     tiles_by_bandwidth<2>,
                                                     tiles_by_bandwidth<3>,
                                                     tiles_by_bandwidth<4>,
                                                     tiles_by_bandwidth<5>,
                                                     tiles_by_bandwidth<6>,
                                                     tiles_by_bandwidth<7>,
                                                     tiles_by_bandwidth<8>,
                                                     tiles_by_bandwidth<9>,
                                                     tiles_by_bandwidth<10>};

void sample_tile(const TileBand& u, const TileBand& v, const PlanarPoints& net, long net_columns,
                 double* lines, const PlanarOutput& samples, long columns) {
  tiles_by_bandwidths[u.bandwidth][v.bandwidth](u, v, net, net_columns, lines, samples, columns);
}

inline __attribute__((always_inline)) double magnitude(double number) {
  return __builtin_fabs(number);
}

inline __attribute__((always_inline)) double larger(double a, double b) {
  return a > b ? a : b;
}

void take_slabs(const PlanarPoints& samples, double bulge, SlabGroup& group) {
  constexpr int low_low[slab_lanes] = {0, 1, 3, 4};
  const double* const values[3] = {samples.x, samples.y, samples.z};
  double twist[3][slab_lanes];
  for (int axis = 0; axis < 3; ++axis) {
    double p00[slab_lanes], p01[slab_lanes], p10[slab_lanes], p11[slab_lanes];
    for (int k = 0; k < slab_lanes; ++k) {
      const double* const corner = values[axis] + low_low[k];
      p00[k] = corner[0];
      p01[k] = corner[1];
      p10[k] = corner[3];
      p11[k] = corner[4];
    }
    for (int k = 0; k < slab_lanes; ++k) {
      const double low = p00[k] + p01[k], high = p10[k] + p11[k];
      const double left = p00[k] + p10[k], right = p01[k] + p11[k];
      group.centre[axis][k] = 0.25 * (low + high);
      group.along_u[axis][k] = 0.25 * (high - low);
      group.along_v[axis][k] = 0.25 * (right - left);
      twist[axis][k] = 0.25 * ((p00[k] - p01[k]) - (p10[k] - p11[k]));
    }
  }
  const auto& u = group.along_u;
  const auto& v = group.along_v;
#pragma GCC unroll 1
  for (int k = 0; k < slab_lanes; ++k) {
    const double x = u[1][k] * v[2][k] - u[2][k] * v[1][k];
    const double y = u[2][k] * v[0][k] - u[0][k] * v[2][k];
    const double z = u[0][k] * v[1][k] - u[1][k] * v[0][k];
    const double squared = x * x + y * y + z * z;
    const bool flat = squared > 0.0;
    const double scale = (flat ? 1.0 : 0.0) / __builtin_sqrt(flat ? squared : 1.0);
    const double nx = x * scale, ny = y * scale, nz = z * scale;
    group.normal[0][k] = nx;
    group.normal[1][k] = ny;
    group.normal[2][k] = nz;
    const double twisted =
        __builtin_sqrt(twist[0][k] * twist[0][k] + twist[1][k] * twist[1][k] + twist[2][k] * twist[2][k]);
    const double size = magnitude(u[0][k]) + magnitude(u[1][k]) + magnitude(u[2][k]) + magnitude(v[0][k]) +
                        magnitude(v[1][k]) + magnitude(v[2][k]) + magnitude(group.centre[0][k]) +
                        magnitude(group.centre[1][k]) + magnitude(group.centre[2][k]);
    const double slack = bulge + twisted + rounding * size;
    // A normal of long, narrow cells is not quite across their sides.
    group.thickness[k] = magnitude(nx * u[0][k] + ny * u[1][k] + nz * u[2][k]) +
                         magnitude(nx * v[0][k] + ny * v[1][k] + nz * v[2][k]) +
                         magnitude(nx * twist[0][k] + ny * twist[1][k] + nz * twist[2][k]) + bulge +
                         rounding * size;
    group.slack[k] = slack;
  }
}

unsigned meeting(const SlabGroup& a, int lanes, const SlabGroup& b, double reach) {
  double gap[slab_lanes * slab_lanes];  // above zero where something lies between
  for (int i = 0; i < lanes; ++i) {
    const double cx = a.centre[0][i], cy = a.centre[1][i], cz = a.centre[2][i];
    const double nx = a.normal[0][i], ny = a.normal[1][i], nz = a.normal[2][i];
    const double ux = a.along_u[0][i], uy = a.along_u[1][i], uz = a.along_u[2][i];
    const double vx = a.along_v[0][i], vy = a.along_v[1][i], vz = a.along_v[2][i];
    const double thick = a.thickness[i] + reach, slack = a.slack[i] + reach;
    // Unrolled too early, the lanes would not become vectors.
#pragma GCC unroll 1
    for (int j = 0; j < slab_lanes; ++j) {
      const double dx = b.centre[0][j] - cx, dy = b.centre[1][j] - cy, dz = b.centre[2][j] - cz;
      const double bux = b.along_u[0][j], buy = b.along_u[1][j], buz = b.along_u[2][j];
      const double bvx = b.along_v[0][j], bvy = b.along_v[1][j], bvz = b.along_v[2][j];
      const double bnx = b.normal[0][j], bny = b.normal[1][j], bnz = b.normal[2][j];
      const double across_a = magnitude(nx * dx + ny * dy + nz * dz);
      const double reach_a = thick + b.slack[j] + magnitude(nx * bux + ny * buy + nz * buz) +
                             magnitude(nx * bvx + ny * bvy + nz * bvz);
      const double across_b = magnitude(bnx * dx + bny * dy + bnz * dz);
      const double reach_b = slack + b.thickness[j] + magnitude(bnx * ux + bny * uy + bnz * uz) +
                             magnitude(bnx * vx + bny * vy + bnz * vz);
      const double squared = dx * dx + dy * dy + dz * dz;
      // squared > along + slacks * length, without the root of squared.
      const double along = magnitude(ux * dx + uy * dy + uz * dz) + magnitude(vx * dx + vy * dy + vz * dz) +
                           magnitude(bux * dx + buy * dy + buz * dz) +
                           magnitude(bvx * dx + bvy * dy + bvz * dz);
      const double beyond = squared - along, slacks = slack + b.slack[j];
      const double between = beyond * magnitude(beyond) - slacks * slacks * squared;
      const double of_normals = larger(across_a - reach_a, across_b - reach_b);
      gap[slab_lanes * i + j] = larger(of_normals, between);
    }
  }
  unsigned bits = 0;
  for (int k = 0; k < lanes * slab_lanes; ++k) bits |= (gap[k] > 0.0 ? 0U : 1U) << k;
  return bits;
}

}  // namespace

const PatchKernels patch_kernels{sample_tile, take_slabs, meeting};

}  // namespace spoonbill::SPOONBILL_KERNELS
