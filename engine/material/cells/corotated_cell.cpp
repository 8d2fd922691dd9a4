#include "engine/material/cells/corotated_cell.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace spoonbill {
namespace {

using Turns = Eigen::Matrix<double, 3, 24>;   // a rotation vector from displacements
using Levers = Eigen::Matrix<double, 24, 3>;  // displacements, or the like, from a rotation vector

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

CellVector from_middle(const CellCorners& corners) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& corner : corners) middle += corner / 8.0;
  CellVector result;
  for (int c = 0; c < 8; ++c) result.segment<3>(3 * c) = corners[static_cast<std::size_t>(c)] - middle;
  return result;
}

// H of the deformation 1 + H.
Eigen::Matrix3d change_of(const CellMoves& moves, const CellGradients& gradients) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int c = 0; c < 8; ++c) sum += moves[static_cast<std::size_t>(c)] * gradients.row(c);
  return sum;
}

CellMatrix turned(const CellMatrix& matrix, const Eigen::Matrix3d& rotation) {
  CellMatrix result;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      result.block<3, 3>(3 * row, 3 * column) =
          rotation * matrix.block<3, 3>(3 * row, 3 * column) * rotation.transpose();
    }
  }
  return result;
}

// R - 1 = 2 w [v] + 2 [v]^2 of the quaternion w + v of length 1.
Eigen::Matrix3d turn_of(const Eigen::Quaterniond& quaternion) {
  const Eigen::Quaterniond unit = quaternion.normalized();
  const Eigen::Matrix3d v = cross_matrix(unit.vec());
  return 2.0 * unit.w() * v + 2.0 * v * v;
}

// The vector a of A - A^T = [a].
Vector3 axial(const Eigen::Matrix3d& a) {
  return {a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)};
}

// (tr S - S)^-1.
Eigen::Matrix3d turning(const Eigen::Matrix3d& stretch) {
  return (stretch.trace() * Eigen::Matrix3d::Identity() - 0.5 * (stretch + stretch.transpose())).inverse();
}

}  // namespace

Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& change) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Eigen::Matrix3d::Identity() + change,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d left = svd.matrixU();
  if ((left * svd.matrixV().transpose()).determinant() < 0.0) left.col(2) *= -1.0;
  const Eigen::Quaterniond near(Eigen::Matrix3d(left * svd.matrixV().transpose()));
  // The product above is right to the rounding of 1. What is left of the skew part of S = R^T F, taken from
  // small numbers alone, mends it: [w] S + S [w] = S - S^T.
  const Eigen::Matrix3d turn = turn_of(near);
  const Eigen::Matrix3d stretch_change = turn.transpose() + change + turn.transpose() * change;
  const Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity() + stretch_change;
  const Vector3 left_over = turning(stretch) * axial(stretch_change);
  return turn_of(near *
                 Eigen::Quaterniond(1.0, 0.5 * left_over.x(), 0.5 * left_over.y(), 0.5 * left_over.z()));
}

CorotatedCell::CorotatedCell(const CellCorners& rest, const CellMatrix& stiffness)
    : rest_(from_middle(rest)), stiffness_(stiffness), gradients_(middle_gradients(rest)) {}

Eigen::Matrix3d CorotatedCell::turn(const CellMoves& moves) const {
  return nearest_turn(change_of(moves, gradients_));
}

// R^T (X + d) - X.
CellVector CorotatedCell::strained(const CellMoves& moves, const Eigen::Matrix3d& turn) const {
  const Eigen::Matrix3d back = turn.transpose();
  CellVector result = from_middle(moves);
  for (int c = 0; c < 8; ++c) {
    const Vector3 move = result.segment<3>(3 * c), rest = rest_.segment<3>(3 * c);
    result.segment<3>(3 * c) = move + back * (move + rest);
  }
  return result;
}

double CorotatedCell::energy_j(const CellMoves& moves) const {
  const CellVector strain = strained(moves, turn(moves));
  return 0.5 * strain.dot(stiffness_ * strain);
}

CellResponse CorotatedCell::respond(const CellMoves& moves, Tangent kind) const {
  const Eigen::Matrix3d change = change_of(moves, gradients_), turn = nearest_turn(change);
  const Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity() + turn;
  const CellVector strain = strained(moves, turn), back = rest_ + strain;
  const CellVector plain_force = stiffness_ * strain;
  const Eigen::Matrix3d by_turn = turning(rotation.transpose() * (Eigen::Matrix3d::Identity() + change));
  Turns turns;
  for (int c = 0; c < 8; ++c) {
    turns.middleCols<3>(3 * c) = by_turn * cross_matrix(gradients_.row(c).transpose());
  }
  const CellMatrix followed = CellMatrix::Identity() + cross_matrices(back) * turns;
  const CellVector force = followed.transpose() * plain_force;
  CellMatrix tangent = followed.transpose() * stiffness_ * followed;
  if (kind == Tangent::stressed) {
    const CellMatrix of_stress = turns.transpose() * (cross_matrices(plain_force).transpose() * followed) +
                                 cross_matrices(force) * turns;
    tangent -= 0.5 * (of_stress + of_stress.transpose());
  }
  CellResponse response;
  response.energy_j = 0.5 * strain.dot(plain_force);
  for (int c = 0; c < 8; ++c) {
    response.force_n.segment<3>(3 * c) = rotation * Vector3(force.segment<3>(3 * c));
  }
  response.tangent = turned(tangent, rotation);
  return response;
}

}  // namespace spoonbill
