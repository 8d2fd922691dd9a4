// Random values for tests of the haptic side. They are the same on every machine, unlike those of the
// standard library's distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "engine/base/field.h"
#include "engine/base/geometry.h"

namespace spoonbill {

class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed) : engine_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double between(const Range<double>& range) { return between(range.low, range.high); }
  // Returns a random value that is evenly distributed over the orders of magnitude.
  double scaled(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool once_in(std::uint64_t count) { return engine_() % count == 0; }
  std::uint64_t bits() { return engine_(); }
  Vector3 in_box(const Vector3& half) {
    return {between(-half.x(), half.x()), between(-half.y(), half.y()), between(-half.z(), half.z())};
  }
  Vector3 direction() { return Vector3(between(-1, 1), between(-1, 1), between(-1, 1)).normalized(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace spoonbill
