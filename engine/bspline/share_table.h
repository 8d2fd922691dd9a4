// A monotone table from one quantity to another, looked up linearly.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/assert.h"

namespace spoonbill {

struct ShareTable {
  std::vector<double> from, to;  // `from` does not fall

  // Outside the table, its nearest end.
  double at(double x) const {
    SPOONBILL_ASSERT_DEBUG(!from.empty() && from.size() == to.size());
    const auto upper = std::upper_bound(from.begin(), from.end(), x);
    if (upper == from.begin()) return to.front();
    if (upper == from.end()) return to.back();
    const auto i = static_cast<std::size_t>(upper - from.begin());
    return to[i - 1] + (to[i] - to[i - 1]) * (x - from[i - 1]) / (from[i] - from[i - 1]);
  }
};

}  // namespace spoonbill
