// Numbers as error messages show them: the shortest decimals that read back as the same number, and lengths
// as they are told.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace spoonbill {

inline std::string number_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

// Metres as millimetres with three significant digits.
inline std::string short_length_text(double length_m) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), 1e3 * length_m, std::chars_format::general, 3)
          .ptr;
  return std::string(text.data(), end) + " mm";
}

}  // namespace spoonbill
