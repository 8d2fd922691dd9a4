#include "app/training/tremor.h"

#include <cmath>
#include <numbers>
#include <random>

#include "app/training/exact_angles.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {
namespace {

// Returns a number from -1 to 1. The distributions of the standard library differ between implementations.
double signed_fraction(std::mt19937& random) {
  return 2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0;
}

}  // namespace

Tremor::Tremor(const TremorModel& model, std::uint32_t seed) {
  // A sine has a mean square of half its amplitude squared.
  const double share = std::sqrt(2.0 / line_count);
  line_amplitude_m_ = share * model.amplitude_m;
  line_turn_rad_ = share * model.turn_rad;
  const double width_hz = model.band_hz.high - model.band_hz.low;
  for (int k = 0; k < line_count; ++k) {
    const double frequency_hz = model.band_hz.low + width_hz * (k + 0.5) / line_count;
    const SineCosine turn = sine_cosine(2.0 * std::numbers::pi * frequency_hz * tick_s);
    steps_[static_cast<std::size_t>(k)] = {turn.cosine, turn.sine};
  }
  std::mt19937 random(seed);
  for (auto& channel : lines_) {
    for (Line& line : channel) {
      double square = 0.0;
      do {
        line = {signed_fraction(random), signed_fraction(random)};
        square = line.x * line.x + line.y * line.y;
      } while (square > 1.0 || square < 0.01);
      const double length = std::sqrt(square);
      line = {line.x / length, line.y / length};
    }
  }
}

Sway Tremor::step() {
  std::array<double, channel_count> sums{};
  for (std::size_t c = 0; c < channel_count; ++c) {
    for (std::size_t k = 0; k < line_count; ++k) {
      Line& line = lines_[c][k];
      const Line& by = steps_[k];
      line = {line.x * by.x - line.y * by.y, line.x * by.y + line.y * by.x};
      sums[c] += line.y;
    }
  }
  Sway sway;
  for (int axis = 0; axis < 3; ++axis) {
    sway.shift_m[axis] = line_amplitude_m_ * sums[static_cast<std::size_t>(axis)];
    sway.turn_rad[axis] = line_turn_rad_ * sums[static_cast<std::size_t>(axis) + 3];
  }
  return sway;
}

}  // namespace spoonbill
