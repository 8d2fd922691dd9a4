// Values below which a share of others lie.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/assert.h"

namespace spoonbill {

// The share is from 0 to 1; zero of none.
inline double quantile_of(std::vector<double> values, double share) {
  SPOONBILL_ASSERT(share >= 0.0 && share <= 1.0);
  if (values.empty()) return 0.0;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

inline double median_of(std::vector<double> values) {
  return quantile_of(std::move(values), 0.5);
}

}  // namespace spoonbill
