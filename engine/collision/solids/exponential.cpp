#include "engine/collision/solids/exponential.h"

#include <array>
#include <bit>
#include <cstdint>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// log(2) as the sum of two numbers. The high part ends in zero bits, so that small integer multiples of it
// are exact.
constexpr double log_2_high = 0x1.62e42feep-1, log_2_low = 0x1.a39ef35793c76p-33;

constexpr int parts = 64;  // number of parts into which an octave, a factor of 2, is divided

// Returns 2^(k / parts) for each k, computed by the Taylor series.
constexpr std::array<double, parts> make_roots_of_two() {
  std::array<double, parts> values{};
  for (int k = 0; k < parts; ++k) {
    const long double x = 0.693147180559945309417232121458L * k / parts;
    long double sum = 1.0L;
    for (int term = 30; term >= 1; --term) sum = 1.0L + sum * x / term;
    values[k] = static_cast<double>(sum);
  }
  return values;
}
constexpr std::array<double, parts> roots_of_two = make_roots_of_two();

// Adding and then subtracting this number rounds a number below 2^51 to an integer.
constexpr double to_whole = 0x1.8p52;

// Returns the inverses of the odd numbers from 3 on.
constexpr std::array<double, 10> make_inverse_odds() {
  std::array<double, 10> values{};
  for (int k = 0; k < 10; ++k) values[k] = 1.0 / (2 * k + 3);
  return values;
}
constexpr std::array<double, 10> inverse_odds = make_inverse_odds();

double power_of_two(int power) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(power + 1023) << 52);
}

}  // namespace

// Splits x into k log(2) / parts, where k is the nearest integer, and a rest. Evaluates the Taylor series at
// the rest, at which the term of order six is below rounding.
double stable_exp(double x) {
  if (!(x > -700.0)) return 0.0;
  const double whole = (x * (parts * 1.4426950408889634) + to_whole) - to_whole;
  const double rest = (x - whole * (log_2_high / parts)) - whole * (log_2_low / parts);
  const double square = rest * rest;
  const double beyond =
      rest + square * (0.5 + rest * (1.0 / 6.0) + square * (1.0 / 24.0 + rest * (1.0 / 120.0)));
  const int number = static_cast<int>(whole), part = number & (parts - 1);
  const double root = roots_of_two[part];
  // 2^power is split into two factors, because it may be out of range even if the result is not.
  const int power = (number - part) / parts, half = power / 2;
  return (root + root * beyond) * power_of_two(half) * power_of_two(power - half);
}

// Splits x into m 2^k, with m within a factor of sqrt(2) of 1, and uses log(m) = 2 artanh((m - 1) / (m + 1)).
double stable_log(double x) {
  SPOONBILL_ASSERT_DEBUG(x > 0.0);
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x), mantissa_bits = (std::uint64_t{1} << 52) - 1;
  int twos = static_cast<int>(bits >> 52) - 1023;
  double mantissa = std::bit_cast<double>((bits & mantissa_bits) | std::bit_cast<std::uint64_t>(1.0));
  if (mantissa > 1.4142135623730951) {
    mantissa *= 0.5;
    ++twos;
  }
  const double s = (mantissa - 1.0) / (mantissa + 1.0), square = s * s;
  double sum = 0.0;
  for (int k = 9; k >= 0; --k) sum = (sum + inverse_odds[k]) * square;
  return twos * log_2_high + (2.0 * s * (1.0 + sum) + twos * log_2_low);
}

}  // namespace spoonbill
