// The largest value of a function of two parameters beside a sample of it: what lies between samples counts
// too. Pure; any thread.
#pragma once

#include <algorithm>
#include <array>

#include "engine/base/assert.h"

namespace spoonbill {

// By ever smaller steps, from halves of the samples' distances on; never less than the value at the sample.
// `value` must bear parameters outside of what was sampled by as much. No step is negative.
template <class Value>
double peak_near(const Value& value, double u, double v, double step_u, double step_v) {
  SPOONBILL_ASSERT(step_u >= 0.0 && step_v >= 0.0);
  constexpr int halvings = 10;
  constexpr std::array<std::array<int, 2>, 4> ways{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  double largest = value(u, v);
  for (int k = 0; k < halvings; ++k) {
    step_u *= 0.5;
    step_v *= 0.5;
    for (const auto& [along_u, along_v] : ways) {
      const double at_u = u + along_u * step_u, at_v = v + along_v * step_v;
      const double there = value(at_u, at_v);
      if (there <= largest) continue;
      largest = there;
      u = at_u;
      v = at_v;
    }
  }
  return largest;
}

}  // namespace spoonbill
