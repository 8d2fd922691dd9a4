#include "engine/collision/levels/patch_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {

namespace {

// The rounding error of a slab's extent in single precision is at most size_rounding times the slab's size
// plus position_rounding times the sum of the magnitudes of its centre's coordinates.
constexpr double size_rounding = 1e-6;
constexpr double position_rounding = 2.5e-7;
// Bound of the relative rounding error of the offset between two centres.
constexpr float offset_rounding = 1e-6F;
constexpr float rounded_down = 1.0F - 1e-5F;
constexpr float rounded_up = 1.0F + 1e-5F;

// Vector of one double per lane. It may be at any address that is aligned for a double.
typedef double Lanes __attribute__((vector_size(slab_lanes * sizeof(double)), aligned(sizeof(double))));

// Computes, for four consecutive j, the sum of weights[k] * values[k][j] over k.
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
void sample_tile_with(const TileBand& u, const TileBand& v, const PlanarPoints& net, long net_columns,
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
                                             sample_tile_with<bandwidth_u, 2>,
                                             sample_tile_with<bandwidth_u, 3>,
                                             sample_tile_with<bandwidth_u, 4>,
                                             sample_tile_with<bandwidth_u, 5>,
                                             sample_tile_with<bandwidth_u, 6>,
                                             sample_tile_with<bandwidth_u, 7>,
                                             sample_tile_with<bandwidth_u, 8>,
                                             sample_tile_with<bandwidth_u, 9>,
                                             sample_tile_with<bandwidth_u, 10>};

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

void compute_slabs(const PlanarPoints& samples, double bulge, SlabGroup& group) {
  constexpr int low_low[slab_lanes] = {0, 1, 3, 4};
  const double* const values[3] = {samples.x, samples.y, samples.z};
  double centre[3][slab_lanes], u[3][slab_lanes], v[3][slab_lanes], twist[3][slab_lanes];
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
      centre[axis][k] = 0.25 * (low + high);
      u[axis][k] = 0.25 * (high - low);
      v[axis][k] = 0.25 * (right - left);
      twist[axis][k] = 0.25 * ((p00[k] - p01[k]) - (p10[k] - p11[k]));
      group.centre[axis][k] = static_cast<float>(centre[axis][k]);
      group.along_u[axis][k] = static_cast<float>(u[axis][k]);
      group.along_v[axis][k] = static_cast<float>(v[axis][k]);
    }
  }
  // Without this pragma, GCC unrolls the loop early and does not vectorise the lanes.
#pragma GCC unroll 1
  for (int k = 0; k < slab_lanes; ++k) {
    const double x = u[1][k] * v[2][k] - u[2][k] * v[1][k];
    const double y = u[2][k] * v[0][k] - u[0][k] * v[2][k];
    const double z = u[0][k] * v[1][k] - u[1][k] * v[0][k];
    const double squared = x * x + y * y + z * z;
    const bool has_normal = squared > 0.0;
    const double scale = (has_normal ? 1.0 : 0.0) / __builtin_sqrt(has_normal ? squared : 1.0);
    const double nx = x * scale, ny = y * scale, nz = z * scale;
    group.normal[0][k] = static_cast<float>(nx);
    group.normal[1][k] = static_cast<float>(ny);
    group.normal[2][k] = static_cast<float>(nz);
    const double twisted =
        __builtin_sqrt(twist[0][k] * twist[0][k] + twist[1][k] * twist[1][k] + twist[2][k] * twist[2][k]);
    const double size = magnitude(u[0][k]) + magnitude(u[1][k]) + magnitude(u[2][k]) + magnitude(v[0][k]) +
                        magnitude(v[1][k]) + magnitude(v[2][k]) + twisted + bulge;
    const double position = magnitude(centre[0][k]) + magnitude(centre[1][k]) + magnitude(centre[2][k]);
    const double margin = bulge + size_rounding * size + position_rounding * position;
    // The thickness includes the sides' offsets along the normal, because rounding tilts the normal of a
    // long, narrow cell.
    group.thickness[k] =
        static_cast<float>(magnitude(nx * u[0][k] + ny * u[1][k] + nz * u[2][k]) +
                           magnitude(nx * v[0][k] + ny * v[1][k] + nz * v[2][k]) +
                           magnitude(nx * twist[0][k] + ny * twist[1][k] + nz * twist[2][k]) + margin);
    group.slack[k] = static_cast<float>(twisted + margin);
  }
}

// Number of slabs of the first surface that are tested at once against four slabs of the second surface.
#ifdef __AVX__
constexpr int slabs_at_once = 2;
#else
constexpr int slabs_at_once = 1;
#endif
constexpr int lanes_at_once = slabs_at_once * slab_lanes;
typedef float Many __attribute__((vector_size(lanes_at_once * sizeof(float))));
typedef int ManyBits __attribute__((vector_size(lanes_at_once * sizeof(int))));
typedef float Four __attribute__((vector_size(slab_lanes * sizeof(float)), aligned(sizeof(float))));

struct ManyVectors {
  Many x, y, z;
};

// Repeats the four lanes for each of the `slabs_at_once` slabs. `Out` is a template parameter so that only
// the branch for its size is compiled.
template <int a = 0>
struct RepeatAll {
  template <class Out>
  inline __attribute__((always_inline)) void operator()(const float* lanes, Out& out) const {
    const Four four = *reinterpret_cast<const Four*>(lanes);
    if constexpr (sizeof(Out) == sizeof(Four)) {
      out = __builtin_shufflevector(four, four, a, a + 1, a + 2, a + 3);
    } else {
      out = __builtin_shufflevector(four, four, a, a + 1, a + 2, a + 3, a, a + 1, a + 2, a + 3);
    }
  }
};
// Repeats lane `first` four times. If two slabs are tested at once, also repeats the next lane four times.
template <int first>
struct RepeatEach {
  template <class Out>
  inline __attribute__((always_inline)) void operator()(const float* lanes, Out& out) const {
    const Four four = *reinterpret_cast<const Four*>(lanes);
    if constexpr (sizeof(Out) == sizeof(Four)) {
      out = __builtin_shufflevector(four, four, first, first, first, first);
    } else {
      constexpr int next = first + 1;
      out = __builtin_shufflevector(four, four, first, first, first, first, next, next, next, next);
    }
  }
};

template <class Spread>
inline __attribute__((always_inline)) void spread(const Spread& spreader, const float (&lanes)[3][slab_lanes],
                                                  ManyVectors& out) {
  spreader(lanes[0], out.x);
  spreader(lanes[1], out.y);
  spreader(lanes[2], out.z);
}

inline __attribute__((always_inline)) void store_magnitude(const Many& number, Many& out) {
  out = reinterpret_cast<Many>(reinterpret_cast<ManyBits>(number) & 0x7fffffff);
}

inline __attribute__((always_inline)) void store_product_magnitude(const ManyVectors& a, const ManyVectors& b,
                                                                   Many& out) {
  store_magnitude(a.x * b.x + a.y * b.y + a.z * b.z, out);
}

struct ManySlabs {
  ManyVectors centre, u, v, normal;
  Many thickness, slack;
};

template <class Spread>
inline __attribute__((always_inline)) void spread_slabs(const Spread& spreader, const SlabGroup& group,
                                                        ManySlabs& slabs) {
  spread(spreader, group.centre, slabs.centre);
  spread(spreader, group.along_u, slabs.u);
  spread(spreader, group.along_v, slabs.v);
  spread(spreader, group.normal, slabs.normal);
  spreader(group.thickness, slabs.thickness);
  spreader(group.slack, slabs.slack);
}

// Sets the lanes in which a plane separates the two slabs by more than `reach` to -1, and all other lanes to
// 0.
inline __attribute__((always_inline)) void find_separated(const ManySlabs& a, const ManySlabs& b, float reach,
                                                          ManyBits& separated) {
  const ManyVectors offset = {b.centre.x - a.centre.x, b.centre.y - a.centre.y, b.centre.z - a.centre.z};
  Many x, y, z;
  store_magnitude(offset.x, x);
  store_magnitude(offset.y, y);
  store_magnitude(offset.z, z);
  const Many further = offset_rounding * (x + y + z) + reach;
  Many across_a, u_a, v_a, across_b, u_b, v_b;
  store_product_magnitude(a.normal, offset, across_a);
  store_product_magnitude(a.normal, b.u, u_a);
  store_product_magnitude(a.normal, b.v, v_a);
  store_product_magnitude(b.normal, offset, across_b);
  store_product_magnitude(b.normal, a.u, u_b);
  store_product_magnitude(b.normal, a.v, v_b);
  separated = across_a > a.thickness + b.slack + u_a + v_a + further;
  separated |= across_b > b.thickness + a.slack + u_b + v_b + further;
  // A plane perpendicular to the line between the centres separates the slabs if `beyond` is greater than
  // `slack` times the length of that line. Both sides are squared, so that no root is needed.
  Many au, av, bu, bv;
  store_product_magnitude(a.u, offset, au);
  store_product_magnitude(a.v, offset, av);
  store_product_magnitude(b.u, offset, bu);
  store_product_magnitude(b.v, offset, bv);
  const Many squared = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
  const Many beyond = rounded_down * squared - (au + av + bu + bv),
             slack = rounded_up * (a.slack + b.slack + reach);
  separated |= (beyond > 0.0F) & (beyond * beyond > slack * slack * squared);
}

// Returns a bit mask with one bit for each lane.
inline __attribute__((always_inline)) unsigned lane_bits(const ManyBits& lanes) {
#ifdef __AVX__
  return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<Many>(lanes)));
#else
  unsigned bits = 0;
  for (int k = 0; k < lanes_at_once; ++k) bits |= static_cast<unsigned>(-lanes[k]) << k;
  return bits;
#endif
}

// Tests `slabs_at_once` slabs of `a`, starting with slab `first`, against all slabs of `b`. Returns the bits
// of the pairs that are not separated.
template <int first>
inline __attribute__((always_inline)) unsigned find_meeting_from(const SlabGroup& a, const ManySlabs& b,
                                                                 float reach) {
  ManySlabs slabs;
  ManyBits separated;
  spread_slabs(RepeatEach<first>{}, a, slabs);
  find_separated(slabs, b, reach, separated);
  constexpr unsigned all = (1U << lanes_at_once) - 1U;
  return (~lane_bits(separated) & all) << (slab_lanes * first);
}

unsigned find_meeting(const SlabGroup& a, int lanes, const SlabGroup& b, float reach) {
  ManySlabs second;
  spread_slabs(RepeatAll<>{}, b, second);
  unsigned bits = find_meeting_from<0>(a, second, reach);
  if (lanes == 1) return bits & 15U;
  if constexpr (slabs_at_once == 1) {
    bits |= find_meeting_from<1>(a, second, reach) | find_meeting_from<3>(a, second, reach);
  }
  return bits | find_meeting_from<2>(a, second, reach);
}

}  // namespace

const PatchKernels patch_kernels{sample_tile, compute_slabs, find_meeting};

}  // namespace spoonbill::SPOONBILL_KERNELS
