#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/bspline/grid.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

Grid grid_of(const KnotVector& u, const KnotVector& v, int rows, int columns) {
  return make_grid(
             u, v, u.is_periodic() ? uniform_parameters_without_seam(u, rows) : uniform_parameters(u, rows),
             v.is_periodic() ? uniform_parameters_without_seam(v, columns) : uniform_parameters(v, columns))
      .value();
}

Grid usual_grid() {
  const auto u = KnotVector::periodic_uniform(3, 10).value();
  const auto v = KnotVector::clamped_uniform(3, 13).value();
  return grid_of(u, v, 20, 29);
}

// Returns rows of samples with the stride of the refit. The gaps at the ends of the rows contain a large
// number, which must have no effect.
AlignedVector<float> with_gaps(const DisplacementRefit& refit, const std::vector<float>& samples) {
  AlignedVector<float> rows(static_cast<std::size_t>(refit.sample_rows() * refit.sample_stride()), 1e3f);
  for (int i = 0; i < refit.sample_rows(); ++i) {
    std::copy_n(&samples[static_cast<std::size_t>(i * refit.sample_columns())], refit.sample_columns(),
                &rows[static_cast<std::size_t>(i * refit.sample_stride())]);
  }
  return rows;
}

std::vector<float> random_numbers(Random& random, int count, double size) {
  std::vector<float> numbers;
  numbers.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) numbers.push_back(static_cast<float>(random.uniform(-size, size)));
  return numbers;
}

TEST(DisplacementRefit, ZeroInGivesZeroOutAndAllocatesNothing) {
  const Grid grid = usual_grid();
  for (const InstructionSet set : available_instruction_sets()) {
    auto refit = DisplacementRefit::make(grid, set).value();
    const AlignedVector<float> samples = with_gaps(refit, std::vector<float>(20 * 29, 0.0f));
    std::vector<float> controls(10 * 13, 1.0f);
    const std::size_t before = allocation_count();
    refit.control_displacement(samples.data(), controls.data());
    EXPECT_EQ(allocation_count(), before);
    for (const float displacement : controls) EXPECT_EQ(displacement, 0.0f);
  }
}

TEST(DisplacementRefit, GivesBackTheDisplacementOfControlPoints) {
  Random random(23);
  const Grid grid = usual_grid();
  auto refit = DisplacementRefit::make(grid, best_instruction_set()).value();
  EXPECT_EQ(refit.sample_rows(), 20);
  EXPECT_EQ(refit.sample_columns(), 29);
  Eigen::MatrixXd controls(10, 13);
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 13; ++j) controls(i, j) = random.uniform(-1e-3, 1e-3);
  }
  const Eigen::MatrixXd samples = grid.u.values.dense() * controls * grid.v.values.dense().transpose();
  std::vector<float> displacement;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 29; ++j) displacement.push_back(static_cast<float>(samples(i, j)));
  }
  std::vector<float> found(10 * 13);
  refit.control_displacement(with_gaps(refit, displacement).data(), found.data());
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 13; ++j) {
      // The tolerance is the rounding of displacements up to 1 mm in single precision, times the norms of the
      // two pseudo-inverses, which are below 10.
      EXPECT_NEAR(found[i * 13 + j], controls(i, j), 1e-8);
    }
  }
}

TEST(DisplacementRefit, GivesTheSameBitsOnEveryInstructionSet) {
  Random random(24);
  for (int repeat = 0; repeat < 40; ++repeat) {
    const auto u = KnotVector::clamped_uniform(3, random.integer(4, 20)).value();
    const auto v = KnotVector::clamped_uniform(2, random.integer(3, 40)).value();
    const int rows = 2 * u.control_point_count() + random.integer(0, 9);
    const int columns = 2 * v.control_point_count() + random.integer(0, 9);
    const Grid grid = grid_of(u, v, rows, columns);
    const auto samples = random_numbers(random, rows * columns, 0.1);
    std::vector<std::vector<float>> results;
    for (const InstructionSet set : available_instruction_sets()) {
      results.emplace_back(static_cast<std::size_t>(u.control_point_count() * v.control_point_count()));
      auto refit = DisplacementRefit::make(grid, set).value();
      refit.control_displacement(with_gaps(refit, samples).data(), results.back().data());
      EXPECT_EQ(results.back(), results.front()) << name_of(set);
    }
  }
}

// Compares a hash of the result with a recorded one. The bits enter the hash of the simulation's state: a
// change here changes every recorded state hash.
TEST(DisplacementRefit, HasTheBitsItHadBefore) {
  const Grid grid = usual_grid();
  auto refit = DisplacementRefit::make(grid, best_instruction_set()).value();
  Random random(25);
  const auto samples = random_numbers(random, 20 * 29, 0.01);
  std::vector<float> controls(10 * 13);
  refit.control_displacement(with_gaps(refit, samples).data(), controls.data());
  std::uint64_t hash = 14695981039346656037ull;  // start value of FNV-1a
  for (const float displacement : controls) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &displacement, sizeof bits);
    hash = (hash ^ bits) * 1099511628211ull;
  }
  EXPECT_EQ(hash, 6863324850725980467u);
}

TEST(DisplacementRefit, RefusesGridsThatDoNotDetermineTheControlPoints) {
  const auto u = KnotVector::clamped_uniform(3, 8).value();
  const auto v = KnotVector::periodic_uniform(3, 8).value();
  const auto too_few = DisplacementRefit::make(grid_of(u, v, 7, 16), best_instruction_set());
  ASSERT_FALSE(too_few.ok());
  EXPECT_EQ(too_few.error().code, ErrorCode::too_few) << too_few.error().message;

  std::vector<double> mid_spans = uniform_parameters_without_seam(v, 8);
  for (double& parameter : mid_spans) parameter += 1.0 / 16;
  const Grid trap = make_grid(u, v, uniform_parameters(u, 16), mid_spans).value();
  const auto trapped = DisplacementRefit::make(trap, best_instruction_set());
  ASSERT_FALSE(trapped.ok());
  EXPECT_EQ(trapped.error().code, ErrorCode::degenerate) << trapped.error().message;
}

TEST(DisplacementRefit, HeldColumnsNeverMoveAndKeptEndsFollowTheirSamples) {
  Random random(26);
  const Grid grid = usual_grid();
  RefitConstraints constraints;
  constraints.fixed_columns.assign(13, 0);
  constraints.fixed_columns[4] = constraints.fixed_columns[5] = 1;
  constraints.keep_first = constraints.keep_last = true;
  auto refit = DisplacementRefit::make(grid, constraints, best_instruction_set()).value();
  // All samples of the first column have the same displacement, as at a pole.
  auto samples = random_numbers(random, 20 * 29, 0.01);
  for (int i = 0; i < 20; ++i) samples[i * 29] = 0.007f;
  std::vector<float> controls(10 * 13);
  refit.control_displacement(with_gaps(refit, samples).data(), controls.data());
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(controls[i * 13 + 4], 0.0f);
    EXPECT_EQ(controls[i * 13 + 5], 0.0f);
    // A row of the periodic pseudo-inverse sums to one up to rounding.
    EXPECT_NEAR(controls[i * 13], 0.007f, 1e-8);
  }
}

}  // namespace
}  // namespace spoonbill
