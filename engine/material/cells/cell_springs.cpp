#include "engine/material/cells/cell_springs.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

// Corner bits: 0 = k, 1 = j, 2 = i.
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

// The exponents of x, y, z in each component of a totally symmetric tensor of order four, and the root of how
// many index permutations it stands for, so that the vector norm is the tensor norm.
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

// mu (delta_ij delta_kl + delta_ik delta_jl + delta_il delta_jk).
Components isotropic(double shear_modulus_pa) {
  Components result = Components::Zero();
  for (int c = 0; c < component_count; ++c) {
    const Component& p = components[c];
    const bool pure = p.x == 4 || p.y == 4 || p.z == 4;
    const bool mixed = (p.x == 2) + (p.y == 2) + (p.z == 2) == 2;
    result[c] = p.root_count * shear_modulus_pa * (pure ? 3.0 : mixed ? 1.0 : 0.0);
  }
  return result;
}

// A cube's springs within one cell (edges are shared by four cells, face diagonals by two).
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

// No spring falls below this share of a cube's: a corner whose diagonals vanish can snap through its
// neighbours' plane, and a cell without diagonals has zero-energy modes.
constexpr double least_share = 0.1;

// The stiffnesses nearest to `start` that meet `matrix * k = wanted`; those that would fall below their least
// share are set to it, round by round. A negligible ridge keeps the normal matrix regular where springs of a
// distorted cell depend on each other.
Stiffnesses nearest_admissible(const ComponentMatrix& matrix, const Components& wanted,
                               const Stiffnesses& start) {
  Stiffnesses weight = start, from = start;
  Stiffnesses result = start;
  for (int round = 0; round < cell_spring_count; ++round) {
    Eigen::Matrix<double, component_count, component_count> normal =
        matrix * weight.asDiagonal() * matrix.transpose();
    normal.diagonal().array() += 1e-11 * normal.trace() / component_count;
    const Components multiplier = normal.ldlt().solve(wanted - matrix * from);
    result = from + weight.cwiseProduct(matrix.transpose() * multiplier);
    bool settled = true;
    for (int s = 0; s < cell_spring_count; ++s) {
      if (result[s] >= least_share * start[s] || weight[s] == 0.0) continue;
      weight[s] = 0.0;
      from[s] = least_share * start[s];
      settled = false;
    }
    if (settled) break;
  }
  return result.cwiseMax(least_share * start);
}

// Index of the tensor component with the given exponents.
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
  const Components wanted = isotropic(shear_modulus_pa);
  const Stiffnesses start = cube_stiffnesses(std::cbrt(result.volume_m3), shear_modulus_pa);
  const Stiffnesses found = nearest_admissible(matrix, wanted, start);
  Eigen::Map<Stiffnesses>(result.stiffness_n_per_m.data()) = found;
  result.misfit = (matrix * found - wanted).norm() / wanted.norm();
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
  Eigen::Matrix3d normal;  // stress along each axis by strain along each axis
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      int exponent[3] = {0, 0, 0};
      exponent[row] += 2;
      exponent[column] += 2;
      normal(row, column) =
          tensor_component(tensor, exponent[0], exponent[1], exponent[2]) + bulk_stiffness_pa;
    }
  }
  return elasticity_of(normal);
}

}  // namespace spoonbill
