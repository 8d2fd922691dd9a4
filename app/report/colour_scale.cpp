#include "app/report/colour_scale.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spoonbill {

std::array<std::uint8_t, 3> colour_at(double share) {
  static constexpr std::array<std::array<double, 3>, 9> steps{{{68, 1, 84},
                                                               {71, 45, 123},
                                                               {59, 82, 139},
                                                               {44, 114, 142},
                                                               {33, 145, 140},
                                                               {40, 174, 128},
                                                               {94, 201, 98},
                                                               {173, 220, 48},
                                                               {253, 231, 37}}};
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(steps.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), steps.size() - 2);
  const double rest = place - static_cast<double>(below);
  std::array<std::uint8_t, 3> colour;
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = steps[below][k] + rest * (steps[below + 1][k] - steps[below][k]);
    colour[k] = static_cast<std::uint8_t>(std::lround(value));
  }
  return colour;
}

}  // namespace spoonbill
