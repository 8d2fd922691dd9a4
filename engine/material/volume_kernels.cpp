#include "engine/material/volume_kernels.h"

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
inline float dot(Vector a, Vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Twelve times the gradient of a trilinear cell's volume by its corners 1..7, for corner 0 at the origin
// (corner 0's own is minus their sum). Each quad face a, b, c, d, seen from outside counter-clockwise, adds
// the mean of its two triangulations: (a.(b x c) + a.(c x d) + a.(b x d) + b.(c x d)) / 12. Corner bits: 1 =
// k, 2 = j, 4 = i.
struct Gradient {
  Vector g[8];
};
inline void add_far_face(const Vector* p, Vector* g, int a, int b, int c, int d) {
  const Vector ab = cross(p[a], p[b]), bc = cross(p[b], p[c]), cd = cross(p[c], p[d]), da = cross(p[d], p[a]);
  const Vector ac = cross(p[a], p[c]), bd = cross(p[b], p[d]);
  g[a] = g[a] + bc + cd + bd;
  g[b] = g[b] + cd + da - ac;
  g[c] = g[c] + da + ab - bd;
  g[d] = g[d] + ab + bc + ac;
}
inline void add_near_face(const Vector* p, Vector* g, int b, int c, int d) {
  const Vector bc = cross(p[b], p[c]), cd = cross(p[c], p[d]), bd = cross(p[b], p[d]);
  g[b] = g[b] + cd;
  g[c] = g[c] - bd;
  g[d] = g[d] + bc;
}
inline Gradient volume_gradient(const Vector* p) {
  Gradient result;
  Vector* g = result.g;
  for (int c = 0; c < 8; ++c) g[c] = {0.0f, 0.0f, 0.0f};
  add_near_face(p, g, 1, 3, 2);
  add_near_face(p, g, 2, 6, 4);
  add_near_face(p, g, 4, 5, 1);
  add_far_face(p, g, 4, 6, 7, 5);
  add_far_face(p, g, 2, 3, 7, 6);
  add_far_face(p, g, 1, 5, 7, 3);
  g[0] = Vector{0.0f, 0.0f, 0.0f} - (g[1] + g[2] + g[3] + g[4] + g[5] + g[6] + g[7]);
  return result;
}

// The corners of the cell at node n relative to its first.
inline void cell_corners(const LatticeView& view, int n, Vector* p) {
  p[0] = {0.0f, 0.0f, 0.0f};
  for (int c = 1; c < 8; ++c) {
    const SpringArrays& s = view.springs[view.corner_direction[c]];
    const int m = n + view.corner_offset[c];
    p[c] = {s.rest_x[n] + (view.dx[m] - view.dx[n]), s.rest_y[n] + (view.dy[m] - view.dy[n]),
            s.rest_z[n] + (view.dz[m] - view.dz[n])};
  }
}

// 36 times the volume, by Euler's theorem for the homogeneous cubic V: 3 V = sum x . dV/dx.
inline float volume_sum(const Vector* p, const Gradient& gradient) {
  float sum = 0.0f;
  for (int c = 1; c < 8; ++c) sum += dot(p[c], gradient.g[c]);
  return sum;
}

// Corner-major results of one block of cells, scattered afterwards.
struct BlockCells {
  alignas(64) float x[8][block], y[8][block], z[8][block];
  alignas(64) float dilation[block];
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

void volume_block(const LatticeView& view, int start, float tau, BlockCells& out) {
  for (int l = 0; l < block; ++l) {
    const int n = start + l;
    Vector p[8];
    cell_corners(view, n, p);
    const Gradient gradient = volume_gradient(p);
    float rate = 0.0f;
    for (int c = 0; c < 8; ++c) {
      const int m = n + view.corner_offset[c];
      rate += dot({view.vx[m], view.vy[m], view.vz[m]}, gradient.g[c]);
    }
    const float dilation =
        (volume_sum(p, gradient) - view.rest_volume_sum[n]) * (1.0f / 36.0f) * view.inverse_volume[n];
    const float strain = dilation + tau * (rate * (1.0f / 12.0f) * view.inverse_volume[n]);
    const float scale = -view.bulk_stiffness[n] * view.inverse_volume[n] * strain * (1.0f / 12.0f);
    for (int c = 0; c < 8; ++c) {
      out.x[c][l] = scale * gradient.g[c].x;
      out.y[c][l] = scale * gradient.g[c].y;
      out.z[c][l] = scale * gradient.g[c].z;
    }
    out.dilation[l] = (1.0f + dilation) * view.has_cell[n];
  }
}

}  // namespace

void volume_forces(const LatticeView& view, float tau) {
  BlockCells cells;
  for (int i = 0; i < view.padded_count; ++i) view.node_dilation[i] = 0.0f;
  for (int start = 0; start < view.padded_count; start += block) {
    volume_block(view, start, tau, cells);
    add_corner_forces(view, start, cells);
    for (int c = 0; c < 8; ++c) {
      float* __restrict j = view.node_dilation + start + view.corner_offset[c];
      for (int l = 0; l < block; ++l) j[l] += cells.dilation[l];
    }
  }
  for (int i = 0; i < view.padded_count; ++i) view.node_dilation[i] *= view.inverse_cell_count[i];
}

void add_volume_row_sums(const LatticeView& view, float* sum) {
  alignas(64) float share[8][block];
  for (int start = 0; start < view.padded_count; start += block) {
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      Vector p[8];
      cell_corners(view, n, p);
      const Gradient gradient = volume_gradient(p);
      float length[8], total = 0.0f;
      for (int c = 0; c < 8; ++c) {
        length[c] = __builtin_sqrtf(dot(gradient.g[c], gradient.g[c]));
        total += length[c];
      }
      const float inverse = view.inverse_volume[n] * (1.0f / 12.0f);
      const float scale = view.bulk_stiffness[n] * inverse * inverse * total;
      for (int c = 0; c < 8; ++c) share[c][l] = scale * length[c];
    }
    for (int c = 0; c < 8; ++c) {
      float* __restrict to = sum + start + view.corner_offset[c];
      for (int l = 0; l < block; ++l) to[l] += share[c][l];
    }
  }
}

void add_volume_stiffness(const LatticeView& view) {
  BlockCells cells;
  for (int start = 0; start < view.padded_count; start += block) {
    for (int l = 0; l < block; ++l) {
      const int n = start + l;
      Vector p[8];
      cell_corners(view, n, p);
      const Gradient gradient = volume_gradient(p);
      float rate = 0.0f;
      for (int c = 0; c < 8; ++c) {
        const int m = n + view.corner_offset[c];
        rate += dot({view.power_x[m], view.power_y[m], view.power_z[m]}, gradient.g[c]);
      }
      const float inverse = view.inverse_volume[n] * (1.0f / 12.0f);
      const float scale = view.bulk_stiffness[n] * inverse * inverse * rate;
      for (int c = 0; c < 8; ++c) {
        cells.x[c][l] = scale * gradient.g[c].x;
        cells.y[c][l] = scale * gradient.g[c].y;
        cells.z[c][l] = scale * gradient.g[c].z;
      }
    }
    add_corner_forces(view, start, cells);
  }
}

void measure_rest_volumes(const LatticeView& view) {
  for (int n = 0; n < view.padded_count; ++n) {
    Vector p[8];
    cell_corners(view, n, p);
    view.rest_volume_sum[n] = volume_sum(p, volume_gradient(p));
  }
}

}  // namespace spoonbill::SPOONBILL_KERNELS
