#include "engine/base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace spoonbill {

std::string number_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

std::string millimetres_with_digits(double length_m, int digits) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), 1e3 * length_m + 0.0,
                                 std::chars_format::general, digits)
                       .ptr;
  return std::string(text.data(), end) + " mm";
}

std::string short_length_text(double length_m) {
  return millimetres_with_digits(length_m, 3);
}

std::string length_text(double length_m) {
  return millimetres_with_digits(length_m, 12);
}

std::string position_text(const Vector3& point_m) {
  const auto tenths = [&](int axis) { return std::round(1e4 * point_m[axis]) / 10.0 + 0.0; };
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "(%.1f, %.1f, %.1f) mm", tenths(0), tenths(1), tenths(2));
  return text.data();
}

std::string excerpt(std::string_view text, std::size_t longest) {
  if (longest < text.size()) {
    while (longest > 0 && (static_cast<unsigned char>(text[longest]) & 0xC0U) == 0x80U) --longest;
  }
  std::string line(text.substr(0, longest));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char letter) { return letter < ' ' || letter == 127; }, '?');
  return line;
}

}  // namespace spoonbill
