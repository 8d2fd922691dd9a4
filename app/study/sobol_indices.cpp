#include "app/study/sobol_indices.h"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr int bootstrap_samples = 500;

// Returns the variance of the results at A in these rows.
double variance_of(const std::vector<double>& values, const std::vector<std::size_t>& rows) {
  double mean = 0.0, squares = 0.0;
  for (const std::size_t row : rows) mean += values[row];
  mean /= static_cast<double>(rows.size());
  for (const std::size_t row : rows) squares += (values[row] - mean) * (values[row] - mean);
  return squares / static_cast<double>(rows.size() - 1);
}

double mean_square_difference(const std::vector<double>& one, const std::vector<double>& other,
                              const std::vector<std::size_t>& rows) {
  double sum = 0.0;
  for (const std::size_t row : rows) sum += (one[row] - other[row]) * (one[row] - other[row]);
  return sum / static_cast<double>(rows.size());
}

SobolIndex estimate(const SensitivityValues& values, const std::vector<double>& mixed,
                    const std::vector<std::size_t>& rows) {
  const double variance = variance_of(values.a, rows);
  SobolIndex index;
  if (!(variance > 0.0)) return index;
  index.first = 1.0 - mean_square_difference(values.b, mixed, rows) / (2.0 * variance);
  index.total = mean_square_difference(values.a, mixed, rows) / (2.0 * variance);
  return index;
}

}  // namespace

std::vector<SobolIndex> find_sobol_indices(const SensitivityValues& values) {
  const std::size_t count = values.a.size();
  SPOONBILL_ASSERT(count >= 2 && values.b.size() == count);
  std::vector<std::size_t> rows(count);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::vector<SobolIndex> indices;
  for (const std::vector<double>& mixed : values.mixed) {
    SPOONBILL_ASSERT(mixed.size() == count);
    indices.push_back(estimate(values, mixed, rows));
  }
  std::mt19937 generator(1);
  std::vector<SobolIndex> squares(indices.size());
  for (int sample = 0; sample < bootstrap_samples; ++sample) {
    for (std::size_t& row : rows) row = generator() % count;
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const SobolIndex again = estimate(values, values.mixed[k], rows);
      squares[k].first += std::pow(again.first - indices[k].first, 2);
      squares[k].total += std::pow(again.total - indices[k].total, 2);
    }
  }
  for (std::size_t k = 0; k < indices.size(); ++k) {
    indices[k].first_error = std::sqrt(squares[k].first / bootstrap_samples);
    indices[k].total_error = std::sqrt(squares[k].total / bootstrap_samples);
  }
  return indices;
}

}  // namespace spoonbill
