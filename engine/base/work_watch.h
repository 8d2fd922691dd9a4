// How long work outside the tick tells how far it is, and is asked whether to go on. A value; the function it
// holds is called on the thread that works.
#pragma once

#include <functional>
#include <utility>

#include "engine/base/result.h"

namespace spoonbill {

class WorkWatch {
 public:
  // Told the share that is done, 0 to 1; false stops the work, which is then an error.
  using Told = std::function<bool(double share)>;

  WorkWatch() = default;  // nobody watches
  explicit WorkWatch(Told told) : told_(std::move(told)) {}

  bool goes_on(double share) const { return !told_ || told_(start_ + (end_ - start_) * share); }

  // Of work that is done in parts: the one from one share to another, which is not below it.
  WorkWatch part(double from, double to) const {
    SPOONBILL_ASSERT(0.0 <= from && from <= to);
    WorkWatch watch = *this;
    watch.start_ = start_ + (end_ - start_) * from;
    watch.end_ = start_ + (end_ - start_) * to;
    return watch;
  }

  static Error stopped() { return Error{"stopped"}; }

 private:
  Told told_;
  double start_ = 0.0, end_ = 1.0;
};

// Of rounds whose number shows at the last: each takes its part of what is left.
class RoundsDone {
 public:
  // Above 0 and below 1.
  explicit RoundsDone(double part_of_rest) : part_of_rest_(part_of_rest) {
    SPOONBILL_ASSERT(0.0 < part_of_rest && part_of_rest < 1.0);
  }

  double share() const { return share_; }
  void step() { share_ += part_of_rest_ * (1.0 - share_); }

 private:
  double part_of_rest_, share_ = 0.0;
};

}  // namespace spoonbill
