// A point as messages and reports show it.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "engine/base/pose.h"

namespace spoonbill {

// "(10.0, -5.2, 0.0) mm", without the sign of a zero.
inline std::string place_text(const Vector3& point_m) {
  const auto tenths = [&](int axis) { return std::round(1e4 * point_m[axis]) / 10.0 + 0.0; };
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "(%.1f, %.1f, %.1f) mm", tenths(0), tenths(1), tenths(2));
  return text.data();
}

}  // namespace spoonbill
