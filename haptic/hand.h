// An imitated hand: its mass, how stiffly it holds a handle, and where it wants the handle. Plain data.
#pragma once

#include <cstdint>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// A relaxed hand on a stylus. The damping is critical for mass and stiffness, so that the handle neither
// rings nor lags.
struct Hand {
  double mass_kg = 0.1;  // of the handle and what of the hand moves with it
  double stiffness_n_per_m = 300.0;
  double damping_n_s_per_m = 10.954;  // against the target's motion
};

// Within these a step is stable: tick^2 * stiffness / mass stays at most 1.
inline constexpr Range<double> hand_mass_range_kg{0.01, 10.0};
inline constexpr Range<double> hand_stiffness_range_n_per_m{1.0, 10'000.0};
inline constexpr Range<double> hand_damping_range_n_s_per_m{0.0, 1000.0};

// Names the first field that is outside its range.
Status check_hand(const Hand& hand);

// Where the hand wants the handle, and what its fingers press.
struct HandTarget {
  Pose pose;
  std::uint32_t buttons = 0;
};

bool is_finite(const HandTarget& target);

}  // namespace spoonbill
