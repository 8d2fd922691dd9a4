#include "engine/exchange/scans/number_lines.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr std::string_view blanks = " \t\r\v\f\n";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

template <class Number>
double read_as(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> copy;
  std::memcpy(copy.data(), bytes, copy.size());
  if (swapped) std::reverse(copy.begin(), copy.end());
  Number number;
  std::memcpy(&number, copy.data(), copy.size());
  return static_cast<double>(number);
}

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return text;
}

std::string_view extract_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view extract_word(std::string_view& text, std::string_view separators) {
  const auto is_separator = [&](char character) {
    return blanks.find(character) != std::string_view::npos ||
           separators.find(character) != std::string_view::npos;
  };
  const char* begin = std::find_if_not(text.data(), text.data() + text.size(), is_separator);
  const char* end = std::find_if(begin, text.data() + text.size(), is_separator);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return {begin, static_cast<std::size_t>(end - begin)};
}

std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (end != word.data() + word.size() || word.empty()) return {};
  if (error == std::errc::result_out_of_range) {
    // A number with a negative exponent, or with no exponent and an integer part of zero, is too small and
    // becomes zero. Any other number out of range is too large and becomes infinite.
    const std::size_t exponent = word.find_first_of("eE");
    const bool is_small =
        exponent != std::string_view::npos
            ? word.substr(exponent + 1).starts_with('-')
            : word.substr(0, word.find('.')).find_first_of("123456789") == std::string_view::npos;
    return is_small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

std::optional<std::uint64_t> parse_count(std::string_view word) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return count;
}

std::size_t byte_count(NumberType type) {
  switch (type) {
    case NumberType::int8:
    case NumberType::uint8:
      return 1;
    case NumberType::int16:
    case NumberType::uint16:
      return 2;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4;
    default:
      return 8;
  }
}

double number_at(const char* bytes, NumberType type, bool swapped) {
  SPOONBILL_ASSERT_DEBUG(bytes != nullptr);
  switch (type) {
    case NumberType::int8:
      return read_as<std::int8_t>(bytes, swapped);
    case NumberType::uint8:
      return read_as<std::uint8_t>(bytes, swapped);
    case NumberType::int16:
      return read_as<std::int16_t>(bytes, swapped);
    case NumberType::uint16:
      return read_as<std::uint16_t>(bytes, swapped);
    case NumberType::int32:
      return read_as<std::int32_t>(bytes, swapped);
    case NumberType::uint32:
      return read_as<std::uint32_t>(bytes, swapped);
    case NumberType::int64:
      return read_as<std::int64_t>(bytes, swapped);
    case NumberType::uint64:
      return read_as<std::uint64_t>(bytes, swapped);
    case NumberType::float32:
      return read_as<float>(bytes, swapped);
    default:
      return read_as<double>(bytes, swapped);
  }
}

}  // namespace spoonbill
