#include "engine/collision/implicit/exponential.h"

#include <cmath>

namespace spoonbill {
namespace {

// The first with zeros at its end, so that a multiple of it is exact; both together are log(2).
constexpr double log_2_high = 0x1.62e42feep-1, log_2_low = 0x1.a39ef35793c76p-33;

}  // namespace

// The Taylor series within half of log(2), whose fourteenth term is below rounding.
double stable_exp(double x) {
  if (!(x > -700.0)) return 0.0;
  const double twos = std::floor(x * 1.4426950408889634 + 0.5);
  const double rest = (x - twos * log_2_high) - twos * log_2_low;
  double sum = 1.0;
  for (int k = 13; k > 1; --k) sum = 1.0 + sum * rest / k;
  return std::ldexp(1.0 + rest * sum, static_cast<int>(twos));
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
  for (int k = 21; k > 1; k -= 2) sum = (sum + 1.0 / k) * square;
  return twos * log_2_high + (2.0 * s * (1.0 + sum) + twos * log_2_low);
}

}  // namespace spoonbill
