// Random values that are the same on every machine, unlike the distributions of the standard library. Where a
// call has several random arguments, they depend on the compiler, which chooses the order of evaluation.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "engine/base/geometry.h"

namespace spoonbill {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  bool once_in(std::uint64_t count) { return engine_() % count == 0; }
  int integer(int low, int high) {  // both limits included
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double uniform(const Range<double>& range) { return uniform(range.low, range.high); }
  // Returns a value between `low` and `high` whose logarithm is uniformly distributed.
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  Vector3 in_box(const Vector3& half) {
    return {uniform(-half.x(), half.x()), uniform(-half.y(), half.y()), uniform(-half.z(), half.z())};
  }
  Vector3 direction() {
    const double z = uniform(-1, 1), y = uniform(-1, 1), x = uniform(-1, 1);
    return Vector3(x, y, z).normalized();
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace spoonbill
