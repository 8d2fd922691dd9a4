// Sobol indices: how much of the variance of a result each factor explains. Pure mathematics.
#pragma once

#include <vector>

namespace spoonbill {

// Results of a function at the rows of the matrices A and B, and at those of A with one factor from B
// (list_sensitivity_cases()). All lists have the same length.
struct SensitivityValues {
  std::vector<double> a, b;
  std::vector<std::vector<double>> mixed;  // for each factor
};

struct SobolIndex {
  double first = 0.0;  // fraction of the variance that the factor explains alone
  double total = 0.0;  // with all its interactions
  // Standard errors, from 500 samples of the rows with replacement (bootstrap).
  double first_error = 0.0, total_error = 0.0;
};

// Estimates the indices of all factors by Jansen (1999): with V the variance of the results at A,
// first = 1 - mean((b - mixed)^2) / 2V and total = mean((a - mixed)^2) / 2V. Results that do not vary give
// zeros. There must be at least two rows.
std::vector<SobolIndex> find_sobol_indices(const SensitivityValues& values);

}  // namespace spoonbill
