#include "engine/exchange/length.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "engine/base/text.h"

namespace spoonbill {

namespace {

constexpr double millimetres_per_metre = 1000.0;
constexpr std::size_t longest_whole = 64;
constexpr std::size_t longest_fraction = 350;  // of the smallest double, with its digits

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::optional<double> shortest_millimetres(double metres) {
  const double near = metres * millimetres_per_metre;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::optional<double> best;
  std::size_t best_length = 0;
  for (const double candidate : {near, std::nextafter(near, -infinity), std::nextafter(near, infinity)}) {
    if (!same_bits(candidate / millimetres_per_metre, metres)) continue;
    const std::size_t length = number_text(candidate).size();
    if (best && length >= best_length) continue;
    best = candidate;
    best_length = length;
  }
  return best;
}

// The shortest decimal of `metres` with its point moved by three places, which no double need be able to
// hold.
std::string decimal_millimetres(double metres) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), std::abs(metres), std::chars_format::scientific)
          .ptr;
  const std::string_view scientific(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::size_t e = scientific.find('e');
  std::string digits(1, scientific[0]);
  if (e > 1) digits += scientific.substr(2, e - 2);
  int exponent = 0;
  const std::size_t exponent_start = e + (scientific[e + 1] == '+' ? 2 : 1);
  std::from_chars(scientific.data() + exponent_start, scientific.data() + scientific.size(), exponent);

  int point = exponent + 1 + 3;  // digits before the decimal point
  if (point <= 0) {
    digits.insert(0, static_cast<std::size_t>(1 - point), '0');
    point = 1;
  }
  if (static_cast<int>(digits.size()) < point) {
    digits.append(static_cast<std::size_t>(point) - digits.size(), '0');
  }
  if (static_cast<int>(digits.size()) > point) digits.insert(static_cast<std::size_t>(point), 1, '.');
  return (std::signbit(metres) ? "-" : "") + digits;
}

bool is_plain_decimal(std::string_view text) {
  if (text.empty()) return false;
  if (text.front() == '-') text.remove_prefix(1);
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view fraction = point == std::string_view::npos ? "0" : text.substr(point + 1);
  if (whole.size() > longest_whole || fraction.size() > longest_fraction) return false;
  const auto all_digits = [](std::string_view part) {
    return !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return all_digits(whole) && all_digits(fraction);
}

}  // namespace

Json length_to_json(double metres) {
  if (const auto millimetres = shortest_millimetres(metres)) return number_to_json(*millimetres);
  return decimal_millimetres(metres);
}

std::optional<double> length_from_json(const Json& millimetres) {
  if (millimetres.is_number()) return millimetres.get<double>() / millimetres_per_metre;
  if (!millimetres.is_string()) return std::nullopt;
  const auto& text = millimetres.get_ref<const std::string&>();
  if (!is_plain_decimal(text)) return std::nullopt;
  const std::string in_metres = text + "e-3";
  double metres = 0.0;
  const auto result = std::from_chars(in_metres.data(), in_metres.data() + in_metres.size(), metres);
  if (result.ec != std::errc{}) return std::nullopt;
  return metres;
}

}  // namespace spoonbill
