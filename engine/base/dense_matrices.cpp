#include "engine/base/dense_matrices.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace spoonbill {

SymmetricEigen decompose_symmetric(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SingularValues decompose_singular(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> solver(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {solver.matrixU(), solver.singularValues(), solver.matrixV()};
}

Vector3 solve_linear(const Eigen::Matrix3d& matrix, const Vector3& right_side) {
  return matrix.partialPivLu().solve(right_side);
}

template <int size, int columns>
Eigen::Matrix<double, size, columns> solve_symmetric(
    const Eigen::Matrix<double, size, size>& matrix,
    const Eigen::Matrix<double, size, columns>& right_sides) {
  return matrix.ldlt().solve(right_sides);
}
template Eigen::Matrix<double, 3, 1> solve_symmetric(const Eigen::Matrix3d&, const Vector3&);
template Eigen::Matrix<double, 6, 1> solve_symmetric(const Eigen::Matrix<double, 6, 6>&,
                                                     const Eigen::Matrix<double, 6, 1>&);
template Eigen::Matrix<double, 9, 24> solve_symmetric(const Eigen::Matrix<double, 9, 9>&,
                                                      const Eigen::Matrix<double, 9, 24>&);
template Eigen::Matrix<double, 15, 1> solve_symmetric(const Eigen::Matrix<double, 15, 15>&,
                                                      const Eigen::Matrix<double, 15, 1>&);

Quaternion rotation_between(const Vector3& from, const Vector3& to) {
  if (from.isZero(0.0) || to.isZero(0.0)) return Quaternion::Identity();
  return Quaternion::FromTwoVectors(from, to);
}

}  // namespace spoonbill
