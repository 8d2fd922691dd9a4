// The step that makes the largest of a few planes over the plane, plus one quadratic for all, least.
#pragma once

#include <Eigen/Core>
#include <array>

namespace spoonbill {

inline constexpr int most_faces = 6;

struct FacePlane {
  double value;  // at the origin
  Eigen::Vector2d slope;
};

struct SmallestLargest {
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  double value = 0.0;                        // of the model there
  std::array<double, most_faces> weights{};  // of the planes that hold it, with sum 1
};

// min over s of max_i (value_i + slope_i . s) + s . quadratic s / 2, by trying which one, two or three planes
// hold the step. The quadratic must be positive definite, `count` 1 to most_faces.
SmallestLargest smallest_largest(const std::array<FacePlane, most_faces>& planes, int count,
                                 const Eigen::Matrix2d& quadratic);

}  // namespace spoonbill
