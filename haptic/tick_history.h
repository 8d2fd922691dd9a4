// History of the recent ticks of a loop that may miss ticks.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

namespace spoonbill {

// Ticks of the last 100 ms, and of the 10 ms before them, with one bit per millisecond. Plain data; starts as
// if no tick had been missed.
class TickHistory {
 public:
  static constexpr std::size_t window_ms = 100;
  // Longest hold (time between two ticks) that is measured. A hold of this length or longer is a stall.
  static constexpr std::size_t longest_hold_ms = 10;

  TickHistory() { ticked_.set(); }

  // Adds a tick that followed `missed` missed ticks.
  void add(std::uint64_t missed) {
    const auto elapsed = static_cast<std::size_t>(std::min<std::uint64_t>(missed, ticked_.size())) + 1;
    ticked_ <<= elapsed;
    ticked_.set(0);
  }

  // Returns the longest time, in milliseconds, between two successive ticks, the later of which is in the
  // last 100 ms. It is 1 if no tick was missed, and at most longest_hold_ms.
  std::size_t find_longest_hold() const {
    std::size_t longest = 1;
    std::size_t end = 0;  // age, in milliseconds, of the tick at the end of the hold
    for (std::size_t age = 1; age < ticked_.size() && end < window_ms; ++age) {
      if (!ticked_[age]) continue;
      longest = std::max(longest, age - end);
      end = age;
    }
    if (end < window_ms) longest = longest_hold_ms;  // the hold began before the history
    return std::min(longest, longest_hold_ms);
  }

  // Returns the number of ticks in the last 100 ms.
  std::size_t count() const { return (ticked_ & window_mask()).count(); }

  std::array<std::uint64_t, 2> words() const {
    const Bits low(~std::uint64_t{0});
    return {(ticked_ & low).to_ullong(), (ticked_ >> 64).to_ullong()};
  }

  bool has_missed() const { return !ticked_.all(); }

  friend bool operator==(const TickHistory&, const TickHistory&) = default;

 private:
  using Bits = std::bitset<window_ms + longest_hold_ms>;
  static const Bits& window_mask() {
    static const Bits mask = ~Bits() >> longest_hold_ms;
    return mask;
  }

  Bits ticked_;  // bit n is set if a tick ran n milliseconds ago
};

}  // namespace spoonbill
