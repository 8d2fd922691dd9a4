// Boxes along the axes.
#pragma once

#include <iterator>
#include <type_traits>

#include "engine/base/pose.h"

namespace spoonbill {

// From `low` to `high`, both included; in metres unless said otherwise. Starts empty, and grows with what it
// includes.
template <class Vector>
struct AlignedBox {
  using Scalar = typename Vector::Scalar;

  // Beyond every coordinate, and small enough that the size of an empty box is finite.
  static constexpr Scalar far = Scalar(1e30);

  Vector low = Vector::Constant(far);
  Vector high = Vector::Constant(-far);

  bool is_empty() const { return (low.array() > high.array()).any(); }

  void include(const Vector& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void join(const AlignedBox& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }

  Vector centre() const { return Scalar(0.5) * (low + high); }
  // The lengths of the sides.
  Vector extent() const { return high - low; }
  // The length of the diagonal.
  Scalar size() const { return (high - low).norm(); }

  // Corner 0 to 7 (of a plane 0 to 3): bit k of the number is set where axis k is at its high end.
  Vector corner(int number) const {
    Vector corner = low;
    for (int axis = 0; axis < corner.size(); ++axis) {
      if ((number >> axis & 1) != 0) corner[axis] = high[axis];
    }
    return corner;
  }

  // Between the nearest points; 0 where they overlap.
  Scalar gap(const AlignedBox& other) const {
    const Vector apart = (low - other.high).cwiseMax(other.low - high).cwiseMax(Scalar(0));
    return apart.norm();
  }
  // To the nearest point of the box, squared; 0 within.
  Scalar squared_distance(const Vector& point) const {
    return (low - point).cwiseMax(point - high).cwiseMax(Scalar(0)).squaredNorm();
  }
  // Whether no axis keeps them farther apart than `reach`.
  bool is_near(const AlignedBox& other, Scalar reach) const {
    bool near = true;
    for (int axis = 0; axis < low.size(); ++axis) {
      near = near & (low[axis] - reach <= other.high[axis]) & (other.low[axis] - reach <= high[axis]);
    }
    return near;
  }
  // Whether they have a point in common.
  bool overlaps(const AlignedBox& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  bool holds(const AlignedBox& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

using Box = AlignedBox<Vector3>;
using Box2 = AlignedBox<Eigen::Vector2d>;
using FloatBox2 = AlignedBox<Eigen::Vector2f>;

inline Box joined(Box a, const Box& b) {
  a.join(b);
  return a;
}

// Returns the box about all points of a range; empty of none.
template <class Points>
auto box_about(const Points& points) {
  AlignedBox<std::decay_t<decltype(*std::begin(points))>> box;
  for (const auto& point : points) box.include(point);
  return box;
}

}  // namespace spoonbill
