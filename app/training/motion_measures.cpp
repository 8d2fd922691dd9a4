#include "app/training/motion_measures.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace spoonbill {
namespace {

// Subtracts from each position the mean over the quarter second around. Leaves out the first and the last
// ones.
std::vector<Vector3> subtract_means(const std::vector<Vector3>& positions_m, double rate_hz) {
  const auto half = static_cast<std::size_t>(0.125 * rate_hz);
  std::vector<Vector3> left_m;
  Vector3 sum = Vector3::Zero();
  for (std::size_t k = 0; k < positions_m.size(); ++k) {
    sum += positions_m[k];
    if (k < 2 * half) continue;
    left_m.push_back(positions_m[k - half] - sum / static_cast<double>(2 * half + 1));
    sum -= positions_m[k - 2 * half];
  }
  return left_m;
}

}  // namespace

double find_path_length_m(const std::vector<Vector3>& positions_m) {
  double length_m = 0.0;
  for (std::size_t k = 1; k < positions_m.size(); ++k) {
    length_m += (positions_m[k] - positions_m[k - 1]).norm();
  }
  return length_m;
}

double find_spectral_arc_length(const std::vector<double>& speeds_m_per_s, double rate_hz) {
  constexpr double highest_hz = 10.0, step_hz = 0.02, least_amplitude = 0.05;
  std::vector<double> amplitudes;
  for (int k = 0; k * step_hz <= highest_hz; ++k) {
    const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi * k * step_hz / rate_hz);
    std::complex<double> sum = 0.0, at = 1.0;
    for (const double speed : speeds_m_per_s) {
      sum += speed * at;
      at *= turn;
    }
    amplitudes.push_back(std::abs(sum));
  }
  const double mean = amplitudes.front();
  if (!(mean > 0.0)) return 0.0;
  std::size_t last = amplitudes.size() - 1;
  while (last > 1 && amplitudes[last] < least_amplitude * mean) --last;
  double length = 0.0;
  for (std::size_t k = 1; k <= last; ++k) {
    length += std::hypot(1.0 / static_cast<double>(last), (amplitudes[k] - amplitudes[k - 1]) / mean);
  }
  return -length;
}

double find_tremor_m(const std::vector<Vector3>& positions_m, double rate_hz) {
  const std::vector<Vector3> left_m = subtract_means(subtract_means(positions_m, rate_hz), rate_hz);
  if (left_m.empty()) return 0.0;
  double squares = 0.0;
  for (const Vector3& one_m : left_m) squares += one_m.squaredNorm();
  return std::sqrt(squares / static_cast<double>(left_m.size()));
}

}  // namespace spoonbill
