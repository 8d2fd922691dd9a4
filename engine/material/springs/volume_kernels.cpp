#include "engine/material/springs/lattice_kernels.h"
#include "engine/material/springs/speed_cap.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = lattice_block;

struct Vector {
  float x, y, z;
};
inline Vector operator+(Vector a, Vector b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector operator-(Vector a, Vector b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vector operator*(float scale, Vector a) {
  return {scale * a.x, scale * a.y, scale * a.z};
}
inline float dot(Vector a, Vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Face diagonals that determine the volume V of a trilinear cell (corner bits: 1 = k, 2 = j, 4 = i).
// 12 V = (a + b).(c x d) + (c + e).(f x b) + (f + d).(a x e), the mean of the two triangulations of each face
// (Grandy, "Efficient computation of volume of hexahedral cells", UCRL-ID-128886, 1997).
struct FaceDiagonals {
  Vector a;  // from corner 4 to 7
  Vector b;  // from corner 0 to 3
  Vector c;  // from corner 2 to 7
  Vector d;  // from corner 0 to 6
  Vector e;  // from corner 0 to 5
  Vector f;  // from corner 1 to 7
};

inline Vector difference(const float* x, const float* y, const float* z, int from, int to) {
  return {x[to] - x[from], y[to] - y[from], z[to] - z[from]};
}

// Returns the differences of a nodal field along the face diagonals of the cell at node n.
inline FaceDiagonals field_diagonals(const LatticeView& view, const float* x, const float* y, const float* z,
                                     int n) {
  const int* o = view.corner_offset;
  return {difference(x, y, z, n + o[4], n + o[7]), difference(x, y, z, n, n + o[3]),
          difference(x, y, z, n + o[2], n + o[7]), difference(x, y, z, n, n + o[6]),
          difference(x, y, z, n, n + o[5]),        difference(x, y, z, n + o[1], n + o[7])};
}

inline Vector rest_vector(const SpringArrays& s, int n) {
  return {s.rest_x[n], s.rest_y[n], s.rest_z[n]};
}

// Returns the present face diagonals of the cell at node n, from the rest vectors of the springs along them
// and the nodes' displacements.
inline FaceDiagonals present_diagonals(const LatticeView& view, int n) {
  const SpringArrays& jk = view.springs[view.corner_direction[3]];
  const SpringArrays& ik = view.springs[view.corner_direction[5]];
  const SpringArrays& ij = view.springs[view.corner_direction[6]];
  const int* o = view.corner_offset;
  const FaceDiagonals moved = field_diagonals(view, view.dx, view.dy, view.dz, n);
  return {rest_vector(jk, n + o[4]) + moved.a, rest_vector(jk, n) + moved.b,
          rest_vector(ik, n + o[2]) + moved.c, rest_vector(ij, n) + moved.d,
          rest_vector(ik, n) + moved.e,        rest_vector(ij, n + o[1]) + moved.f};
}

// Returns 12 times the volume of a cell with the face diagonals `p`.
inline float volume_sum(const FaceDiagonals& p) {
  return dot(p.a + p.b, cross(p.c, p.d)) + dot(p.c + p.e, cross(p.f, p.b)) + dot(p.f + p.d, cross(p.a, p.e));
}

// Returns the gradient of 12 V, 12 times the cell's volume, with respect to the diagonals.
inline FaceDiagonals volume_gradient(const FaceDiagonals& p) {
  const Vector ab = p.a + p.b, ce = p.c + p.e, fd = p.f + p.d;
  const Vector cd = cross(p.c, p.d), fb = cross(p.f, p.b), ae = cross(p.a, p.e);
  return {cd + cross(p.e, fd), cd + cross(ce, p.f), cross(p.d, ab) + fb,
          cross(ab, p.c) + ae, fb + cross(fd, p.a), cross(p.b, ce) + ae};
}

// Returns the first-order change of 12 V, 12 times the cell's volume, due to the nodal displacements x, y and
// z.
inline float volume_rate(const LatticeView& view, const FaceDiagonals& gradient, const float* x,
                         const float* y, const float* z, int n) {
  const FaceDiagonals v = field_diagonals(view, x, y, z, n);
  return dot(v.a, gradient.a) + dot(v.b, gradient.b) + dot(v.c, gradient.c) + dot(v.d, gradient.d) +
         dot(v.e, gradient.e) + dot(v.f, gradient.f);
}

// Results for one block of cells, corner by corner, to be scattered to the nodes afterwards.
struct BlockCells {
  alignas(64) float x[8][block], y[8][block], z[8][block];

  // Sets the results of cell l at each corner to `scale` times the gradient of its volume with respect to
  // that corner. `gradient` is the gradient with respect to the face diagonals.
  void set(int l, float scale, const FaceDiagonals& gradient) {
    const FaceDiagonals g = {scale * gradient.a, scale * gradient.b, scale * gradient.c,
                             scale * gradient.d, scale * gradient.e, scale * gradient.f};
    set(0, l, Vector{0.0f, 0.0f, 0.0f} - (g.b + g.d + g.e));
    set(1, l, Vector{0.0f, 0.0f, 0.0f} - g.f);
    set(2, l, Vector{0.0f, 0.0f, 0.0f} - g.c);
    set(3, l, g.b);
    set(4, l, Vector{0.0f, 0.0f, 0.0f} - g.a);
    set(5, l, g.e);
    set(6, l, g.d);
    set(7, l, g.a + g.c + g.f);
  }

 private:
  void set(int c, int l, const Vector& v) {
    x[c][l] = v.x;
    y[c][l] = v.y;
    z[c][l] = v.z;
  }
};

// Volume gradients of one block of cells, passed between two loops: a single loop would need more values at
// once than the processor has registers.
struct BlockGradients {
  alignas(64) float number[18][block];

  void set(int l, const FaceDiagonals& g) {
    const Vector all[6] = {g.a, g.b, g.c, g.d, g.e, g.f};
    for (int k = 0; k < 6; ++k) {
      number[3 * k][l] = all[k].x;
      number[3 * k + 1][l] = all[k].y;
      number[3 * k + 2][l] = all[k].z;
    }
  }
  FaceDiagonals at(int l) const {
    const auto vector = [&](int k) {
      return Vector{number[3 * k][l], number[3 * k + 1][l], number[3 * k + 2][l]};
    };
    return {vector(0), vector(1), vector(2), vector(3), vector(4), vector(5)};
  }
};

inline void add_corner_forces(const LatticeView& view, int start, const BlockCells& cells) {
  for (int c = 0; c < 8; ++c) {
    float* __restrict fx = view.fx + start + view.corner_offset[c];
    float* __restrict fy = view.fy + start + view.corner_offset[c];
    float* __restrict fz = view.fz + start + view.corner_offset[c];
    for (int l = 0; l < block; ++l) fx[l] += cells.x[c][l];
    for (int l = 0; l < block; ++l) fy[l] += cells.y[c][l];
    for (int l = 0; l < block; ++l) fz[l] += cells.z[c][l];
  }
}

// Returns the dilation J - 1 of a cell: its volume minus its rest volume, divided by its volume at
// construction. Only SpringLattice::reform() makes the rest volume differ from the volume at construction.
inline float cell_dilation(const LatticeView& view, const FaceDiagonals& p, int n) {
  return (volume_sum(p) - view.rest_volume_sum[n]) * (1.0f / 12.0f) * view.inverse_volume[n];
}

// Dilation below which a cell is crushed.
constexpr float crushed_dilation = -0.7f;

// Returns dp/dJ of a cell's pressure p, times the cell's volume at construction. With a negative bulk
// stiffness, dp/dJ varies with J; the returned value is the one at J = 1, which has the largest magnitude.
inline float volume_tangent(const LatticeView& view, const FaceDiagonals& p, int n) {
  const float crushed = view.crushed_stiffness[n];  // read unconditionally, so that the loop vectorises
  return view.bulk_stiffness[n] + (cell_dilation(view, p, n) < crushed_dilation ? crushed : 0.0f);
}

template <bool softens>
void add_volume_forces(const LatticeView& view) {
  BlockCells cells;
  for (int start = 0; start < view.padded_count; start += block) {
    if (view.active_block[start / block] == 0) continue;
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      const FaceDiagonals p = present_diagonals(view, n);
      float dilation = cell_dilation(view, p, n);
      const float beyond = dilation - crushed_dilation, crushed = beyond < 0.0f ? beyond : 0.0f;
      if (softens) {
        const float softening = view.bulk_stiffness[n] < 0.0f ? 100.0f : 0.0f;
        dilation = dilation / (1.0f + softening * dilation * dilation);
      }
      const float elastic = view.bulk_stiffness[n] * view.inverse_volume[n] * dilation * (1.0f / 12.0f);
      const float resistance = view.crushed_stiffness[n] * view.inverse_volume[n] * crushed * (1.0f / 12.0f);
      cells.set(l, -(elastic + resistance), volume_gradient(p));
    }
    add_corner_forces(view, start, cells);
  }
}

}  // namespace

void volume_forces(const LatticeView& view) {
  if (view.volume_softens) {
    add_volume_forces<true>(view);
  } else {
    add_volume_forces<false>(view);
  }
}

namespace {

// The edge of a cell along an axis at a corner, at rest and at present.
struct CornerEdge {
  Vector rest, present;
};

// `bit` is the axis' bit in the numbers of corners. The edge leads in the direction of the axis.
template <int corner, int bit>
inline CornerEdge corner_edge(const LatticeView& view, int n) {
  const int from = n + view.corner_offset[corner & ~bit], to = n + view.corner_offset[corner | bit];
  const Vector rest = rest_vector(view.springs[view.corner_direction[bit]], from);
  return {rest, rest + difference(view.dx, view.dy, view.dz, from, to)};
}

// Adds 1 for each cell of a block whose `corner` is flat (see find_flat_cells()).
template <int corner>
void count_flat_corners(const LatticeView& view, int start, float ratio, float least,
                        float* __restrict flat) {
  for (int l = 0; l < block; ++l) {
    const int n = start + l;
    const CornerEdge i = corner_edge<corner, 4>(view, n), j = corner_edge<corner, 2>(view, n),
                     k = corner_edge<corner, 1>(view, n);
    const float rest = dot(i.rest, cross(j.rest, k.rest));
    const float present = dot(i.present, cross(j.present, k.present));
    // Products with the volume at rest do not depend on the orientation of the axes.
    const float inverse = view.inverse_volume[n], square = rest * rest;
    const float limit = ratio * view.rest_volume_sum[n] * (1.0f / 12.0f) * inverse * square;
    const float has_cell = view.has_cell[n];  // read unconditionally, so that the loop vectorises
    const float counts = square * inverse * inverse < least * least ? 0.0f : has_cell;
    flat[l] += present * rest < limit ? counts : 0.0f;
  }
}

}  // namespace

bool find_flat_cells(const LatticeView& view, float ratio, float least, unsigned char* flat) {
  bool any = false;
  for (int start = 0; start < view.padded_count; start += block) {
    alignas(64) float corners[block] = {};
    count_flat_corners<0>(view, start, ratio, least, corners);
    count_flat_corners<1>(view, start, ratio, least, corners);
    count_flat_corners<2>(view, start, ratio, least, corners);
    count_flat_corners<3>(view, start, ratio, least, corners);
    count_flat_corners<4>(view, start, ratio, least, corners);
    count_flat_corners<5>(view, start, ratio, least, corners);
    count_flat_corners<6>(view, start, ratio, least, corners);
    count_flat_corners<7>(view, start, ratio, least, corners);
    any = any || largest_value(corners) > 0.0f;
    for (int l = 0; l < block; ++l) flat[start + l] = corners[l] > 0.0f ? 1 : 0;
  }
  return any;
}

void average_dilations(const LatticeView& view) {
  alignas(64) float dilation[block];
  for (int i = 0; i < view.padded_count; ++i) view.node_dilation[i] = 0.0f;
  for (int start = 0; start < view.padded_count; start += block) {
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      dilation[l] = (1.0f + cell_dilation(view, present_diagonals(view, n), n)) * view.has_cell[n];
    }
    for (int c = 0; c < 8; ++c) {
      float* __restrict j = view.node_dilation + start + view.corner_offset[c];
      for (int l = 0; l < block; ++l) j[l] += dilation[l];
    }
  }
  join_seam(view, view.node_dilation);
  for (int i = 0; i < view.padded_count; ++i) view.node_dilation[i] *= view.inverse_cell_count[i];
}

void add_volume_row_sums(const LatticeView& view, float* sum) {
  alignas(64) float fraction[8][block];
  for (int start = 0; start < view.padded_count; start += block) {
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      const FaceDiagonals p = present_diagonals(view, n), g = volume_gradient(p);
      const Vector by_corner[8] = {g.b + g.d + g.e, g.f, g.c, g.b, g.a, g.e, g.d, g.a + g.c + g.f};
      float length[8], total = 0.0f;
      for (int c = 0; c < 8; ++c) {
        length[c] = __builtin_sqrtf(dot(by_corner[c], by_corner[c]));
        total += length[c];
      }
      const float inverse = view.inverse_volume[n] * (1.0f / 12.0f);
      const float bulk = volume_tangent(view, p, n);
      const float scale = (bulk < 0.0f ? -bulk : bulk) * inverse * inverse * total;
      for (int c = 0; c < 8; ++c) fraction[c][l] = scale * length[c];
    }
    for (int c = 0; c < 8; ++c) {
      float* __restrict to = sum + start + view.corner_offset[c];
      for (int l = 0; l < block; ++l) to[l] += fraction[c][l];
    }
  }
}

void subtract_volume_stiffness(const LatticeView& view) {
  BlockCells cells;
  BlockGradients gradients;
  alignas(64) float factor[block];
  for (int start = 0; start < view.padded_count; start += block) {
    if (view.active_block[start / block] == 0) continue;
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      const FaceDiagonals p = present_diagonals(view, n);
      const float inverse = view.inverse_volume[n] * (1.0f / 12.0f);
      factor[l] = -volume_tangent(view, p, n) * inverse * inverse;
      gradients.set(l, volume_gradient(p));
    }
    for (int l = 0; l < block; ++l) {
      const FaceDiagonals gradient = gradients.at(l);
      const float rate = volume_rate(view, gradient, view.power_x, view.power_y, view.power_z, start + l);
      cells.set(l, factor[l] * rate, gradient);
    }
    add_corner_forces(view, start, cells);
  }
}

void measure_rest_volumes(const LatticeView& view) {
  for (int n = 0; n < view.padded_count; ++n) {
    view.rest_volume_sum[n] = volume_sum(present_diagonals(view, n));
  }
}

}  // namespace spoonbill::SPOONBILL_KERNELS
