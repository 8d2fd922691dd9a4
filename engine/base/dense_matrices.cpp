#include "engine/base/dense_matrices.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

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

SmallMatrix solve_symmetric(const SmallMatrix& matrix, const SmallMatrix& right_sides) {
  SPOONBILL_ASSERT_DEBUG(matrix.rows() == matrix.cols() && matrix.rows() == right_sides.rows());
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 15, 15>;
  return Eigen::LDLT<Square>(matrix).solve(right_sides);
}

namespace {

// Two vectors count as opposite if twice the cosine of half the angle between them is at most this. The angle
// is then less than 1e-6 short of half a turn.
constexpr double least_twice_w = 1e-6;

}  // namespace

Quaternion rotation_between(const Vector3& from, const Vector3& to) {
  if (from.isZero(0.0) || to.isZero(0.0)) return Quaternion::Identity();
  const Vector3 start = from.normalized(), end = to.normalized();
  const double twice_w = std::sqrt(2.0 * (1.0 + std::max(-1.0, start.dot(end))));
  // If the vectors are opposite, start x end is only a rounding error. Any perpendicular axis will do.
  if (!(twice_w > least_twice_w)) {
    return Quaternion(Eigen::AngleAxisd(std::numbers::pi, start.unitOrthogonal()));
  }
  const Vector3 axis = start.cross(end) / twice_w;
  return Quaternion(0.5 * twice_w, axis.x(), axis.y(), axis.z()).normalized();
}

Quaternion rotation_about(const Vector3& turn) {
  return Quaternion(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()).normalized();
}

}  // namespace spoonbill
