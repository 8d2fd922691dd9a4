// Counts durations in bins of fixed number, so that one thread can add while others ask, without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace spoonbill {

// Exactly one thread adds; any may ask, and gets what was added up to about now.
class DurationHistogram {
 public:
  // Less than nothing counts as nothing.
  void add(std::int64_t duration_ns) noexcept;

  // The duration that `share` (0 to 1) of those added do not exceed, within 1/16 of it; 0 when there is none.
  double quantile_s(double share) const noexcept;

  double mean_s() const noexcept;
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }

 private:
  // Sixteen bins between each power of two and the next; below sixteen a bin for each whole nanosecond.
  static constexpr std::size_t bins_an_octave = 16;
  static constexpr std::size_t bin_count = 61 * bins_an_octave;

  static std::size_t bin_of(std::uint64_t duration_ns) noexcept;
  static double middle_of_ns(std::size_t bin) noexcept;

  std::array<std::atomic<std::uint64_t>, bin_count> bins_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
};

}  // namespace spoonbill
