// The units of length that people can name.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace spoonbill {

struct LengthUnit {
  std::string_view name;
  double metres;  // length of one unit
};

inline constexpr LengthUnit millimetre{"mm", 1e-3}, metre{"m", 1.0};
inline constexpr std::array<LengthUnit, 4> length_units{millimetre, LengthUnit{"cm", 1e-2}, metre,
                                                        LengthUnit{"in", 0.0254}};

// Returns the unit of that name; "inch" is a synonym of "in".
inline std::optional<LengthUnit> find_length_unit(std::string_view name) {
  if (name == "inch") name = "in";
  for (const LengthUnit& unit : length_units) {
    if (unit.name == name) return unit;
  }
  return std::nullopt;
}

}  // namespace spoonbill
