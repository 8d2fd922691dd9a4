// Boxes along the axes, in metres.
#pragma once

#include "engine/base/pose.h"

namespace spoonbill {

struct Box {
  Vector3 low, high;

  // Between the nearest points; 0 where they overlap.
  double gap(const Box& other) const {
    const Vector3 apart = (low - other.high).cwiseMax(other.low - high).cwiseMax(0.0);
    return apart.norm();
  }
  // Whether no axis keeps them farther apart than `reach_m`.
  bool is_near(const Box& other, double reach_m) const {
    bool near = true;
    for (int axis = 0; axis < 3; ++axis) {
      near = near & (low[axis] - reach_m <= other.high[axis]) & (other.low[axis] - reach_m <= high[axis]);
    }
    return near;
  }
  bool holds(const Box& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
  double size() const { return (high - low).norm(); }
};

inline Box joined(const Box& a, const Box& b) {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

}  // namespace spoonbill
