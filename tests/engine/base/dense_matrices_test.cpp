#include "engine/base/dense_matrices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/engine/random.h"

namespace spoonbill {
namespace {

TEST(RotationBetween, TurnsOneDirectionToTheOtherByTheSmallestAngle) {
  Random random(1);
  for (int turn = 0; turn < 200; ++turn) {
    const Vector3 from = random.direction(), across = from.unitOrthogonal();
    const bool is_nearly_half_a_turn = turn % 4 == 0;
    const double angle_rad =
        is_nearly_half_a_turn ? std::numbers::pi - random.log_uniform(1e-9, 1e-5) : random.uniform(0.0, 3.0);
    const Vector3 to = std::cos(angle_rad) * from + std::sin(angle_rad) * across;
    const Quaternion rotation = rotation_between(0.01 * from, 30.0 * to);
    EXPECT_NEAR(rotation.norm(), 1.0, 1e-14);
    // Directions less than 1e-6 short of half a turn count as opposite.
    const double tolerance = is_nearly_half_a_turn ? 1.1e-6 : 1e-13;
    EXPECT_LE((rotation * from - to).norm(), tolerance) << angle_rad;
    EXPECT_NEAR(Eigen::AngleAxisd(rotation).angle(), angle_rad, tolerance);
  }
  EXPECT_LE(
      (rotation_between(Vector3::UnitX(), -Vector3::UnitX()) * Vector3::UnitX() + Vector3::UnitX()).norm(),
      1e-15);
  EXPECT_TRUE(rotation_between(Vector3::Zero(), Vector3::UnitX()).isApprox(Quaternion::Identity()));
}

TEST(SolveSymmetric, SolvesEverySize) {
  Random random(2);
  for (int size = 1; size <= 15; ++size) {
    SmallMatrix matrix = SmallMatrix::Zero(size, size), expected(size, 24);
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column <= row; ++column) {
        matrix(row, column) = matrix(column, row) = random.uniform(-1.0, 1.0);
      }
      matrix(row, row) += 20.0;
      for (int column = 0; column < 24; ++column) expected(row, column) = random.uniform(-1.0, 1.0);
    }
    const SmallMatrix right_sides = matrix.lazyProduct(expected);
    EXPECT_LE((solve_symmetric(matrix, right_sides) - expected).cwiseAbs().maxCoeff(), 1e-13) << size;
  }
}

}  // namespace
}  // namespace spoonbill
