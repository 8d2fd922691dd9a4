// Decompositions of small dense matrices, and what Eigen builds on them. Eigen's templates for them take
// longer to compile than the rest of most of their users, so they are compiled once, here. Any thread may
// call these functions.
#pragma once

#include <Eigen/Core>

#include "engine/base/geometry.h"

namespace spoonbill {

struct SymmetricEigen {
  Vector3 values;           // ascending
  Eigen::Matrix3d vectors;  // unit eigenvectors as columns, in the order of the values
};
SymmetricEigen decompose_symmetric(const Eigen::Matrix3d& matrix);

// A matrix as left * values.asDiagonal() * right.transpose().
struct SingularValues {
  Eigen::Matrix3d left;   // orthogonal
  Vector3 values;         // at least 0, descending
  Eigen::Matrix3d right;  // orthogonal
};
SingularValues decompose_singular(const Eigen::Matrix3d& matrix);

// Returns the solution of matrix * x = right_side. The components are not finite if the matrix is singular.
Vector3 solve_linear(const Eigen::Matrix3d& matrix, const Vector3& right_side);
// The same for a symmetric matrix and for each column of `right_sides`. Defined for the sizes that the source
// lists.
template <int size, int columns>
Eigen::Matrix<double, size, columns> solve_symmetric(const Eigen::Matrix<double, size, size>& matrix,
                                                     const Eigen::Matrix<double, size, columns>& right_sides);
// Returns the rotation by the smallest angle that turns the direction of `from` to that of `to`; the identity
// if one of them is zero.
Quaternion rotation_between(const Vector3& from, const Vector3& to);

}  // namespace spoonbill
