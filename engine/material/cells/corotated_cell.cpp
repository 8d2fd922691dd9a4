#include "engine/material/cells/corotated_cell.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

using Turns = Eigen::Matrix<double, 3, 24>;   // maps displacements to a rotation vector
using Levers = Eigen::Matrix<double, 24, 3>;  // maps a rotation vector to displacements or forces

Eigen::Matrix3d cross_matrix(const Vector3& a) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

Levers cross_matrices(const CellVector& vectors) {
  Levers levers;
  for (int c = 0; c < 8; ++c) levers.middleRows<3>(3 * c) = cross_matrix(vectors.segment<3>(3 * c));
  return levers;
}

CellVector from_centre(const CellCorners& corners) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& corner : corners) centre += corner / 8.0;
  CellVector result;
  for (int c = 0; c < 8; ++c) result.segment<3>(3 * c) = corners[static_cast<std::size_t>(c)] - centre;
  return result;
}

// Returns the displacement gradient H; the deformation gradient is 1 + H.
Eigen::Matrix3d displacement_gradient(const CellMoves& moves, const CellGradients& gradients) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int c = 0; c < 8; ++c) sum += moves[static_cast<std::size_t>(c)] * gradients.row(c);
  return sum;
}

CellMatrix rotate_blocks(const CellMatrix& matrix, const Eigen::Matrix3d& rotation) {
  CellMatrix result;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      result.block<3, 3>(3 * row, 3 * column) =
          rotation * matrix.block<3, 3>(3 * row, 3 * column) * rotation.transpose();
    }
  }
  return result;
}

// Returns R - 1 = 2 w [v] + 2 [v]^2 for the unit quaternion w + v. [v] is the cross-product matrix of v.
Eigen::Matrix3d turn_from(const Eigen::Quaterniond& quaternion) {
  const Eigen::Quaterniond unit = quaternion.normalized();
  const Eigen::Matrix3d v = cross_matrix(unit.vec());
  return 2.0 * unit.w() * v + 2.0 * v * v;
}

// Returns the vector whose cross-product matrix is A - A^T, for the matrix A = `a`.
Vector3 axial(const Eigen::Matrix3d& a) {
  return {a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)};
}

// Returns (tr S - S)^-1 for the symmetric part of the stretch S.
Eigen::Matrix3d spin_map(const Eigen::Matrix3d& stretch) {
  return (stretch.trace() * Eigen::Matrix3d::Identity() - 0.5 * (stretch + stretch.transpose())).inverse();
}

}  // namespace

Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& change) {
  const SingularValues parts = decompose_singular(Eigen::Matrix3d::Identity() + change);
  Eigen::Matrix3d left = parts.left;
  if ((left * parts.right.transpose()).determinant() < 0.0) left.col(2) *= -1.0;
  const Eigen::Quaterniond near(Eigen::Matrix3d(left * parts.right.transpose()));
  // The quaternion `near` has the rounding errors of numbers near 1. A small rotation w with [w] S + S [w] =
  // S - S^T corrects them. The skew part of S = R^T F is computed from small numbers alone.
  const Eigen::Matrix3d turn = turn_from(near);
  const Eigen::Matrix3d stretch_change = turn.transpose() + change + turn.transpose() * change;
  const Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity() + stretch_change;
  const Vector3 residual = spin_map(stretch) * axial(stretch_change);
  return turn_from(near *
                   Eigen::Quaterniond(1.0, 0.5 * residual.x(), 0.5 * residual.y(), 0.5 * residual.z()));
}

CorotatedCell::CorotatedCell(const CellCorners& rest, const CellMatrix& stiffness)
    : rest_(from_centre(rest)), stiffness_(stiffness), gradients_(centre_gradients(rest)) {}

Eigen::Matrix3d CorotatedCell::turn(const CellMoves& moves) const {
  return nearest_turn(displacement_gradient(moves, gradients_));
}

// Returns the displacements of the corners without the rotation: R^T (X + d) - X for the corners X and
// displacements d.
CellVector CorotatedCell::strained(const CellMoves& moves, const Eigen::Matrix3d& turn) const {
  const Eigen::Matrix3d rotated_back = turn.transpose();
  CellVector result = from_centre(moves);
  for (int c = 0; c < 8; ++c) {
    const Vector3 move = result.segment<3>(3 * c), rest = rest_.segment<3>(3 * c);
    result.segment<3>(3 * c) = move + rotated_back * (move + rest);
  }
  return result;
}

double CorotatedCell::energy_j(const CellMoves& moves) const {
  const CellVector strain = strained(moves, turn(moves));
  return 0.5 * strain.dot(stiffness_ * strain);
}

CellResponse CorotatedCell::respond(const CellMoves& moves, Tangent kind) const {
  const Eigen::Matrix3d change = displacement_gradient(moves, gradients_), turn = nearest_turn(change);
  const Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity() + turn;
  const CellVector strain = strained(moves, turn), rotated_back = rest_ + strain;
  const CellVector plain_force = stiffness_ * strain;
  const Eigen::Matrix3d by_turn = spin_map(rotation.transpose() * (Eigen::Matrix3d::Identity() + change));
  Turns turns;
  for (int c = 0; c < 8; ++c) {
    turns.middleCols<3>(3 * c) = by_turn * cross_matrix(gradients_.row(c).transpose());
  }
  // Eigen's template for large products takes seconds to compile; lazyProduct() does not.
  const CellMatrix followed = CellMatrix::Identity() + cross_matrices(rotated_back).lazyProduct(turns);
  const CellVector force = followed.transpose() * plain_force;
  CellMatrix tangent = followed.transpose().lazyProduct(CellMatrix(stiffness_.lazyProduct(followed)));
  if (kind == Tangent::stressed) {
    const Turns torques = cross_matrices(plain_force).transpose().lazyProduct(followed);
    const CellMatrix stress_part =
        turns.transpose().lazyProduct(torques) + cross_matrices(force).lazyProduct(turns);
    tangent -= 0.5 * (stress_part + stress_part.transpose());
  }
  CellResponse response;
  response.energy_j = 0.5 * strain.dot(plain_force);
  for (int c = 0; c < 8; ++c) {
    response.force_n.segment<3>(3 * c) = rotation * Vector3(force.segment<3>(3 * c));
  }
  response.tangent = rotate_blocks(tangent, rotation);
  return response;
}

}  // namespace spoonbill
