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

namespace {

// Returns the length in bytes of the UTF-8 character at the start of the text and sets `number` to its code
// point. If the text does not start with a valid character, returns 0 and leaves `number` unchanged.
std::size_t read_character(std::string_view text, unsigned& number) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned>(static_cast<unsigned char>(text[k])); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0 || length > text.size()) return 0;
  unsigned read = length == 1 ? first : first & (0xFFU >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0U) != 0x80U) return 0;
    read = read << 6U | (byte(k) & 0x3FU);
  }
  const bool is_surrogate = read >= 0xD800 && read <= 0xDFFF;
  const bool is_overlong = (length == 3 && read < 0x800) || (length == 4 && read < 0x10000);
  if (is_surrogate || is_overlong || read > 0x10FFFF) return 0;
  number = read;
  return length;
}

bool is_unprintable(unsigned number) {
  const auto within = [&](unsigned low, unsigned high) { return number >= low && number <= high; };
  return within(0x00, 0x1F) || within(0x7F, 0x9F) || number == 0x061C || within(0x200E, 0x200F) ||
         within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

template <class Replacement>
std::string replace_unprintable(std::string_view text, const Replacement& replacement) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    unsigned number = static_cast<unsigned char>(text[0]);
    const std::size_t length = read_character(text, number);
    if (length == 0 || is_unprintable(number)) {
      result += replacement(number);
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

}  // namespace

std::string escaped(std::string_view text) {
  return replace_unprintable(text, [](unsigned number) {
    std::array<char, 8> escape{};
    std::snprintf(escape.data(), escape.size(), "\\u%04x", number & 0xFFFFU);
    return std::string(escape.data());
  });
}

std::string without_controls(std::string_view text) {
  return replace_unprintable(text, [](unsigned) { return std::string("?"); });
}

std::string excerpt(std::string_view text, std::size_t longest) {
  if (longest < text.size()) {
    while (longest > 0 && (static_cast<unsigned char>(text[longest]) & 0xC0U) == 0x80U) --longest;
  }
  return without_controls(text.substr(0, longest));
}

}  // namespace spoonbill
