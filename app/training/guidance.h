// Guidance of a person's hand: a gentle force toward the path of a task.
#pragma once

#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Strength of the guidance: 0 switches it off, 1 gives the full force.
inline constexpr Range<double> guidance_range{0.0, 1.0};

// A force toward the nearest point of a line, that grows with the distance up to a limit:
//   F = s k min(d, d0),   with the strength s and the distance d.
// It is the gradient of the potential s k d^2 / 2 up to d0 and s k d0 (d - d0 / 2) beyond. The distance to a
// line changes continuously with the position, even where the nearest point jumps, and so does the potential:
// the force never gives a hand more energy than the hand has put in, whatever its path.
//
// Plain state; force_n() is const, allocates nothing and gives the same bits on every machine.
class Guidance {
 public:
  // Does not guide.
  Guidance() = default;
  // `path_m` has the corners of the line; a single point guides to that point.
  Guidance(std::vector<Vector3> path_m, double strength);

  // Returns the force on a hand at this position.
  Vector3 force_n(const Vector3& position_m) const;
  double strength() const { return strength_; }

  static constexpr double stiffness_n_per_m = 60.0;
  static constexpr double largest_force_n = 0.6;

 private:
  std::vector<Vector3> path_m_;
  double strength_ = 0.0;
};

// Returns the point of the line nearest to a position. The line has at least one corner.
Vector3 find_nearest_on_path(const std::vector<Vector3>& path_m, const Vector3& position_m);

}  // namespace spoonbill
