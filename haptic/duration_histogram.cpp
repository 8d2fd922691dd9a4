#include "haptic/duration_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spoonbill {

namespace {

constexpr double nanosecond_s = 1e-9;

// There is one thread that adds, so that nothing is lost between load and store.
void increase(std::atomic<std::uint64_t>& number, std::uint64_t by) noexcept {
  number.store(number.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

}  // namespace

std::size_t DurationHistogram::bin_of(std::uint64_t duration_ns) noexcept {
  if (duration_ns < bins_an_octave) return duration_ns;
  const auto shift = static_cast<std::size_t>(std::bit_width(duration_ns / bins_an_octave) - 1);
  return shift * bins_an_octave + (duration_ns >> shift);
}

double DurationHistogram::middle_of_ns(std::size_t bin) noexcept {
  if (bin < 2 * bins_an_octave) return static_cast<double>(bin);
  const std::size_t shift = bin / bins_an_octave - 1;
  const std::uint64_t low = (bin - shift * bins_an_octave) << shift;
  return static_cast<double>(low) + 0.5 * static_cast<double>((std::uint64_t{1} << shift) - 1);
}

void DurationHistogram::add(std::int64_t duration_ns) noexcept {
  const auto duration = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  increase(bins_[bin_of(duration)], 1);
  increase(count_, 1);
  increase(sum_ns_, duration);
}

double DurationHistogram::quantile_s(double share) const noexcept {
  std::uint64_t total = 0;
  for (const auto& bin : bins_) total += bin.load(std::memory_order_relaxed);
  if (total == 0) return 0.0;
  const double wanted = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(total));
  std::uint64_t seen = 0;
  std::size_t highest = 0;
  for (std::size_t bin = 0; bin < bin_count; ++bin) {
    const std::uint64_t here = bins_[bin].load(std::memory_order_relaxed);
    if (here == 0) continue;
    highest = bin;
    seen += here;
    if (static_cast<double>(seen) >= wanted) break;
  }
  return middle_of_ns(highest) * nanosecond_s;
}

double DurationHistogram::mean_s() const noexcept {
  const std::uint64_t total = count();
  if (total == 0) return 0.0;
  return static_cast<double>(sum_ns_.load(std::memory_order_relaxed)) / static_cast<double>(total) *
         nanosecond_s;
}

}  // namespace spoonbill
