// The springs of one lattice cell: 12 edges, 12 face diagonals and 4 body diagonals, whose stiffnesses
// together give the cell the elasticity of a material.
#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/material/cells/achieved_elasticity.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

inline constexpr int cell_spring_count = 28;

// The two corners of each spring, the lower number first: edges 0-11, face diagonals 12-23, body diagonals
// 24-27.
extern const std::array<std::array<int, 2>, cell_spring_count> cell_spring_corners;

struct CellSprings {
  std::array<double, cell_spring_count> stiffness_n_per_m{};  // all positive
  double volume_m3 = 0.0;
  // |achieved - wanted| / |wanted| of the 15 components of the spring part's elasticity tensor. 0 for a cube
  // and for bricks up to about 1.5 to 1; above it where springs of at least a tenth of a cube's cannot reach
  // the tensor.
  double misfit = 0.0;
};

// Central forces alone have lambda = mu, Poisson's ratio 1/4 exactly (Golec et al. 2019). The springs are set
// to the wanted shear modulus mu = E / (2 (1 + nu)); the volume force adds bulk_stiffness() for the rest. Our
// identification: sum over springs of k L^2 n n n n = V mu (delta delta + 2 permutations), 15 equations,
// solved for the stiffnesses nearest to those of a cube of the same volume with two fifths of the largest
// possible body diagonals (without body diagonals, or with the largest, zero-energy modes appear). Eq. 6 of
// Pungotra et al. 2013, K = A E / L with A = a^2, is a bar's formula; on all springs of a lattice it
// gives 2.09 to 2.25 times the wanted E.
CellSprings cell_springs(const CellCorners& corners, double shear_modulus_pa);

// K_v = mu (4 nu - 1) / (1 - 2 nu), in Pa: what a cell's volume force adds to nu = 1/4. Non-negative from
// there on.
double bulk_stiffness(double youngs_modulus_pa, double poissons_ratio);
double shear_modulus(double youngs_modulus_pa, double poissons_ratio);

// From its springs and volume force.
AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellSprings& springs,
                                       double bulk_stiffness_pa);

}  // namespace spoonbill
