// Numbers as error messages show them: the shortest decimals that read back as the same number, and lengths
// in millimetres.
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

// Without the sign of a zero.
inline std::string millimetres_with_digits(double length_m, int digits) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), 1e3 * length_m + 0.0,
                                 std::chars_format::general, digits)
                       .ptr;
  return std::string(text.data(), end) + " mm";
}

// Metres as millimetres with three significant digits.
inline std::string short_length_text(double length_m) {
  return millimetres_with_digits(length_m, 3);
}

// With all that a person may have said, but for the last digits, which the change of unit makes up: 0.009 m
// is 9.000000000000002 mm to a computer.
inline std::string length_text(double length_m) {
  return millimetres_with_digits(length_m, 12);
}

}  // namespace spoonbill
