// Decompositions of small dense matrices, and functions that need them. Eigen's templates for these are slow
// to compile, so they are compiled only once, in dense_matrices.cpp. Any thread may call these functions.
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

// Returns the solution x of matrix * x = right_side. If the matrix is singular, the components are very large
// or not finite.
Vector3 solve_linear(const Eigen::Matrix3d& matrix, const Vector3& right_side);
// A matrix with up to 15 rows and 24 columns. It never allocates.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 15, 24>;
// Returns the solution X of matrix * X = right_sides for a symmetric matrix with up to 15 rows. If the matrix
// is singular, the result is finite but need not be a solution.
SmallMatrix solve_symmetric(const SmallMatrix& matrix, const SmallMatrix& right_sides);

// Returns the rotation by the smallest angle that turns the direction of `from` to that of `to`; the identity
// if one of them is zero.
Quaternion rotation_between(const Vector3& from, const Vector3& to);

// Returns a rotation about `turn` by 2 atan(|turn| / 2), which differs from |turn| by |turn|^3 / 12 (Cayley
// 1846). Unlike the sine and cosine of the library, it has the same bits on every machine.
Quaternion rotation_about(const Vector3& turn);

}  // namespace spoonbill
