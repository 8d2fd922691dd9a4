#include "engine/bspline/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

TEST(Grid, UniformParametersIncludeBothEnds) {
  const auto knots = KnotVector::open(1, {-0.3, -0.3, 0.1, 0.7, 0.7}).value();
  for (int count = 2; count < 300; ++count) {
    const auto parameters = uniform_parameters(knots, count);
    ASSERT_EQ(parameters.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(parameters.front(), -0.3);
    EXPECT_EQ(parameters.back(), 0.7);
    EXPECT_TRUE(make_grid(knots, knots, parameters, parameters).ok());
  }
}

TEST(Grid, UniformParametersWithoutSeamStopOneShort) {
  const auto knots = KnotVector::periodic_uniform(2, 4).value();
  EXPECT_EQ(uniform_parameters_without_seam(knots, 4), (std::vector<double>{0, 0.25, 0.5, 0.75}));
}

TEST(Grid, HoldsTheMatricesOfBothDirections) {
  const auto u = KnotVector::clamped_uniform(3, 6).value();
  const auto v = KnotVector::periodic_uniform(2, 5).value();
  const Grid grid = make_grid(u, v, uniform_parameters(u, 7), uniform_parameters(v, 9)).value();
  EXPECT_EQ(grid.rows(), 7);
  EXPECT_EQ(grid.columns(), 9);
  EXPECT_EQ(grid.u.first_derivatives.values, blending_matrix(u, grid.u.parameters, 1).values);
  EXPECT_EQ(grid.v.second_derivatives.values, blending_matrix(v, grid.v.parameters, 2).values);
}

void expect_grid_refused(std::vector<double> u_parameters, std::vector<double> v_parameters,
                         const std::string& part) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  const auto grid = make_grid(knots, knots, std::move(u_parameters), std::move(v_parameters));
  ASSERT_FALSE(grid.ok()) << "accepted, though it should be refused with: " << part;
  EXPECT_NE(grid.error().message.find(part), std::string::npos) << grid.error().message;
}

TEST(Grid, RefusesBadParametersByName) {
  expect_grid_refused({0, 1}, {}, "direction v: 0 parameters are too few");
  expect_grid_refused({0.5}, {0, 1}, "direction u: 1 parameters are too few");
  expect_grid_refused({0, 0.5, 0.5, 1}, {0, 1},
                      "direction u: parameter 2 (0.5) is not greater than parameter 1 (0.5)");
  expect_grid_refused({0, 1}, {0, 0.5, 0.4},
                      "direction v: parameter 2 (0.4) is not greater than parameter 1 (0.5)");
  expect_grid_refused({0, 1.5}, {0, 1}, "direction u: parameter 1 (1.5) is outside the domain 0 to 1");
  expect_grid_refused({0, 1}, {std::numeric_limits<double>::quiet_NaN(), 1},
                      "direction v: parameter 0 (nan)");
}

TEST(Grid, NestedLevelsAreRowsOfTheFinest) {
  Random random(6);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const KnotVector knots = random_knots(random);
    const NestedParameters nested = nested_parameters(knots, random.integer(1, 3), 3);
    const BlendingMatrix finest = blending_matrix(knots, nested.parameters, 0);
    for (int level = 0; level <= nested.levels; ++level) {
      std::vector<double> coarse;
      coarse.reserve(static_cast<std::size_t>(nested.count(level)));
      for (int i = 0; i < nested.count(level); ++i) {
        coarse.push_back(nested.parameters[i * nested.stride(level)]);
      }
      EXPECT_EQ(coarse.front(), knots.domain_start());
      EXPECT_EQ(coarse.back(), knots.domain_end());
      const BlendingMatrix matrix = blending_matrix(knots, coarse, 0);
      for (int i = 0; i < matrix.rows; ++i) {
        const int row = i * nested.stride(level);
        EXPECT_EQ(matrix.first[i], finest.first[row]);
        EXPECT_TRUE(std::equal(matrix.values.begin() + i * matrix.bandwidth,
                               matrix.values.begin() + (i + 1) * matrix.bandwidth,
                               finest.values.begin() + row * matrix.bandwidth));
      }
    }
  }
}

TEST(Grid, NoNestedCellHoldsAKnotInside) {
  Random random(7);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const KnotVector knots = random_knots(random);
    const NestedParameters nested = nested_parameters(knots, 1, 2);
    for (const double knot : knots.breakpoints()) {
      for (int i = 0; i < nested.count(0); ++i) {
        if (nested.parameters[i * nested.stride(0)] == knot) break;
        EXPECT_LT(nested.parameters[i * nested.stride(0)], knot);
      }
    }
    EXPECT_EQ(nested.count(0), static_cast<int>(knots.breakpoints().size()));
    EXPECT_EQ(nested.count(2), static_cast<int>(nested.parameters.size()));
    EXPECT_TRUE(make_grid(knots, knots, nested.parameters, nested.parameters).ok());
  }
}

}  // namespace
}  // namespace spoonbill
