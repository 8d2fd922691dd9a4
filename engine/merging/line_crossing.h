// Where lines cross a surface: a surface's own lines of constant u, and straight ones. Outside the tick.
#pragma once

#include <optional>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/box_tree.h"

namespace spoonbill {

struct LineCrossing {
  double along = 0.0;  // v of the crossing line, or the distance along a straight one
  double other_u = 0.0, other_v = 0.0;
  Vector3 point_m = Vector3::Zero();
};

// Holds a triangle net of the surface that is crossed, fine enough that a line which crosses it at more than
// a few degrees is not missed; crossings are then found to rounding on the surface itself. Immutable; any
// thread.
class CrossingFinder {
 public:
  explicit CrossingFinder(const Surface& other);

  // In the order of v. A line that only touches may be missed.
  std::vector<LineCrossing> of_line(const Surface& surface, double u) const;

  // In the order of distance, up to `length_m` along the unit direction.
  std::vector<LineCrossing> of_ray(const Vector3& from_m, const Vector3& direction, double length_m) const;

 private:
  struct Start {
    double share, other_u, other_v;
  };
  std::vector<Start> of_chord(const Vector3& from, const Vector3& to) const;
  template <class Curve>
  std::optional<LineCrossing> polished(const Curve& curve, double along, const Start& start) const;

  Surface other_;
  std::vector<double> u_, v_;
  std::vector<Vector3> points_m_;
  std::optional<BoxTree> tree_;
};

}  // namespace spoonbill
