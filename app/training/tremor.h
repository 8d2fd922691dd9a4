// Tremor of a hand: noise within a band of frequencies, the same for the same seed on every machine.
#pragma once

#include <array>
#include <cstdint>

#include "engine/base/field.h"
#include "engine/base/geometry.h"

namespace spoonbill {

// Plain data. Amplitudes are root mean squares over a long time, along and about each axis.
struct TremorModel {
  Range<double> band_hz{4.0, 12.0};
  double amplitude_m = 0.0;
  double turn_rad = 0.0;
};

inline constexpr Range<double> tremor_frequency_range_hz{0.5, 20.0};
inline constexpr Range<double> tremor_amplitude_range_m{0.0, 0.03};
inline constexpr Range<double> tremor_turn_range_deg{0.0, 10.0};

// Displacement and turn (a rotation vector) of a trembling hand.
struct Sway {
  Vector3 shift_m = Vector3::Zero(), turn_rad = Vector3::Zero();
};

// A sum of sines with frequencies spread evenly over the band and random phases. Its spectrum is flat within
// the band and zero outside. It repeats after as many seconds as the band has lines in a hertz. One owner;
// step() allocates nothing.
class Tremor {
 public:
  Tremor(const TremorModel& model, std::uint32_t seed);
  static constexpr int line_count = 25;

  // Moves on by a tick.
  Sway step();

 private:
  // A point on the unit circle that turns by a fixed angle in each tick.
  struct Line {
    double x = 1.0, y = 0.0;
  };
  static constexpr std::size_t channel_count = 6;  // along and about each axis

  double line_amplitude_m_ = 0.0, line_turn_rad_ = 0.0;
  std::array<Line, line_count> steps_;  // turn of each line in a tick
  std::array<std::array<Line, line_count>, channel_count> lines_;
};

}  // namespace spoonbill
