// Checks that peer libraries compute the same as our code. Otherwise their times could not be compared.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace spoonbill {

// Returns the largest difference of two lists of coordinates; infinite if their sizes differ.
template <class A, class B>
double largest_difference(const A& ours, const B& theirs) {
  if (ours.size() != theirs.size()) return INFINITY;
  double largest = 0.0;
  for (std::size_t k = 0; k < ours.size(); ++k)
    largest = std::max(largest, std::abs(static_cast<double>(ours[k]) - static_cast<double>(theirs[k])));
  return largest;
}

// Fails the benchmark if the difference is above the tolerance or is NaN.
inline void require_agreement(benchmark::State& state, double difference, double tolerance) {
  if (!(difference <= tolerance))
    state.SkipWithError(("the peer's result differs by " + std::to_string(difference)).c_str());
}

}  // namespace spoonbill
