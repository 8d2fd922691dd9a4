#include "engine/collision/implicit/exponential.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace spoonbill {
namespace {

// The first with zeros at its end, so that a multiple of it is exact; both together are log(2).
constexpr double log_2_high = 0x1.62e42feep-1, log_2_low = 0x1.a39ef35793c76p-33;

constexpr std::array<double, 14> make_inverse_factorials() {
  std::array<double, 14> values{};
  double factorial = 1.0;
  for (int k = 0; k < 14; ++k) {
    values[k] = 1.0 / factorial;
    factorial *= k + 1;
  }
  return values;
}
constexpr std::array<double, 14> inverse_factorials = make_inverse_factorials();

// 1 / 3, 1 / 5 and so on.
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

// The Taylor series within half of log(2), whose fourteenth term is below rounding.
double stable_exp(double x) {
  if (!(x > -700.0)) return 0.0;
  const double twos = std::floor(x * 1.4426950408889634 + 0.5);
  const double rest = (x - twos * log_2_high) - twos * log_2_low;
  double sum = inverse_factorials[13];
  for (int k = 12; k >= 0; --k) sum = inverse_factorials[k] + rest * sum;
  // Neither factor is out of range where the product is not.
  const int power = static_cast<int>(twos), half = power / 2;
  return sum * power_of_two(half) * power_of_two(power - half);
}

// log(m) = 2 artanh((m - 1) / (m + 1)), m within sqrt(2) of 1.
double stable_log(double x) {
  int twos = 0;
  double mantissa = std::frexp(x, &twos);
  if (mantissa < 0.70710678118654752) {
    mantissa *= 2.0;
    --twos;
  }
  const double s = (mantissa - 1.0) / (mantissa + 1.0), square = s * s;
  double sum = 0.0;
  for (int k = 9; k >= 0; --k) sum = (sum + inverse_odds[k]) * square;
  return twos * log_2_high + (2.0 * s * (1.0 + sum) + twos * log_2_low);
}

}  // namespace spoonbill
