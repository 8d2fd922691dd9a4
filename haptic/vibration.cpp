#include "haptic/vibration.h"

#include <algorithm>
#include <numbers>

#include "engine/simulation/simulation.h"
#include "haptic/device.h"

namespace spoonbill {
namespace {

constexpr int shortest_period = 2, longest_period = 66;  // in ticks
constexpr int fewest_periods = 3, fewest_ticks = 75;
constexpr int turns = 8;  // number of ticks in which every period is tried once

constexpr double largest_mismatch = 0.15;
constexpr double slowest_hz = 15.0;
constexpr double lasting_fraction = 0.7;
constexpr double pattern_m = 2.5e-3;
constexpr double reversing_fraction = 0.6;

// Forces are clamped to this norm, so that no sum overflows. No device is stronger.
constexpr double largest_force_n = device_force_range_n.high;

constexpr int count_periods(int period) {
  return std::max(fewest_periods, (fewest_ticks + period - 1) / period);
}
static_assert(fewest_periods * longest_period <= static_cast<int>(VibrationState::capacity));

const VibrationState::Sample& at(const VibrationState& state, int ticks_ago) {
  return state.samples[(state.count - 1 - static_cast<std::uint64_t>(ticks_ago)) % VibrationState::capacity];
}

// Returns the mismatch below which the force counts as repeating with this period. A sine of `slowest_hz`
// with the phase error x has the mismatch 1 - cos(x), about x^2 / 2. The result is at most this mismatch.
double mismatch_limit(int period) {
  const double phase_error = 2.0 * std::numbers::pi * (1.0 - period * tick_s * slowest_hz);
  return std::min(largest_mismatch, 0.5 * phase_error * phase_error);
}

// Energies of the force in the last periods, in their newest third and in their oldest third, as sums of
// |a(t)|^2 (see vibration.h).
struct Energies {
  double all = 0.0, newest = 0.0, oldest = 0.0;
};

Energies find_energies(const VibrationState& state, int period, int periods) {
  Energies energies;
  const int third = periods / 3;
  for (int p = 0; p < periods; ++p) {
    Vector3 sum = Vector3::Zero();
    double squares = 0.0;
    for (int k = p * period; k < (p + 1) * period; ++k) {
      const Vector3& force_n = at(state, k).force_n;
      sum += force_n;
      squares += force_n.squaredNorm();
    }
    const double of_period = std::max(0.0, squares - sum.squaredNorm() / period);
    energies.all += of_period;
    if (p < third) energies.newest += of_period;
    if (p >= periods - third) energies.oldest += of_period;
  }
  return energies;
}

bool vibrates(const VibrationState& state, const VibrationLimits& limits, int period) {
  const int periods = count_periods(period);
  const int ticks = periods * period, pairs = ticks - period;
  if (state.count < static_cast<std::uint64_t>(ticks)) return false;
  const Energies energies = find_energies(state, period, periods);
  const double mean_energy = energies.all / ticks;
  if (!(mean_energy > limits.quiet_force_n * limits.quiet_force_n)) return false;
  const double lasting_energy = lasting_fraction * mean_energy * (periods / 3) * period;
  if (!(std::min(energies.newest, energies.oldest) >= lasting_energy)) return false;
  // Sums of |f(t) - f(t - L)|^2, and of the squared displacement of the hand over L ticks (see vibration.h).
  double change = 0.0, moved_m2 = 0.0;
  for (int k = 0; k < pairs; ++k) {
    const VibrationState::Sample &sample = at(state, k), &before = at(state, k + period);
    change += (sample.force_n - before.force_n).squaredNorm();
    moved_m2 += (sample.position_m - before.position_m).squaredNorm();
  }
  if (!(change / pairs < mismatch_limit(period) * 2.0 * mean_energy)) return false;
  const double reversing_n = reversing_fraction * limits.maximum_force_n;
  return mean_energy > reversing_n * reversing_n || moved_m2 / pairs < pattern_m * pattern_m;
}

void add(VibrationState& state, const VibrationState::Sample& sample) {
  state.samples[state.count % VibrationState::capacity] = sample;
  ++state.count;
}

}  // namespace

bool detect_vibration(VibrationState& state, const VibrationLimits& limits, const Vector3& force_n,
                      const Vector3& position_m, std::uint64_t dropped_ticks) {
  if (state.count > 0) {
    const VibrationState::Sample last = at(state, 0);
    const std::uint64_t held = std::min<std::uint64_t>(dropped_ticks, VibrationState::capacity);
    for (std::uint64_t k = 0; k < held; ++k) add(state, last);
  }
  const double norm = force_n.stableNorm();
  const Vector3 clamped_n = norm > largest_force_n ? Vector3(force_n * (largest_force_n / norm)) : force_n;
  add(state, {clamped_n, position_m});
  const int turn = static_cast<int>(state.count % turns);
  for (int period = shortest_period + turn; period <= longest_period; period += turns) {
    if (vibrates(state, limits, period)) return true;
  }
  return false;
}

}  // namespace spoonbill
