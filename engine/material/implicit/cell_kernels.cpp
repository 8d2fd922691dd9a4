#include "engine/material/implicit/cell_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int lanes = cell_lanes;
constexpr int rotation_steps = 3;

using Lanes = double[lanes];
using Field = double[cell_axes][lanes];

inline double magnitude(double a) {
  return a < 0.0 ? -a : a;
}

// Copies a nodal field at the corners of each cell to `to`, relative to its mean over the cell's corners.
inline void gather(const CellBatch& b, const double* from, Field& to) {
  for (int c = 0; c < 8; ++c) {
    for (int l = 0; l < lanes; ++l) {
      const double* const at = from + 3L * b.node[c][l];
      to[3 * c][l] = at[0];
      to[3 * c + 1][l] = at[1];
      to[3 * c + 2][l] = at[2];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    Lanes mean;
    for (int l = 0; l < lanes; ++l) {
      mean[l] = 0.125 * (((to[axis][l] + to[axis + 3][l]) + (to[axis + 6][l] + to[axis + 9][l])) +
                         ((to[axis + 12][l] + to[axis + 15][l]) + (to[axis + 18][l] + to[axis + 21][l])));
    }
    for (int c = 0; c < 8; ++c) {
      for (int l = 0; l < lanes; ++l) to[3 * c + axis][l] -= mean[l];
    }
  }
}

// Rotates the corner vectors `from` of each cell by R = 1 + turn, scales them and adds them to the nodal
// field `to`.
inline void scatter(const CellBatch& b, const Field& from, double scale, double* to) {
  for (int c = 0; c < 8; ++c) {
    Lanes x, y, z;
    for (int l = 0; l < lanes; ++l) {
      const double fx = scale * from[3 * c][l], fy = scale * from[3 * c + 1][l],
                   fz = scale * from[3 * c + 2][l];
      x[l] = fx + (b.turn[0][l] * fx + b.turn[1][l] * fy + b.turn[2][l] * fz);
      y[l] = fy + (b.turn[3][l] * fx + b.turn[4][l] * fy + b.turn[5][l] * fz);
      z[l] = fz + (b.turn[6][l] * fx + b.turn[7][l] * fy + b.turn[8][l] * fz);
    }
    for (int l = 0; l < lanes; ++l) {
      double* const at = to + 3L * b.node[c][l];
      at[0] += x[l];
      at[1] += y[l];
      at[2] += z[l];
    }
  }
}

// Rotates each corner's vector by R^T.
inline void rotate_back(const CellBatch& b, Field& field) {
  for (int c = 0; c < 8; ++c) {
    for (int l = 0; l < lanes; ++l) {
      const double x = field[3 * c][l], y = field[3 * c + 1][l], z = field[3 * c + 2][l];
      field[3 * c][l] = x + (b.turn[0][l] * x + b.turn[3][l] * y + b.turn[6][l] * z);
      field[3 * c + 1][l] = y + (b.turn[1][l] * x + b.turn[4][l] * y + b.turn[7][l] * z);
      field[3 * c + 2][l] = z + (b.turn[2][l] * x + b.turn[5][l] * y + b.turn[8][l] * z);
    }
  }
}

struct Matrix {
  double at[9][lanes];
};

// Computes the displacement gradient sum d_i g_i^T from the displacements d_i and the shape function
// gradients g_i of the corners.
inline void compute_gradient(const CellBatch& b, const Field& moved, Matrix& change) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      double* const to = change.at[3 * row + column];
      for (int l = 0; l < lanes; ++l) to[l] = 0.0;
      for (int c = 0; c < 8; ++c) {
        for (int l = 0; l < lanes; ++l) to[l] += moved[3 * c + row][l] * b.gradient[3 * c + column][l];
      }
    }
  }
}

// Computes R - 1 = 2 w [v] + 2 [v]^2 from the unit quaternion w + v. [v] is the cross-product matrix of v.
inline void compute_turn(CellBatch& b) {
  for (int l = 0; l < lanes; ++l) {
    const double w = b.quaternion[0][l], x = b.quaternion[1][l], y = b.quaternion[2][l],
                 z = b.quaternion[3][l];
    b.turn[0][l] = -2.0 * (y * y + z * z);
    b.turn[1][l] = 2.0 * (x * y - w * z);
    b.turn[2][l] = 2.0 * (x * z + w * y);
    b.turn[3][l] = 2.0 * (x * y + w * z);
    b.turn[4][l] = -2.0 * (x * x + z * z);
    b.turn[5][l] = 2.0 * (y * z - w * x);
    b.turn[6][l] = 2.0 * (x * z - w * y);
    b.turn[7][l] = 2.0 * (y * z + w * x);
    b.turn[8][l] = -2.0 * (x * x + y * y);
  }
}

// Computes S - 1 = T^T + H + T^T H for the stretch S, the turn T = R - 1 and the displacement gradient H.
// This form keeps the digits of small values.
inline void compute_stretch(const CellBatch& b, const Matrix& h, Matrix& stretch) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (int l = 0; l < lanes; ++l) {
        const double product = b.turn[row][l] * h.at[column][l] + b.turn[3 + row][l] * h.at[3 + column][l] +
                               b.turn[6 + row][l] * h.at[6 + column][l];
        stretch.at[3 * row + column][l] = b.turn[3 * column + row][l] + h.at[3 * row + column][l] + product;
      }
    }
  }
}

// Computes the inverse of tr S - S for the symmetric part of the stretch S. The matrix of a crushed cell is
// nearly singular; its inverse is replaced by that of an unstrained cell.
inline void compute_spin_map(CellBatch& b, const Matrix& s) {
  for (int l = 0; l < lanes; ++l) {
    const double xx = 1.0 + s.at[0][l], yy = 1.0 + s.at[4][l], zz = 1.0 + s.at[8][l];
    const double xy = 0.5 * (s.at[1][l] + s.at[3][l]), xz = 0.5 * (s.at[2][l] + s.at[6][l]),
                 yz = 0.5 * (s.at[5][l] + s.at[7][l]);
    const double a = yy + zz, d = xx + zz, f = xx + yy;
    const double minor_a = d * f - yz * yz, minor_b = xy * f + yz * xz, minor_c = xy * yz + d * xz;
    const double determinant = a * minor_a - xy * minor_b - xz * minor_c;
    const bool regular = a > 0.1 && d > 0.1 && f > 0.1 && determinant > 0.1;
    const double inverse = regular ? 1.0 / determinant : 0.0, plain = regular ? 0.0 : 0.5;
    b.spin_map[0][l] = plain + inverse * minor_a;
    b.spin_map[1][l] = inverse * minor_b;
    b.spin_map[2][l] = inverse * minor_c;
    b.spin_map[3][l] = inverse * minor_b;
    b.spin_map[4][l] = plain + inverse * (a * f - xz * xz);
    b.spin_map[5][l] = inverse * (a * yz + xy * xz);
    b.spin_map[6][l] = inverse * minor_c;
    b.spin_map[7][l] = inverse * (a * yz + xy * xz);
    b.spin_map[8][l] = plain + inverse * (a * d - xy * xy);
  }
}

struct Rotation {
  double x[lanes], y[lanes], z[lanes];
};

inline void spin_map_times(const CellBatch& b, const Rotation& a, Rotation& result) {
  for (int l = 0; l < lanes; ++l) {
    result.x[l] = b.spin_map[0][l] * a.x[l] + b.spin_map[1][l] * a.y[l] + b.spin_map[2][l] * a.z[l];
    result.y[l] = b.spin_map[3][l] * a.x[l] + b.spin_map[4][l] * a.y[l] + b.spin_map[5][l] * a.z[l];
    result.z[l] = b.spin_map[6][l] * a.x[l] + b.spin_map[7][l] * a.y[l] + b.spin_map[8][l] * a.z[l];
  }
}

// Rotates the cells by one Newton step. The rotation is limited to half a radian: a longer step has a useful
// direction, but not a useful length.
inline void rotate_further(CellBatch& b, const Matrix& s) {
  Rotation skew, w;
  for (int l = 0; l < lanes; ++l) {
    skew.x[l] = s.at[7][l] - s.at[5][l];
    skew.y[l] = s.at[2][l] - s.at[6][l];
    skew.z[l] = s.at[3][l] - s.at[1][l];
  }
  spin_map_times(b, skew, w);
  for (int l = 0; l < lanes; ++l) {
    const double size = magnitude(w.x[l]) + magnitude(w.y[l]) + magnitude(w.z[l]);
    const double half = 0.5 * (size > 0.5 ? 0.5 / size : 1.0);
    const double x = half * w.x[l], y = half * w.y[l], z = half * w.z[l];
    const double qw = b.quaternion[0][l], qx = b.quaternion[1][l], qy = b.quaternion[2][l],
                 qz = b.quaternion[3][l];
    const double nw = qw - (qx * x + qy * y + qz * z);
    const double nx = qx + (qw * x + qy * z - qz * y);
    const double ny = qy + (qw * y + qz * x - qx * z);
    const double nz = qz + (qw * z + qx * y - qy * x);
    const double inverse = 1.0 / __builtin_sqrt(nw * nw + nx * nx + ny * ny + nz * nz);
    b.quaternion[0][l] = inverse * nw;
    b.quaternion[1][l] = inverse * nx;
    b.quaternion[2][l] = inverse * ny;
    b.quaternion[3][l] = inverse * nz;
  }
}

inline void update_turn(CellBatch& b, const Field& moved) {
  Matrix change, stretch;
  compute_gradient(b, moved, change);
  for (int step = 0; step < rotation_steps; ++step) {
    compute_turn(b);
    compute_stretch(b, change, stretch);
    compute_spin_map(b, stretch);
    rotate_further(b, stretch);
  }
  compute_turn(b);
  compute_stretch(b, change, stretch);
  compute_spin_map(b, stretch);
}

// Computes K times a field, where only the lower half of the stiffness K is stored.
inline void stiffness_times(const CellBatch& b, const Field& field, Field& result) {
  for (int a = 0; a < cell_axes; ++a) {
    for (int l = 0; l < lanes; ++l) result[a][l] = 0.0;
  }
  const double(*k)[lanes] = b.stiffness;
  for (int row = 0; row < cell_axes; ++row) {
    Lanes sum;
    for (int l = 0; l < lanes; ++l) sum[l] = 0.0;
    for (int column = 0; column < row; ++column, ++k) {
      for (int l = 0; l < lanes; ++l) {
        const double stiffness = (*k)[l];
        sum[l] += stiffness * field[column][l];
        result[column][l] += stiffness * field[row][l];
      }
    }
    for (int l = 0; l < lanes; ++l) result[row][l] += sum[l] + (*k)[l] * field[row][l];
    ++k;
  }
}

// Sets f to P^T f = f + G^T [x~]^T f (see CorotatedCell::respond()). With the moment m = sum x~_i x f_i and
// the spin map A, f_i becomes f_i + g_i x (A m).
inline void project_transposed(const CellBatch& b, Field& f) {
  Rotation moment, m;
  for (int l = 0; l < lanes; ++l) moment.x[l] = moment.y[l] = moment.z[l] = 0.0;
  for (int c = 0; c < 24; c += 3) {
    for (int l = 0; l < lanes; ++l) {
      moment.x[l] += b.rotated_back[c + 1][l] * f[c + 2][l] - b.rotated_back[c + 2][l] * f[c + 1][l];
      moment.y[l] += b.rotated_back[c + 2][l] * f[c][l] - b.rotated_back[c][l] * f[c + 2][l];
      moment.z[l] += b.rotated_back[c][l] * f[c + 1][l] - b.rotated_back[c + 1][l] * f[c][l];
    }
  }
  spin_map_times(b, moment, m);
  for (int c = 0; c < 24; c += 3) {
    for (int l = 0; l < lanes; ++l) {
      const double x = b.gradient[c][l], y = b.gradient[c + 1][l], z = b.gradient[c + 2][l];
      f[c][l] += y * m.z[l] - z * m.y[l];
      f[c + 1][l] += z * m.x[l] - x * m.z[l];
      f[c + 2][l] += x * m.y[l] - y * m.x[l];
    }
  }
}

// Sets d to P d (see CorotatedCell::respond()): d_i becomes d_i - w x x~_i, with w = A sum g_i x d_i and the
// spin map A.
inline void project(const CellBatch& b, Field& d) {
  Rotation spin, w;
  for (int l = 0; l < lanes; ++l) spin.x[l] = spin.y[l] = spin.z[l] = 0.0;
  for (int c = 0; c < 24; c += 3) {
    for (int l = 0; l < lanes; ++l) {
      const double x = b.gradient[c][l], y = b.gradient[c + 1][l], z = b.gradient[c + 2][l];
      spin.x[l] += y * d[c + 2][l] - z * d[c + 1][l];
      spin.y[l] += z * d[c][l] - x * d[c + 2][l];
      spin.z[l] += x * d[c + 1][l] - y * d[c][l];
    }
  }
  spin_map_times(b, spin, w);
  for (int c = 0; c < 24; c += 3) {
    for (int l = 0; l < lanes; ++l) {
      const double x = b.rotated_back[c][l], y = b.rotated_back[c + 1][l], z = b.rotated_back[c + 2][l];
      d[c][l] -= w.y[l] * z - w.z[l] * y;
      d[c + 1][l] -= w.z[l] * x - w.x[l] * z;
      d[c + 2][l] -= w.x[l] * y - w.y[l] * x;
    }
  }
}

// Computes the corner displacements without the rotation, R^T (X + d) - X = d + (R - 1)^T (X + d), and the
// rotated-back corners x~ = R^T (X + d).
inline void compute_strain(CellBatch& b, const Field& moved, Field& strain) {
  for (int c = 0; c < 24; c += 3) {
    for (int l = 0; l < lanes; ++l) {
      const double x = b.rest[c][l] + moved[c][l], y = b.rest[c + 1][l] + moved[c + 1][l],
                   z = b.rest[c + 2][l] + moved[c + 2][l];
      strain[c][l] = moved[c][l] + (b.turn[0][l] * x + b.turn[3][l] * y + b.turn[6][l] * z);
      strain[c + 1][l] = moved[c + 1][l] + (b.turn[1][l] * x + b.turn[4][l] * y + b.turn[7][l] * z);
      strain[c + 2][l] = moved[c + 2][l] + (b.turn[2][l] * x + b.turn[5][l] * y + b.turn[8][l] * z);
    }
  }
  for (int a = 0; a < cell_axes; ++a) {
    for (int l = 0; l < lanes; ++l) b.rotated_back[a][l] = b.rest[a][l] + strain[a][l];
  }
}

void compute_forces(CellBatch* batches, int count, const double* moved, double* force) {
  for (int k = 0; k < count; ++k) {
    CellBatch& b = batches[k];
    Field at, strain, plain;
    gather(b, moved, at);
    update_turn(b, at);
    compute_strain(b, at, strain);
    stiffness_times(b, strain, plain);
    project_transposed(b, plain);
    scatter(b, plain, -1.0, force);
  }
}

void apply(const CellBatch* batches, int count, double scale, const double* field, double* out) {
  for (int k = 0; k < count; ++k) {
    const CellBatch& b = batches[k];
    Field at, plain;
    gather(b, field, at);
    rotate_back(b, at);
    project(b, at);
    stiffness_times(b, at, plain);
    project_transposed(b, plain);
    scatter(b, plain, scale, out);
  }
}

}  // namespace

const CellKernels cell_kernels = {compute_forces, apply};

}  // namespace spoonbill::SPOONBILL_KERNELS
