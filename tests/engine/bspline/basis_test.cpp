#include "engine/bspline/basis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

double sum_of(const BasisFunctions& basis, int derivative, int degree) {
  double sum = 0.0;
  for (int j = 0; j <= degree; ++j) sum += basis.values[derivative][j];
  return sum;
}

// Tolerance of sums of at most ten positive numbers below 1, each accurate to a few units in the last place.
constexpr double unity_tolerance = 1e-14;

TEST(Basis, SumsToOneEverywhereForEveryDegree) {
  Random random(1);
  for (int degree = 1; degree <= max_degree; ++degree) {
    for (const KnotKind kind : {KnotKind::clamped, KnotKind::unclamped, KnotKind::periodic}) {
      for (int repeat = 0; repeat < 20; ++repeat) {
        const KnotVector knots = random_knots(random, degree, kind);
        std::vector<double> parameters = random_parameters(random, knots, 40);
        for (const double knot : knots.breakpoints()) {
          for (const double u : {std::nextafter(knot, -1e9), knot, std::nextafter(knot, 1e9)}) {
            parameters.push_back(u);
          }
        }
        for (const double u : parameters) {
          const BasisFunctions basis = basis_functions(knots, knots.into_domain(u));
          EXPECT_NEAR(sum_of(basis, 0, degree), 1.0, unity_tolerance) << "degree " << degree << " at " << u;
          for (int j = 0; j <= degree; ++j) EXPECT_GE(basis.values[0][j], 0.0);
        }
      }
    }
  }
}

TEST(Basis, TheClosedLastSpanReachesTheLastKnot) {
  const auto knots = KnotVector::clamped_uniform(3, 7).value();
  const BasisFunctions basis = basis_functions(knots, 1.0);
  EXPECT_EQ(basis.values[0][3], 1.0);
  EXPECT_EQ(knots.control_index(basis.span, 3), 6);
}

TEST(Basis, DerivativesSumToZero) {
  Random random(2);
  for (int repeat = 0; repeat < 500; ++repeat) {
    const KnotVector knots = random_knots(random);
    for (const double u : random_parameters(random, knots, 10)) {
      const BasisFunctions basis = basis_functions(knots, knots.into_domain(u));
      for (int d = 1; d <= max_basis_derivative; ++d) {
        double magnitude = 0.0;
        for (int j = 0; j <= knots.degree(); ++j) magnitude += std::abs(basis.values[d][j]);
        // The sum is zero except for rounding, which is a few units in the last place of the terms.
        EXPECT_NEAR(sum_of(basis, d, knots.degree()), 0.0, 1e-14 * magnitude);
      }
    }
  }
}

TEST(Basis, DerivativesAboveTheDegreeAreZero) {
  const auto knots = KnotVector::clamped_uniform(1, 4).value();
  const BasisFunctions basis = basis_functions(knots, 0.4);
  EXPECT_EQ(basis.values[2][0], 0.0);
  EXPECT_EQ(basis.values[2][1], 0.0);
  EXPECT_NE(basis.values[1][0], 0.0);
}

double combination(const KnotVector& knots, const std::array<double, 8>& coefficients, double u,
                   int derivative) {
  const BasisFunctions basis = basis_functions(knots, u);
  double sum = 0.0;
  for (int j = 0; j <= knots.degree(); ++j) {
    sum += basis.values[derivative][j] * coefficients[knots.control_index(basis.span, j)];
  }
  return sum;
}

TEST(Basis, ReproducesPolynomialsFromTheirCoefficients) {
  const auto knots = KnotVector::clamped_uniform(3, 8).value();
  const std::array<double, 8> linear{0, 1.0 / 15, .2, .4, .6, .8, 14.0 / 15, 1};
  // The coefficients of u^2 are exact here: 2/75, 11/75 and so on. The published table rounds them to six
  // digits.
  const std::array<double, 8> square{0, 0, 2.0 / 75, 11.0 / 75, 26.0 / 75, 47.0 / 75, 65.0 / 75, 1};
  const std::array<double, 8> cube{0, 0, 0, .048, .192, .48, .8, 1};
  // The tolerances are a few units in the last place of 1 for values, which are up to 1, and of 600 for
  // derivatives. Derivatives are up to 6 and are sums of terms up to 600.
  constexpr double value_tolerance = 1e-15 * 4, derivative_tolerance = 1e-12;
  for (int i = 0; i <= 100; ++i) {
    const double u = i / 100.0;
    EXPECT_NEAR(combination(knots, linear, u, 0), u, value_tolerance);
    EXPECT_NEAR(combination(knots, square, u, 0), u * u, value_tolerance);
    EXPECT_NEAR(combination(knots, cube, u, 0), u * u * u, value_tolerance);
    EXPECT_NEAR(combination(knots, cube, u, 1), 3 * u * u, derivative_tolerance);
    EXPECT_NEAR(combination(knots, cube, u, 2), 6 * u, derivative_tolerance);
  }
}

// With r control points and uniform periodic knots of spacing 1, B_i(u) = B_0((u - i + r) mod r).
TEST(Basis, UniformPeriodicFunctionsAreShiftedCopies) {
  constexpr int count = 7;
  std::vector<double> units;
  for (int i = 0; i <= count; ++i) units.push_back(i);
  for (int degree = 1; degree <= max_degree; ++degree) {
    const auto knots = KnotVector::periodic(degree, units).value();
    const auto function = [&](int control, double u) {
      const BasisFunctions basis = basis_functions(knots, knots.into_domain(u));
      double sum = 0.0;
      for (int j = 0; j <= degree; ++j) {
        if (knots.control_index(basis.span, j) == control) sum += basis.values[0][j];
      }
      return sum;
    };
    for (int control = 0; control < count; ++control) {
      for (int eighth = 0; eighth < 8 * count; ++eighth) {
        const double u = eighth / 8.0;
        EXPECT_NEAR(function(control, u), function(0, std::fmod(u - control + count, count)),
                    unity_tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
