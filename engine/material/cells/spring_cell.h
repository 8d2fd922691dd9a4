// Lattice cells made of springs and one volume force. They have the elasticity of the spring lattice for
// sculpting (springs/lattice_kernels.h), but in double precision and with a tangent.
#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/material/cells/cell_elasticity.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

inline constexpr int cell_spring_count = 28;

// End corners of each spring, the lower number first. Springs 0-11 are edges, 12-23 face diagonals, 24-27
// body diagonals.
extern const std::array<std::array<int, 2>, cell_spring_count> cell_spring_corners;

struct CellSprings {
  std::array<double, cell_spring_count> stiffness_n_per_m{};  // stiffness of each spring; all positive
  double volume_m3 = 0.0;
  // Relative error of the springs' elasticity tensor: |achieved - target| / |target|, as norms of its 15
  // components. It is 0 for a cube and for bricks up to an aspect ratio of about 1.5, and above 0 where
  // springs of at least a tenth of a cube's stiffness cannot reach the target.
  double misfit = 0.0;
};

// Computes the springs of a cell: 12 edges, 12 face diagonals and 4 body diagonals.
//
// Central forces alone have lambda = mu, Poisson's ratio 1/4 exactly (Golec et al. 2019). The springs get
// the target shear modulus mu = E / (2 (1 + nu)); a volume force adds bulk_stiffness().
//
// The stiffnesses k solve 15 equations: the sum over springs of k L^2 n n n n = V mu (delta delta + 2
// permutations), for springs of length L and direction n. The solution is the one closest to a cube of the
// same volume whose body diagonals have two fifths of their largest possible stiffness. With body diagonals
// of zero or of the largest stiffness, zero-energy modes appear.
//
// Eq. 6 of Pungotra et al. 2013, K = A E / L with A = a^2, is the stiffness of a bar; applied to every
// spring, it makes a lattice 2.09 to 2.25 times too stiff.
CellSprings cell_springs(const CellCorners& corners, double shear_modulus_pa);

// Returns the springs of a cell of a material: those of cell_springs() for the material's shear modulus. If
// these springs cannot reach the elasticity (CellSprings::misfit), all are scaled by one factor, so that the
// cell with its volume force has the material's Young's modulus in tension along k. Cells that need a larger
// correction than max_spring_correction are too slender and are not scaled.
CellSprings material_springs(const CellCorners& corners, double youngs_modulus_pa, double poissons_ratio);
inline constexpr double max_spring_correction = 0.2;

// Returns Young's modulus of a cell in tension along a direction, Pa.
double modulus_along(const Vector3& direction, const CellCorners& corners, const CellSprings& springs,
                     double bulk_stiffness_pa);

// Returns K_v = mu (4 nu - 1) / (1 - 2 nu), Pa: the stiffness of the volume force that changes Poisson's
// ratio from the springs' 1/4 to nu. Negative for nu < 1/4.
double bulk_stiffness(double youngs_modulus_pa, double poissons_ratio);
double shear_modulus(double youngs_modulus_pa, double poissons_ratio);

// Returns the elasticity of a cell with these springs and a volume force.
AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellSprings& springs,
                                       double bulk_stiffness_pa);

// A cell of springs with a volume force. A plain value type.
class SpringCell {
 public:
  SpringCell() = default;
  // Creates a cell with the rest shape `rest`. `fraction` is the fraction of the cell that belongs to the
  // body.
  SpringCell(const CellCorners& rest, const CellSprings& springs, double bulk_stiffness_pa, double fraction);

  // Computes energy, forces and tangent. The energy is 1/2 k (L - L0)^2 for each spring plus
  // 1/2 K_v (J - 1)^2 V0 with J = V / V0.
  CellResponse respond(const CellMoves& moves, Tangent tangent) const;
  double energy_j(const CellMoves& moves) const;

 private:
  CellCorners deformed_corners(const CellMoves& moves) const;
  // Returns the length of a spring minus its rest length, m.
  double extension_m(std::size_t spring, const CellMoves& moves) const;

  CellCorners rest_{};  // corners at rest, relative to the centre
  std::array<double, cell_spring_count> stiffness_{}, rest_length_{};
  double bulk_ = 0.0, rest_volume_ = 0.0;  // K_v V0 and V0, see respond()
};

}  // namespace spoonbill
