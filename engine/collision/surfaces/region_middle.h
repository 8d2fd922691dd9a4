// The middle of a region of contact, in the parameters of both surfaces.
#pragma once

#include <cmath>

#include "engine/base/assert.h"
#include "engine/bspline/surface.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// The mean of parameters, those of a periodic direction taken the short way from the first.
class ParameterMean {
 public:
  explicit ParameterMean(const KnotVector& knots) : knots_(&knots) {}
  void add(double parameter) {
    if (count_ == 0) first_ = parameter;
    const double length = knots_->domain_end() - knots_->domain_start();
    double apart = parameter - first_;
    if (knots_->is_periodic()) apart -= length * std::round(apart / length);
    sum_ += apart;
    ++count_;
  }
  // Of one parameter at least.
  double mean() const {
    SPOONBILL_ASSERT(count_ > 0);
    return knots_->into_domain(first_ + sum_ / count_);
  }
  // A share of the way from the mean to another parameter.
  double towards(double parameter, double share) const {
    const double from = first_ + sum_ / count_, length = knots_->domain_end() - knots_->domain_start();
    double apart = parameter - from;
    if (knots_->is_periodic()) apart -= length * std::round(apart / length);
    return knots_->into_domain(from + share * apart);
  }

 private:
  const KnotVector* knots_;
  double first_ = 0.0, sum_ = 0.0;
  int count_ = 0;
};

// The mean of the parameters of pairs.
class RegionMiddle {
 public:
  RegionMiddle(const Surface& first, const Surface& second)
      : u_(first.u), v_(first.v), s_(second.u), t_(second.v) {}
  void add(const PairParameters& at) {
    u_.add(at.u);
    v_.add(at.v);
    s_.add(at.s);
    t_.add(at.t);
  }
  PairParameters mean() const { return {u_.mean(), v_.mean(), s_.mean(), t_.mean()}; }
  PairParameters towards(const PairParameters& at, double share) const {
    return {u_.towards(at.u, share), v_.towards(at.v, share), s_.towards(at.s, share),
            t_.towards(at.t, share)};
  }

 private:
  ParameterMean u_, v_, s_, t_;
};

}  // namespace spoonbill
