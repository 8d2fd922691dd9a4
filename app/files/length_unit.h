// The units of length that people may name.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace spoonbill {

struct LengthUnit {
  std::string_view name;
  double metres;
};

inline constexpr LengthUnit millimetre{"mm", 1e-3}, metre{"m", 1.0};
inline constexpr std::array<LengthUnit, 4> length_units{millimetre, LengthUnit{"cm", 1e-2}, metre,
                                                        LengthUnit{"in", 0.0254}};

// By its name, or "inch".
inline std::optional<LengthUnit> unit_named(std::string_view name) {
  if (name == "inch") name = "in";
  for (const LengthUnit& unit : length_units) {
    if (unit.name == name) return unit;
  }
  return std::nullopt;
}

}  // namespace spoonbill
