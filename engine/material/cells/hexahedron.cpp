#include "engine/material/cells/hexahedron.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

// The shape functions of a cell: one for each corner, then three internal quadratic modes.
constexpr int corner_count = 8, function_count = 11;
constexpr int corner_moves = 3 * corner_count, all_moves = 3 * function_count;
using FunctionGradients = Eigen::Matrix<double, function_count, 3>;
using WholeStiffness = Eigen::Matrix<double, all_moves, all_moves>;

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

// Lame's parameters of an isotropic material, Pa.
struct LameParameters {
  double lambda, shear;
};

LameParameters lame_parameters(double youngs_modulus_pa, double poissons_ratio) {
  const double shear = youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio));
  return {2.0 * shear * poissons_ratio / (1.0 - 2.0 * poissons_ratio), shear};
}

struct CentreJacobian {
  Eigen::Matrix3d inverse;
  double determinant;
};

// Returns the gradients of all shape functions at a point. The internal modes are 1 - r^2, 1 - s^2 and 1 -
// t^2 in the natural coordinates r, s, t. Their gradients are scaled so that each has zero mean over the
// cell.
FunctionGradients gradients_at(const Vector3& at, const CellGradients& natural, const Eigen::Matrix3d& here,
                               double determinant, const CentreJacobian& centre) {
  FunctionGradients gradients;
  gradients.topRows<corner_count>() = natural * here.inverse().transpose();
  for (int mode = 0; mode < 3; ++mode) {
    gradients.row(corner_count + mode) =
        -2.0 * at[mode] * centre.determinant / determinant * centre.inverse.col(mode).transpose();
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

// Calls visit(point, weight) for the Gauss points of a part. Both are in natural coordinates.
template <class Visit>
void visit_points(const Vector3& low, const Vector3& high, const Visit& visit) {
  const Vector3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
  for (int point = 0; point < 8; ++point) {
    visit(Vector3(centre + half.cwiseProduct(natural(point) / std::sqrt(3.0))), half.prod());
  }
}

// Adds the stiffness of a Gauss point. The block of two functions with the gradients a and b is
// lambda a b^T + shear (b a^T + (a . b) 1), times the volume.
void add_point(const FunctionGradients& gradients, double volume, const LameParameters& material,
               WholeStiffness& stiffness) {
  for (int row = 0; row < function_count; ++row) {
    const Vector3 a = volume * gradients.row(row).transpose();
    for (int column = 0; column < function_count; ++column) {
      const Vector3 b = gradients.row(column).transpose();
      Eigen::Matrix3d block = material.lambda * a * b.transpose() + material.shear * b * a.transpose();
      block.diagonal().array() += material.shear * a.dot(b);
      stiffness.block<3, 3>(3 * row, 3 * column) += block;
    }
  }
}

}  // namespace

CellMatrix hexahedron_stiffness(const CellCorners& corners, std::span<const HexahedronPart> parts) {
  SPOONBILL_ASSERT(!parts.empty());
  SPOONBILL_ASSERT_DEBUG(smallest_jacobian_ratio(corners) > 0.0);
  const Eigen::Matrix3d centre = jacobian(corners, natural_gradients(Vector3::Zero()));
  const CentreJacobian at_centre{centre.inverse(), centre.determinant()};
  WholeStiffness whole = WholeStiffness::Zero();
  for (const HexahedronPart& part : parts) {
    const LameParameters material = lame_parameters(part.youngs_modulus_pa, part.poissons_ratio);
    visit_points(part.low, part.high, [&](const Vector3& at, double weight) {
      const CellGradients natural = natural_gradients(at);
      const Eigen::Matrix3d here = jacobian(corners, natural);
      const double determinant = here.determinant();
      add_point(gradients_at(at, natural, here, determinant, at_centre), weight * determinant, material,
                whole);
    });
  }
  const auto outer = whole.topLeftCorner<corner_moves, corner_moves>();
  const SmallMatrix outer_to_inner = whole.bottomLeftCorner<all_moves - corner_moves, corner_moves>();
  const SmallMatrix inner = whole.bottomRightCorner<all_moves - corner_moves, all_moves - corner_moves>();
  // Eigen's template for large products takes seconds to compile; lazyProduct() does not.
  const CellMatrix stiffness =
      outer - outer_to_inner.transpose().lazyProduct(solve_symmetric(inner, outer_to_inner));
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
  const Eigen::Matrix<double, 24, 3> forces = stiffness.lazyProduct(stretches);
  return compute_elasticity(stretches.transpose() * forces / cell_volume(corners));
}

}  // namespace spoonbill
