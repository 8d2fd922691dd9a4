#include "engine/bspline/blending_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "engine/bspline/grid.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

double condition(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues();
  return singular(0) / singular(singular.size() - 1);
}

TEST(BlendingMatrix, RowsSumToOneAtTheLastKnotAndTheSeamToo) {
  Random random(3);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const KnotVector knots = random_knots(random);
    const auto parameters = random_parameters(random, knots, 20);
    const Eigen::MatrixXd matrix = blending_matrix(knots, parameters, 0).dense();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      // The tolerance covers the rounding of at most ten positive terms below 1.
      EXPECT_NEAR(matrix.row(i).sum(), 1.0, 1e-14);
    }
    if (knots.is_periodic()) {
      EXPECT_EQ(matrix.row(0), matrix.row(matrix.rows() - 1));
    }
  }
}

TEST(BlendingMatrix, AddsUpColumnsThatAppearTwice) {
  const auto knots = KnotVector::periodic_uniform(3, 2).value();
  const std::vector<double> at_knot{0.0};
  const BlendingMatrix matrix = blending_matrix(knots, at_knot, 0);
  EXPECT_EQ(matrix.bandwidth, 4);
  const Eigen::MatrixXd dense = matrix.dense();
  // The four weights 1/6, 4/6, 1/6 and 0 belong to the two control points alternately.
  EXPECT_NEAR(dense(0, 0) + dense(0, 1), 1.0, 1e-15);
  EXPECT_NEAR(std::max(dense(0, 0), dense(0, 1)), 2.0 / 3, 1e-15);
}

TEST(BlendingMatrix, TakesParametersFromOutside) {
  const auto open = KnotVector::clamped_uniform(3, 6).value();
  const std::vector<double> outside{-1.0, 5.0}, ends{0.0, 1.0};
  EXPECT_EQ(blending_matrix(open, outside, 1).values, blending_matrix(open, ends, 1).values);

  const auto periodic = KnotVector::periodic_uniform(3, 8).value();
  const std::vector<double> wrapped{1.25, -0.75}, inside{0.25, 0.25};
  EXPECT_EQ(blending_matrix(periodic, wrapped, 0).values, blending_matrix(periodic, inside, 0).values);
}

// Compares condition numbers with a published table, which has three digits and comes from another
// implementation of the same sampling.
TEST(BlendingMatrix, IsAsWellConditionedAsTheTableSays) {
  struct Row {
    int degree, controls, factor;
    double condition;
  };
  const Row table[] = {{3, 8, 1, 6.7},   {3, 8, 2, 4.65},   {3, 8, 4, 4.80},  {3, 32, 1, 238},
                       {3, 32, 2, 4.66}, {3, 32, 4, 4.64},  {5, 8, 1, 31.4},  {5, 8, 2, 16.6},
                       {5, 8, 4, 16.7},  {5, 32, 1, 1.4e6}, {5, 32, 2, 15.3}, {5, 32, 4, 12.8}};
  for (const Row& row : table) {
    const auto knots = KnotVector::clamped_uniform(row.degree, row.controls).value();
    const auto parameters = uniform_parameters(knots, row.controls * row.factor);
    const double found = condition(blending_matrix(knots, parameters, 0).dense());
    EXPECT_NEAR(found / row.condition, 1.0, 0.04)
        << "degree " << row.degree << ", " << row.controls << " control points, factor " << row.factor;
  }
}

TEST(BlendingMatrix, PeriodicCubicIsWellConditionedAtKnots) {
  for (const int controls : {4, 8, 16, 32}) {
    const auto knots = KnotVector::periodic_uniform(3, controls).value();
    const auto at_knots = uniform_parameters_without_seam(knots, controls);
    // The exact condition number is 3.
    EXPECT_NEAR(condition(blending_matrix(knots, at_knots, 0).dense()), 3.0, 1e-12);
    const auto twice = uniform_parameters_without_seam(knots, 2 * controls);
    EXPECT_LE(condition(blending_matrix(knots, twice, 0).dense()), 4.3);
  }
}

// A periodic cubic curve whose control polygon is regular, with corners on the unit circle, has known radii
// at its knots and halfway between them.
TEST(BlendingMatrix, PeriodicCubicCircleHasItsRadii) {
  for (const int controls : {8, 16, 32}) {
    const auto knots = KnotVector::periodic_uniform(3, controls).value();
    const double turn = 2.0 * std::numbers::pi / controls;
    Eigen::MatrixXd polygon(controls, 2);
    for (int i = 0; i < controls; ++i) polygon.row(i) << std::cos(i * turn), std::sin(i * turn);
    const auto parameters = uniform_parameters_without_seam(knots, 2 * controls);
    const Eigen::MatrixXd curve = blending_matrix(knots, parameters, 0).dense() * polygon;
    const double at_knot = (2.0 + std::cos(turn)) / 3.0;
    const double mid_span = (23.0 * std::cos(turn / 2) + std::cos(1.5 * turn)) / 24.0;
    for (int i = 0; i < curve.rows(); ++i) {
      // The tolerance is a few units in the last place of numbers near 1.
      EXPECT_NEAR(curve.row(i).norm(), i % 2 == 0 ? at_knot : mid_span, 1e-15 * 4);
    }
  }
}

double distance_from_inverse(const KnotVector& knots, const std::vector<double>& parameters) {
  const auto inverse = pseudo_inverse(knots, parameters);
  EXPECT_TRUE(inverse.ok()) << (inverse.ok() ? "" : inverse.error().message);
  if (!inverse.ok()) return 1.0;
  const Eigen::MatrixXd product = inverse.value() * blending_matrix(knots, parameters, 0).dense();
  return (product - Eigen::MatrixXd::Identity(product.rows(), product.cols())).cwiseAbs().maxCoeff();
}

TEST(PseudoInverse, InvertsFromTheLeft) {
  for (int degree = 1; degree <= max_degree; ++degree) {
    for (const int controls : {10, 24}) {
      const auto clamped = KnotVector::clamped_uniform(degree, controls).value();
      const auto periodic = KnotVector::periodic_uniform(degree, controls).value();
      for (const int factor : {2, 4}) {
        // The rounding error is the condition number, up to 1e4 at degree 9, times a few dozen units in
        // the last place.
        EXPECT_LT(distance_from_inverse(clamped, uniform_parameters(clamped, factor * controls)), 1e-10);
        EXPECT_LT(
            distance_from_inverse(periodic, uniform_parameters_without_seam(periodic, factor * controls)),
            1e-10);
        EXPECT_LT(distance_from_inverse(periodic, uniform_parameters(periodic, factor * controls + 1)),
                  1e-10);
      }
    }
  }
}

// Inverting A^T A would give an error of 125 here; QR loses about ten digits.
TEST(PseudoInverse, SurvivesDegreeNineWithAsManySamplesAsControlPoints) {
  const auto knots = KnotVector::clamped_uniform(9, 24).value();
  EXPECT_LT(distance_from_inverse(knots, uniform_parameters(knots, 24)), 1e-6);
}

TEST(PseudoInverse, IsTheLeastSquaresSolution) {
  const auto knots = KnotVector::clamped_uniform(3, 8).value();
  const auto parameters = uniform_parameters(knots, 30);
  const Eigen::MatrixXd a = blending_matrix(knots, parameters, 0).dense();
  const Eigen::MatrixXd projection = a * pseudo_inverse(knots, parameters).value();
  // The tolerance covers the rounding of entries below 1, multiplied by a condition number below 10.
  EXPECT_LT((projection - projection.transpose()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((projection * projection - projection).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(PseudoInverse, RefitsFiftySamplesToTheControlPointsTheyCameFrom) {
  const auto knots = KnotVector::clamped_uniform(3, 8).value();
  const auto parameters = uniform_parameters(knots, 50);
  Random random(4);
  Eigen::VectorXd controls(8);
  for (int i = 0; i < 8; ++i) controls(i) = random.uniform(-1, 1);
  const Eigen::VectorXd samples = blending_matrix(knots, parameters, 0).dense() * controls;
  EXPECT_LT((pseudo_inverse(knots, parameters).value() * samples - controls).cwiseAbs().maxCoeff(), 1e-14);
}

void expect_inverse_refused(const KnotVector& knots, const std::vector<double>& parameters, ErrorCode code) {
  const auto inverse = pseudo_inverse(knots, parameters);
  ASSERT_FALSE(inverse.ok());
  EXPECT_EQ(inverse.error().code, code) << inverse.error().message;
}

TEST(PseudoInverse, RefusesThePeriodicTraps) {
  for (const int controls : {4, 8, 20}) {
    for (int degree = 1; degree <= max_degree; ++degree) {
      const auto knots = KnotVector::periodic_uniform(degree, controls).value();
      std::vector<double> parameters = uniform_parameters_without_seam(knots, controls);
      if (degree % 2 == 1) {
        for (double& u : parameters) u += 0.5 / controls;
      }
      expect_inverse_refused(knots, parameters, ErrorCode::degenerate);
    }
  }
}

TEST(PseudoInverse, RefusesTooFewSamples) {
  const auto knots = KnotVector::clamped_uniform(3, 8).value();
  expect_inverse_refused(knots, uniform_parameters(knots, 7), ErrorCode::too_few);
  expect_inverse_refused(knots, {}, ErrorCode::too_few);
}

TEST(PseudoInverse, RefusesSamplesThatRepeat) {
  const auto knots = KnotVector::clamped_uniform(1, 4).value();
  expect_inverse_refused(knots, {0, 0, 0.4, 0.4, 1, 1}, ErrorCode::too_few);
}

TEST(SchoenbergWhitney, NamesTheControlPointInAGap) {
  const auto knots = KnotVector::clamped_uniform(3, 20).value();
  std::vector<double> parameters;
  for (const double u : uniform_parameters(knots, 60)) {
    if (u <= 0.40 || u >= 0.65) parameters.push_back(u);
  }
  ASSERT_EQ(parameters.size(), 45u);
  const Eigen::MatrixXd matrix = blending_matrix(knots, parameters, 0).dense();
  EXPECT_LT(Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues()(19), 1e-15);
  const Status status = check_schoenberg_whitney(knots, parameters);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::too_few);
  EXPECT_NE(status.error().message.find("control point 10 of 20"), std::string::npos)
      << status.error().message;
  EXPECT_NE(status.error().message.find("between 0.4117647058823529 and 0.6470588235294118"),
            std::string::npos)
      << status.error().message;
  expect_inverse_refused(knots, parameters, ErrorCode::too_few);
}

TEST(SchoenbergWhitney, NamesTheControlPointInAPeriodicGap) {
  const auto knots = KnotVector::periodic_uniform(3, 20).value();
  std::vector<double> parameters;
  for (const double u : uniform_parameters_without_seam(knots, 80)) {
    if (u >= 0.15 && u <= 0.85) parameters.push_back(u);
  }
  const Status status = check_schoenberg_whitney(knots, parameters);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("between 0.85 and 0.05"), std::string::npos)
      << status.error().message;
}

// Compares the Schoenberg-Whitney condition with the rank of the matrix for random samplings. Full rank
// always requires the condition. In a periodic direction, the condition does not ensure full rank.
TEST(SchoenbergWhitney, AgreesWithTheRank) {
  Random random(5);
  int refused = 0;
  for (int repeat = 0; repeat < 400; ++repeat) {
    const KnotVector knots = random_knots(random, random.integer(1, 5), KnotKind(random.integer(0, 2)));
    const int controls = knots.control_point_count();
    std::vector<double> parameters(static_cast<std::size_t>(controls) + random.integer(0, 3));
    for (double& u : parameters) u = random.uniform(knots.domain_start(), knots.domain_end());
    const Eigen::MatrixXd matrix = blending_matrix(knots, parameters, 0).dense();
    const double smallest = Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues()(controls - 1);
    if (!check_schoenberg_whitney(knots, parameters).ok()) {
      ++refused;
      EXPECT_LT(smallest, 1e-14);
    } else if (!knots.is_periodic()) {
      EXPECT_GT(smallest, 1e-14);
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace spoonbill
