// Progress reports and cancellation for long computations, which never run within a simulation tick.
#pragma once

#include <functional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/result.h"

namespace spoonbill {

// Reports the progress of a computation, or of a part of it, to a callback. Copyable. The callback runs on
// the thread that reports; without a callback, a report costs one comparison.
//
//   for (int k = 0; k < count; ++k) {
//     if (!progress.report(static_cast<double>(k) / count)) return Progress::stopped();
//     prepare(k, progress.part(k / double(count), (k + 0.5) / count));
//   }
class Progress {
 public:
  // Function that receives the fraction done, from 0 to 1, possibly the same fraction repeatedly. It returns
  // whether the work may continue.
  using Report = std::function<bool(double fraction)>;

  Progress() = default;  // constructs a reporter without a callback
  explicit Progress(Report report) : report_(std::move(report)) {}

  // Reports the fraction of this part that is done, and returns true if the work may continue. Otherwise the
  // caller must end early and, if it has no result yet, return stopped().
  bool report(double fraction) const { return !report_ || report_(start_ + (end_ - start_) * fraction); }

  // Returns a reporter for a part of the work. It reports its fractions 0 and 1 as the fractions `from` and
  // `to` of this reporter. Successive parts must not overlap.
  Progress part(double from, double to) const {
    SPOONBILL_ASSERT(0.0 <= from && from <= to);
    Progress part = *this;
    part.start_ = start_ + (end_ - start_) * from;
    part.end_ = start_ + (end_ - start_) * to;
    return part;
  }

  // Returns whether a callback receives the reports.
  bool is_watched() const { return static_cast<bool>(report_); }

  static Error stopped() { return Error{ErrorCode::cancelled, "stopped"}; }

 private:
  Report report_;
  double start_ = 0.0, end_ = 1.0;
};

// Estimates how much of a loop is done if its number of rounds is unknown. Each round counts as a fixed
// fraction of the work that remained before the round.
class RoundsDone {
 public:
  // `part_of_rest` is the fraction of the remainder that each round completes, strictly between 0 and 1.
  explicit RoundsDone(double part_of_rest) : part_of_rest_(part_of_rest) {
    SPOONBILL_ASSERT(0.0 < part_of_rest && part_of_rest < 1.0);
  }

  double fraction() const { return fraction_; }
  void step() { fraction_ += part_of_rest_ * (1.0 - fraction_); }

 private:
  double part_of_rest_, fraction_ = 0.0;
};

}  // namespace spoonbill
