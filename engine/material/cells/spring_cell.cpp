#include "engine/material/cells/spring_cell.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {

// Bit 0 of a corner's number steps along k, bit 1 along j, bit 2 along i.
const std::array<std::array<int, 2>, cell_spring_count> cell_spring_corners = {{
    {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5},
    {2, 6}, {3, 7}, {0, 3}, {1, 2}, {4, 7}, {5, 6}, {0, 5}, {1, 4}, {2, 7}, {3, 6},
    {0, 6}, {2, 4}, {1, 7}, {3, 5}, {0, 7}, {1, 6}, {2, 5}, {3, 4},
}};

namespace {

constexpr int component_count = 15;
using Components = Eigen::Matrix<double, component_count, 1>;
using ComponentMatrix = Eigen::Matrix<double, component_count, cell_spring_count>;
using Stiffnesses = Eigen::Matrix<double, cell_spring_count, 1>;

// Exponents of x, y, z in each component of a totally symmetric tensor of order four, and the square root
// of the number of its index permutations. With this factor the vector norm equals the tensor norm.
struct Component {
  int x, y, z;
  double root_count;
};
const std::array<Component, component_count> components = {{
    {4, 0, 0, 1.0},
    {0, 4, 0, 1.0},
    {0, 0, 4, 1.0},
    {3, 1, 0, 2.0},
    {3, 0, 1, 2.0},
    {1, 3, 0, 2.0},
    {0, 3, 1, 2.0},
    {1, 0, 3, 2.0},
    {0, 1, 3, 2.0},
    {2, 2, 0, 2.449489742783178},
    {2, 0, 2, 2.449489742783178},
    {0, 2, 2, 2.449489742783178},
    {2, 1, 1, 3.4641016151377544},
    {1, 2, 1, 3.4641016151377544},
    {1, 1, 2, 3.4641016151377544},
}};

double power(double base, int exponent) {
  double result = 1.0;
  for (int e = 0; e < exponent; ++e) result *= base;
  return result;
}

Components fourth_power(const Vector3& direction) {
  Components result;
  for (int c = 0; c < component_count; ++c) {
    result[c] = components[c].root_count * power(direction.x(), components[c].x) *
                power(direction.y(), components[c].y) * power(direction.z(), components[c].z);
  }
  return result;
}

// Returns the isotropic tensor mu (delta_ij delta_kl + delta_ik delta_jl + delta_il delta_jk).
Components isotropic_components(double shear_modulus_pa) {
  Components result = Components::Zero();
  for (int c = 0; c < component_count; ++c) {
    const Component& p = components[c];
    const bool pure = p.x == 4 || p.y == 4 || p.z == 4;
    const bool mixed = (p.x == 2) + (p.y == 2) + (p.z == 2) == 2;
    result[c] = p.root_count * shear_modulus_pa * (pure ? 3.0 : mixed ? 1.0 : 0.0);
  }
  return result;
}

// Returns the stiffnesses that one cell contributes to the springs of a lattice of cubes. Four cells share an
// edge, and two share a face diagonal.
Stiffnesses cube_stiffnesses(double edge_m, double shear_modulus_pa) {
  const double youngs_modulus_pa = 2.5 * shear_modulus_pa;
  const double body = 0.4 * 0.3 * youngs_modulus_pa * edge_m;
  const double edge = 0.4 * youngs_modulus_pa * edge_m + body * 4.0 / 3.0;
  const double face = edge - body * 8.0 / 3.0;
  Stiffnesses result;
  result.head<12>().setConstant(edge / 4.0);
  result.segment<12>(12).setConstant(face / 2.0);
  result.tail<4>().setConstant(body);
  return result;
}

ComponentMatrix spring_components(const CellCorners& corners, double volume) {
  ComponentMatrix matrix;
  for (int s = 0; s < cell_spring_count; ++s) {
    const Vector3 spring = corners[cell_spring_corners[s][1]] - corners[cell_spring_corners[s][0]];
    matrix.col(s) = fourth_power(spring.normalized()) * (spring.squaredNorm() / volume);
  }
  return matrix;
}

// Smallest stiffness of a spring, relative to the same spring in a cube of equal volume. A corner whose
// diagonals vanish can snap through the plane of its neighbours, and a cell without diagonals has zero-energy
// modes.
constexpr double min_spring_fraction = 0.1;

// Returns the stiffnesses k closest to `start` that satisfy `matrix * k = target`. If some are below their
// minimum, fixes these at the minimum and solves for the others, until none is below. A negligible multiple
// of the identity keeps the normal matrix regular where springs of a distorted cell are dependent.
Stiffnesses nearest_admissible(const ComponentMatrix& matrix, const Components& target,
                               const Stiffnesses& start) {
  Stiffnesses weight = start, from = start;
  Stiffnesses result = start;
  for (int round = 0; round < cell_spring_count; ++round) {
    Eigen::Matrix<double, component_count, component_count> normal =
        matrix * weight.asDiagonal() * matrix.transpose();
    normal.diagonal().array() += 1e-11 * normal.trace() / component_count;
    const Components multiplier = solve_symmetric(normal, target - matrix * from);
    result = from + weight.cwiseProduct(matrix.transpose() * multiplier);
    bool settled = true;
    for (int s = 0; s < cell_spring_count; ++s) {
      if (result[s] >= min_spring_fraction * start[s] || weight[s] == 0.0) continue;
      weight[s] = 0.0;
      from[s] = min_spring_fraction * start[s];
      settled = false;
    }
    if (settled) break;
  }
  return result.cwiseMax(min_spring_fraction * start);
}

// Returns the tensor component with the given exponents.
double tensor_component(const Components& tensor, int x, int y, int z) {
  for (int c = 0; c < component_count; ++c) {
    if (components[c].x == x && components[c].y == y && components[c].z == z) {
      return tensor[c] / components[c].root_count;
    }
  }
  return 0.0;
}

Stiffnesses as_vector(const CellSprings& springs) {
  return Eigen::Map<const Stiffnesses>(springs.stiffness_n_per_m.data());
}

}  // namespace

CellSprings cell_springs(const CellCorners& corners, double shear_modulus_pa) {
  SPOONBILL_ASSERT(shear_modulus_pa > 0.0);
  CellSprings result;
  result.volume_m3 = cell_volume(corners);
  const ComponentMatrix matrix = spring_components(corners, result.volume_m3);
  const Components target = isotropic_components(shear_modulus_pa);
  const Stiffnesses start = cube_stiffnesses(std::cbrt(result.volume_m3), shear_modulus_pa);
  const Stiffnesses found = nearest_admissible(matrix, target, start);
  Eigen::Map<Stiffnesses>(result.stiffness_n_per_m.data()) = found;
  result.misfit = (matrix * found - target).norm() / target.norm();
  return result;
}

double shear_modulus(double youngs_modulus_pa, double poissons_ratio) {
  SPOONBILL_ASSERT(poissons_ratio > -1.0);
  return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio));
}

double bulk_stiffness(double youngs_modulus_pa, double poissons_ratio) {
  SPOONBILL_ASSERT(poissons_ratio > -1.0 && poissons_ratio < 0.5);
  return shear_modulus(youngs_modulus_pa, poissons_ratio) * (4.0 * poissons_ratio - 1.0) /
         (1.0 - 2.0 * poissons_ratio);
}

AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellSprings& springs,
                                       double bulk_stiffness_pa) {
  const Components tensor = spring_components(corners, springs.volume_m3) * as_vector(springs);
  Eigen::Matrix3d normal;  // maps strains along the axes to stresses along the axes
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      int exponent[3] = {0, 0, 0};
      exponent[row] += 2;
      exponent[column] += 2;
      normal(row, column) =
          tensor_component(tensor, exponent[0], exponent[1], exponent[2]) + bulk_stiffness_pa;
    }
  }
  return compute_elasticity(normal);
}

double modulus_along(const Vector3& direction, const CellCorners& corners, const CellSprings& springs,
                     double bulk_stiffness_pa) {
  constexpr std::array<std::array<int, 2>, 6> pairs = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  const Components tensor = spring_components(corners, springs.volume_m3) * as_vector(springs);
  const Vector3 unit = direction.normalized();
  Eigen::Matrix<double, 6, 6> stiffness;  // maps engineering strains to stresses
  Eigen::Matrix<double, 6, 1> tension;    // uniaxial stress of 1
  for (int row = 0; row < 6; ++row) {
    const auto [i, j] = pairs[static_cast<std::size_t>(row)];
    tension[row] = unit[i] * unit[j];
    for (int column = 0; column < 6; ++column) {
      std::array<int, 3> exponent{};
      for (const int axis : {i, j}) ++exponent[static_cast<std::size_t>(axis)];
      for (const int axis : pairs[static_cast<std::size_t>(column)])
        ++exponent[static_cast<std::size_t>(axis)];
      stiffness(row, column) = tensor_component(tensor, exponent[0], exponent[1], exponent[2]);
      if (row < 3 && column < 3) stiffness(row, column) += bulk_stiffness_pa;
    }
  }
  const Eigen::Matrix<double, 6, 1> strain = solve_symmetric(stiffness, tension);
  return 1.0 / tension.dot(strain);
}

CellSprings material_springs(const CellCorners& corners, double youngs_modulus_pa, double poissons_ratio) {
  constexpr int rounds = 4;
  constexpr double exact = 1e-9;
  const double bulk_pa = bulk_stiffness(youngs_modulus_pa, poissons_ratio);
  const CellSprings fitted = cell_springs(corners, shear_modulus(youngs_modulus_pa, poissons_ratio));
  if (fitted.misfit < exact) return fitted;
  Vector3 along_k = Vector3::Zero();
  for (std::size_t c = 0; c < 8; c += 2) along_k += corners[c + 1] - corners[c];
  CellSprings scaled = fitted;
  double factor = 1.0;
  // The modulus is nearly proportional to the stiffness of the springs, so the factor converges in few
  // rounds.
  for (int round = 0; round < rounds; ++round) {
    factor *= youngs_modulus_pa / modulus_along(along_k, corners, scaled, bulk_pa);
    if (!(std::abs(factor - 1.0) <= max_spring_correction)) return fitted;
    for (std::size_t s = 0; s < cell_spring_count; ++s) {
      scaled.stiffness_n_per_m[s] = factor * fitted.stiffness_n_per_m[s];
    }
  }
  return scaled;
}

namespace {

// Returns the gradient of cell_volume() with respect to the corners.
CellVector volume_gradient(const CellCorners& p) {
  const Vector3 a = p[7] - p[4], b = p[3] - p[0], c = p[7] - p[2];
  const Vector3 d = p[6] - p[0], e = p[5] - p[0], f = p[7] - p[1];
  const Vector3 ab = a + b, ce = c + e, fd = f + d;
  const Vector3 by_a = c.cross(d) + e.cross(fd), by_b = c.cross(d) + ce.cross(f);
  const Vector3 by_c = d.cross(ab) + f.cross(b), by_d = ab.cross(c) + a.cross(e);
  const Vector3 by_e = f.cross(b) + fd.cross(a), by_f = b.cross(ce) + a.cross(e);
  CellVector gradient;
  gradient << -(by_b + by_d + by_e), -by_f, -by_c, by_b, -by_a, by_e, by_d, by_a + by_c + by_f;
  return gradient / 12.0;
}

// Returns the second derivatives of cell_volume(). The gradient is linear in each single coordinate, so
// differences are exact.
CellMatrix volume_hessian(const CellCorners& at, double size) {
  CellMatrix hessian;
  for (int n = 0; n < 24; ++n) {
    CellCorners up = at, down = at;
    up[static_cast<std::size_t>(n / 3)][n % 3] += size;
    down[static_cast<std::size_t>(n / 3)][n % 3] -= size;
    hessian.col(n) = (volume_gradient(up) - volume_gradient(down)) / (2.0 * size);
  }
  return hessian;
}

// Returns the vector from the first end of a spring to the second.
Vector3 across(std::size_t spring, const std::array<Vector3, 8>& corners) {
  const auto [from, to] = cell_spring_corners[spring];
  return corners[static_cast<std::size_t>(to)] - corners[static_cast<std::size_t>(from)];
}

void add_spring(CellResponse& response, std::size_t spring, const Vector3& force,
                const Eigen::Matrix3d& tangent) {
  const auto [from, to] = cell_spring_corners[spring];
  response.force_n.segment<3>(3 * to) += force;
  response.force_n.segment<3>(3 * from) -= force;
  for (const int row : {from, to}) {
    for (const int column : {from, to}) {
      response.tangent.block<3, 3>(3 * row, 3 * column) += row == column ? tangent : -tangent;
    }
  }
}

}  // namespace

SpringCell::SpringCell(const CellCorners& rest, const CellSprings& springs, double bulk_stiffness_pa,
                       double fraction)
    : bulk_(fraction * bulk_stiffness_pa * springs.volume_m3), rest_volume_(springs.volume_m3) {
  SPOONBILL_ASSERT(fraction > 0.0);
  Vector3 centre = Vector3::Zero();
  for (const Vector3& corner : rest) centre += corner / 8.0;
  for (std::size_t c = 0; c < 8; ++c) rest_[c] = rest[c] - centre;
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    stiffness_[s] = fraction * springs.stiffness_n_per_m[s];
    rest_length_[s] = across(s, rest_).norm();
  }
}

CellCorners SpringCell::deformed_corners(const CellMoves& moves) const {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& move : moves) centre += move / 8.0;
  CellCorners corners;
  for (std::size_t c = 0; c < 8; ++c) corners[c] = rest_[c] + (moves[c] - centre);
  return corners;
}

// Uses L - L0 = (|n + e|^2 - |n|^2) / (L + L0) for the rest vector n and its change e. This form keeps the
// digits of a small e.
double SpringCell::extension_m(std::size_t spring, const CellMoves& moves) const {
  const Vector3 before = across(spring, rest_), more = across(spring, moves), now = before + more;
  return more.dot(before + now) / (now.norm() + rest_length_[spring]);
}

double SpringCell::energy_j(const CellMoves& moves) const {
  const double dilation = cell_volume(deformed_corners(moves)) / rest_volume_ - 1.0;
  double energy = 0.5 * bulk_ * dilation * dilation;
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    const double longer = extension_m(s, moves);
    energy += 0.5 * stiffness_[s] * longer * longer;
  }
  return energy;
}

CellResponse SpringCell::respond(const CellMoves& moves, Tangent tangent) const {
  const CellCorners now = deformed_corners(moves);
  CellResponse response;
  response.energy_j = energy_j(moves);
  const CellVector gradient = volume_gradient(now) / rest_volume_;
  const double pressure = bulk_ * (cell_volume(now) / rest_volume_ - 1.0);
  response.force_n = pressure * gradient;
  response.tangent = bulk_ * gradient * gradient.transpose();
  if (tangent == Tangent::stressed && pressure != 0.0) {
    response.tangent += pressure / rest_volume_ * volume_hessian(now, std::cbrt(rest_volume_));
  }
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    const Vector3 apart = across(s, now);
    const double length = apart.norm();
    if (!(length > 0.0)) continue;
    const Vector3 along = apart / length;
    const double pull = stiffness_[s] * extension_m(s, moves), turning = pull / length;
    const double transverse = tangent == Tangent::stressed ? turning : std::max(turning, 0.0);
    const Eigen::Matrix3d stiffness =
        transverse * Eigen::Matrix3d::Identity() + (stiffness_[s] - transverse) * along * along.transpose();
    add_spring(response, s, pull * along, stiffness);
  }
  return response;
}

}  // namespace spoonbill
