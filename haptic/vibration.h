// Detection of vibration in a requested force, by comparing the force with itself one period earlier.
//
// For each period of L ticks, from 2 to 66, the force is compared with itself L ticks before. The comparison
// covers at least three periods and at least 75 ticks. With the deviation a(t) of the force f(t) from its
// mean over the period that contains t, the mismatch is
//
//   d(L) = mean |f(t) - f(t - L)|^2 / (2 mean |a(t)|^2)
//
// It is 0 for a force of period L in any direction and with any constant offset, about 1 for noise, at least
// 6 for a ramp, and about 1 - cos(2 pi L / P) for a sine whose period P is slightly longer than L. This is
// the difference function of pitch detection (de Cheveigne and Kawahara 2002, JASA 111:1917), relative to the
// variation within a period. The force repeats if d(L) is below 0.15 and below the mismatch of a 15 Hz sine,
// so that slower motion does not count.
//
// A force that repeats is a vibration if it is also
//   - strong: the root mean square of a(t) exceeds the quiet force;
//   - lasting: the newest and the oldest third of the periods each have at least 0.7 of the mean |a(t)|^2,
//     unlike the first ticks of a pulse and the bounces after a tap, which die down;
//   - not caused by a hand that moves across a pattern, such as ridges, or trembles over one ridge: the
//     root mean square of the hand's displacement over one period is below 2.5 mm. The force of a contact
//     only pushes, so the root mean square of its a(t) is at most half of the maximum force. If it exceeds
//     0.6 of the maximum force, the force reverses, and this condition does not apply.
//
// A pulse does not repeat. A steady vibration of at least 22 Hz is recognised within 150 ms of its first
// tick, and one of at least 50 Hz within 100 ms. Between 16 and 22 Hz, recognition takes three periods.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/base/geometry.h"

namespace spoonbill {

// The last requested forces and the positions of the hand at the same times; initially empty. Plain data.
struct VibrationState {
  static constexpr std::size_t capacity = 256;  // a power of two, at least three periods of 66 ticks
  struct Sample {
    Vector3 force_n = Vector3::Zero();
    Vector3 position_m = Vector3::Zero();
  };
  std::array<Sample, capacity> samples;
  std::uint64_t count = 0;  // number of samples added; the newest is at (count - 1) % capacity
};

struct VibrationLimits {
  double quiet_force_n = 0.2;    // a weaker vibration is ignored
  double maximum_force_n = 3.3;  // largest force of the device
};

// Adds the force that the coupling requests in this tick, before any limit, and the position of the hand.
// Returns true if the force vibrates. Force and position must be finite. `dropped_ticks` is the number of
// ticks without a force before this one. The last force counts once for each of them, at most `capacity`
// times.
//
// Tries an eighth of the periods in each tick, so that a tick costs a few microseconds. A vibration is
// therefore recognised at most 7 ticks late. Does not allocate, lock, read a clock or throw.
bool detect_vibration(VibrationState& state, const VibrationLimits& limits, const Vector3& force_n,
                      const Vector3& position_m, std::uint64_t dropped_ticks);

}  // namespace spoonbill
