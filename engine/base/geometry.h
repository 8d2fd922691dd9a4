// Elementary geometric values: ranges of numbers, vectors, poses and axis-aligned boxes, and checks of values
// that come from outside the program.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/base/result.h"

namespace spoonbill {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// A closed range. Ranges are declared beside the structs whose fields they bound, so that files, commands and
// sliders all use the same one.
template <class Number>
struct Range {
  Number low;
  Number high;

  // Returns false for NaN.
  constexpr bool contains(Number value) const { return value >= low && value <= high; }
};

// Returns an out_of_range error such as "field is 12, must be from 1 to 9" unless the range contains the
// value. NaN is outside every range.
Status check_range(std::string_view field, double value, Range<double> range);
Status check_range(std::string_view field, int value, Range<int> range);

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

// Position and orientation of a rigid object in the world frame: x right, y up, z toward the viewer,
// right-handed.
struct Pose {
  Vector3 position_m = Vector3::Zero();
  Quaternion orientation = Quaternion::Identity();
  friend bool operator==(const Pose&, const Pose&) = default;
};

// Returns the pose to which `by` moves a rigid object at `pose`.
inline Pose composed(const Pose& by, const Pose& pose) {
  return {by.position_m + by.orientation * pose.position_m, by.orientation * pose.orientation};
}

// Range of every coordinate in files, in commands and in the panel.
inline constexpr Range<double> position_range_m{-100.0, 100.0};

// Returns an error if a coordinate is outside position_range_m. The error names the first such coordinate.
Status check_position(const std::string& field, const Vector3& position_m);
// Returns an error unless the vector has length 1 within 1e-6, which allows for normals written as decimals.
Status check_unit(const std::string& field, const Vector3& vector);

// An axis-aligned box from `low` to `high`, both included, in metres unless stated otherwise. A
// default-constructed box is empty; include() makes it grow.
template <class Vector>
struct AlignedBox {
  using Scalar = typename Vector::Scalar;

  // Coordinate larger than any in use, but small enough that extent() of an empty box is finite.
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
  // Returns the side lengths.
  Vector extent() const { return high - low; }
  // Returns the length of the diagonal.
  Scalar size() const { return (high - low).norm(); }

  // Returns corner 0 to 7 (0 to 3 in the plane): bit k of the number selects the high end of axis k.
  Vector corner(int number) const {
    Vector corner = low;
    for (int axis = 0; axis < corner.size(); ++axis) {
      if ((number >> axis & 1) != 0) corner[axis] = high[axis];
    }
    return corner;
  }

  // Returns the distance between the nearest points of the two boxes; 0 if they overlap.
  Scalar gap(const AlignedBox& other) const {
    const Vector apart = (low - other.high).cwiseMax(other.low - high).cwiseMax(Scalar(0));
    return apart.norm();
  }
  // Returns the squared distance to the nearest point of the box; 0 inside.
  Scalar squared_distance(const Vector& point) const {
    return (low - point).cwiseMax(point - high).cwiseMax(Scalar(0)).squaredNorm();
  }
  // Returns whether the gap between the boxes is at most `reach` along each axis.
  bool is_near(const AlignedBox& other, Scalar reach) const {
    bool near = true;
    for (int axis = 0; axis < low.size(); ++axis) {
      near = near & (low[axis] - reach <= other.high[axis]) & (other.low[axis] - reach <= high[axis]);
    }
    return near;
  }
  // Returns whether the boxes have a point in common.
  bool overlaps(const AlignedBox& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  // Returns whether the other box is entirely inside this one.
  bool holds(const AlignedBox& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

using Box = AlignedBox<Vector3>;
using Box2 = AlignedBox<Eigen::Vector2d>;
using FloatBox2 = AlignedBox<Eigen::Vector2f>;

// Returns the smallest box that contains both boxes.
inline Box joined(Box a, const Box& b) {
  a.join(b);
  return a;
}

// Returns the smallest box around all points of a range; an empty box for no points.
template <class Points>
auto box_about(const Points& points) {
  AlignedBox<std::decay_t<decltype(*std::begin(points))>> box;
  for (const auto& point : points) box.include(point);
  return box;
}

// Returns true if a point is inside a polygon, which may cross itself: by the even-odd rule.
bool is_inside(const Vector2& point, std::span<const Vector2> polygon);

}  // namespace spoonbill
