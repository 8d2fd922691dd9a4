// The units of length that people may name.
#pragma once

#include <array>
#include <string_view>

namespace spoonbill {

struct LengthUnit {
  std::string_view name;
  double metres;
};

inline constexpr LengthUnit millimetre{"mm", 1e-3}, metre{"m", 1.0};
inline constexpr std::array<LengthUnit, 4> length_units{millimetre, LengthUnit{"cm", 1e-2}, metre,
                                                        LengthUnit{"in", 0.0254}};

}  // namespace spoonbill
