#include "engine/material/cells/hexahedron.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

constexpr int inner_count = 9;  // three displacements for each of three quadratic modes
using InnerMatrix = Eigen::Matrix<double, inner_count, inner_count>;
using MixedMatrix = Eigen::Matrix<double, 24, inner_count>;
using Elasticity = Eigen::Matrix<double, 6, 6>;
using StrainRows = Eigen::Matrix<double, 6, 3>;

// Returns the natural coordinates of a corner, each -1 or 1, along i, j, k.
Vector3 natural(int corner) {
  return {corner >> 2 & 1 ? 1.0 : -1.0, corner >> 1 & 1 ? 1.0 : -1.0, corner & 1 ? 1.0 : -1.0};
}

// Returns the gradients of the shape functions with respect to the natural coordinates.
CellGradients natural_gradients(const Vector3& at) {
  CellGradients gradients;
  for (int c = 0; c < 8; ++c) {
    const Vector3 corner = natural(c), factor = Vector3::Ones() + corner.cwiseProduct(at);
    gradients.row(c) << corner.x() * factor.y() * factor.z(), factor.x() * corner.y() * factor.z(),
        factor.x() * factor.y() * corner.z();
  }
  return gradients / 8.0;
}

// Returns the derivatives of the position: rows for the natural coordinates, columns for x, y, z.
Eigen::Matrix3d jacobian(const CellCorners& corners, const CellGradients& gradients) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int c = 0; c < 8; ++c) {
    sum += gradients.row(c).transpose() * corners[static_cast<std::size_t>(c)].transpose();
  }
  return sum;
}

// Returns the matrix from a displacement to the engineering strains xx, yy, zz, xy, yz, zx. The displacement
// is the coefficient of a shape function with the gradient `g`.
StrainRows strain_rows(const Vector3& g) {
  StrainRows rows;
  rows << g.x(), 0, 0, 0, g.y(), 0, 0, 0, g.z(), g.y(), g.x(), 0, 0, g.z(), g.y(), g.z(), 0, g.x();
  return rows;
}

Elasticity isotropic_elasticity(double youngs_modulus_pa, double poissons_ratio) {
  const double shear = youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio));
  const double lambda = 2.0 * shear * poissons_ratio / (1.0 - 2.0 * poissons_ratio);
  Elasticity d = Elasticity::Zero();
  d.topLeftCorner<3, 3>().setConstant(lambda);
  d.diagonal().head<3>().array() += 2.0 * shear;
  d.diagonal().tail<3>().setConstant(shear);
  return d;
}

struct CentreJacobian {
  Eigen::Matrix3d inverse;
  double determinant;
};

// Returns the gradients of the internal modes 1 - r^2, 1 - s^2 and 1 - t^2 in the natural coordinates r, s,
// t. They are scaled so that each has zero mean over the cell.
std::array<Vector3, 3> inner_gradients(const Vector3& at, const CentreJacobian& centre, double determinant) {
  std::array<Vector3, 3> gradients;
  for (int mode = 0; mode < 3; ++mode) {
    Vector3 natural_gradient = Vector3::Zero();
    natural_gradient[mode] = -2.0 * at[mode];
    gradients[static_cast<std::size_t>(mode)] =
        centre.determinant / determinant * (centre.inverse * natural_gradient);
  }
  return gradients;
}

}  // namespace

CellGradients centre_gradients(const CellCorners& corners) {
  const CellGradients natural = natural_gradients(Vector3::Zero());
  return natural * jacobian(corners, natural).inverse().transpose();
}

CellMatrix hexahedron_stiffness(const CellCorners& corners, double youngs_modulus_pa, double poissons_ratio) {
  SPOONBILL_ASSERT(youngs_modulus_pa > 0.0);
  SPOONBILL_ASSERT(poissons_ratio > -1.0 && poissons_ratio < 0.5);
  SPOONBILL_ASSERT_DEBUG(smallest_jacobian_ratio(corners) > 0.0);
  const HexahedronPart whole{-Vector3::Ones(), Vector3::Ones(), youngs_modulus_pa, poissons_ratio};
  return hexahedron_stiffness(corners, {&whole, 1});
}

namespace {

struct Sums {
  CellMatrix outer = CellMatrix::Zero();
  MixedMatrix mixed = MixedMatrix::Zero();
  InnerMatrix inner = InnerMatrix::Zero();
};

// Calls visit(point, weight) for the Gauss points of a part. Both are in natural coordinates.
template <class Visit>
void visit_points(const Vector3& low, const Vector3& high, const Visit& visit) {
  const Vector3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
  for (int point = 0; point < 8; ++point) {
    visit(Vector3(centre + half.cwiseProduct(natural(point) / std::sqrt(3.0))), half.prod());
  }
}

void add_point(const CellCorners& corners, const CentreJacobian& at_centre, const Vector3& at, double weight,
               const Elasticity& elasticity, Sums& sums) {
  const CellGradients natural = natural_gradients(at);
  const Eigen::Matrix3d here = jacobian(corners, natural);
  const double determinant = here.determinant(), volume = weight * determinant;
  const CellGradients gradients = natural * here.inverse().transpose();
  const std::array<Vector3, 3> inner_gradient = inner_gradients(at, at_centre, determinant);
  Eigen::Matrix<double, 6, 24> strain;
  for (int c = 0; c < 8; ++c) strain.middleCols<3>(3 * c) = strain_rows(gradients.row(c).transpose());
  Eigen::Matrix<double, 6, inner_count> inner_strain;
  for (int m = 0; m < 3; ++m) {
    inner_strain.middleCols<3>(3 * m) = strain_rows(inner_gradient[static_cast<std::size_t>(m)]);
  }
  const Eigen::Matrix<double, 6, inner_count> inner_stress = volume * elasticity * inner_strain;
  sums.outer += volume * strain.transpose() * elasticity * strain;
  sums.mixed += strain.transpose() * inner_stress;
  sums.inner += inner_strain.transpose() * inner_stress;
}

}  // namespace

CellMatrix hexahedron_stiffness(const CellCorners& corners, std::span<const HexahedronPart> parts) {
  SPOONBILL_ASSERT(!parts.empty());
  SPOONBILL_ASSERT_DEBUG(smallest_jacobian_ratio(corners) > 0.0);
  const Eigen::Matrix3d centre = jacobian(corners, natural_gradients(Vector3::Zero()));
  const CentreJacobian at_centre{centre.inverse(), centre.determinant()};
  Sums sums;
  for (const HexahedronPart& part : parts) {
    const Elasticity elasticity = isotropic_elasticity(part.youngs_modulus_pa, part.poissons_ratio);
    visit_points(part.low, part.high, [&](const Vector3& at, double weight) {
      add_point(corners, at_centre, at, weight, elasticity, sums);
    });
  }
  const CellMatrix stiffness =
      sums.outer - sums.mixed * solve_symmetric<inner_count, 24>(sums.inner, sums.mixed.transpose());
  return 0.5 * (stiffness + stiffness.transpose());
}

std::array<double, 8> part_volumes(const CellCorners& corners, const Vector3& low, const Vector3& high) {
  SPOONBILL_ASSERT_DEBUG((low.array() <= high.array()).all());
  std::array<double, 8> volumes{};
  visit_points(low, high, [&](const Vector3& at, double weight) {
    const double volume = weight * jacobian(corners, natural_gradients(at)).determinant();
    for (int c = 0; c < 8; ++c) {
      volumes[static_cast<std::size_t>(c)] +=
          volume * (Vector3::Ones() + natural(c).cwiseProduct(at)).prod() / 8.0;
    }
  });
  return volumes;
}

AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellMatrix& stiffness) {
  Eigen::Matrix<double, 24, 3> stretches = Eigen::Matrix<double, 24, 3>::Zero();
  for (int c = 0; c < 8; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      stretches(3 * c + axis, axis) = corners[static_cast<std::size_t>(c)][axis];
    }
  }
  return compute_elasticity(stretches.transpose() * stiffness * stretches / cell_volume(corners));
}

}  // namespace spoonbill
