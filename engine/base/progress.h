// How work outside the tick reports how much of it is done, and learns that it is to stop.
#pragma once

#include <functional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/result.h"

namespace spoonbill {

// A value. The function that it holds is called on the thread that works; without one, a report costs a
// comparison.
//
//   for (int k = 0; k < count; ++k) {
//     if (!progress.report(static_cast<double>(k) / count)) return Progress::stopped();
//     prepare(k, progress.part(k / count, (k + 0.5) / count));
//   }
class Progress {
 public:
  // Is told the fraction that is done, 0 to 1, perhaps the same one repeatedly. Returns whether the work goes
  // on.
  using Report = std::function<bool(double fraction)>;

  Progress() = default;  // nobody watches
  explicit Progress(Report report) : report_(std::move(report)) {}

  // Whether the work goes on; otherwise it ends early, with stopped() for an error where it has no result.
  bool report(double fraction) const { return !report_ || report_(start_ + (end_ - start_) * fraction); }

  // The progress of a part of the work: 0 and 1 of it are the fractions `from` and `to` of this one, which
  // must not run backwards.
  Progress part(double from, double to) const {
    SPOONBILL_ASSERT(0.0 <= from && from <= to);
    Progress part = *this;
    part.start_ = start_ + (end_ - start_) * from;
    part.end_ = start_ + (end_ - start_) * to;
    return part;
  }

  bool is_watched() const { return static_cast<bool>(report_); }

  static Error stopped() { return Error{"stopped"}; }

 private:
  Report report_;
  double start_ = 0.0, end_ = 1.0;
};

// The fraction done of rounds whose number shows only at the last: each takes its part of what is left.
class RoundsDone {
 public:
  // `part_of_rest` must be between 0 and 1.
  explicit RoundsDone(double part_of_rest) : part_of_rest_(part_of_rest) {
    SPOONBILL_ASSERT(0.0 < part_of_rest && part_of_rest < 1.0);
  }

  double fraction() const { return fraction_; }
  void step() { fraction_ += part_of_rest_ * (1.0 - fraction_); }

 private:
  double part_of_rest_, fraction_ = 0.0;
};

}  // namespace spoonbill
