// The rim of a body that bears food: a closed line, its plane, and what is outside and below it.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A rim in space. Plain data; used by one thread.
class Rim {
 public:
  // Makes the rim of a body from the corners of a line on its present surface (Body::rim). Two successive
  // corners at one point in space, such as two at a pole or both ends of a ring, are not connected through
  // the surface. The normal of the rim's plane is the direction in which the rim's projection has the largest
  // area (Newell 1972), on the side of `up`. Returns nothing if the line encloses no area.
  static std::optional<Rim> on_surface(const Surface& surface, const std::vector<Vector2>& corners,
                                       const Vector3& up);

  // Moves the rim to where the line is on the surface now. Returns false, and leaves the rim unusable, if the
  // line encloses no area. Allocates nothing if the line has as many corners as before.
  bool follow(const Surface& surface, const std::vector<Vector2>& corners, const Vector3& up);

  const Vector3& normal() const { return normal_; }
  const Vector3& centre_m() const { return centre_m_; }
  // Returns the height of a point above the plane of the rim, which goes through its centre, m.
  double height_m(const Vector3& point_m) const { return normal_.dot(point_m - centre_m_); }
  // Returns the offset of a point from the rim's centre in the rim's plane: towards the first corner of the
  // rim, and to the left of that seen against the normal.
  Vector2 from_centre_m(const Vector3& point_m) const { return projected(point_m); }
  // Returns true if a point, projected along the normal, is outside the rim.
  bool is_outside(const Vector3& point_m) const;
  // Returns true for a point that is near enough to the centre to be inside the rim, wherever it is around.
  // If all corners of a convex body are, the whole body is inside.
  bool is_well_inside(const Vector3& point_m) const {
    return projected(point_m).squaredNorm() < inner_radius_m_ * inner_radius_m_;
  }
  // Returns the distance of a point from the rim, both projected along the normal, m; negative outside.
  double margin_m(const Vector3& point_m) const;

 private:
  Rim() = default;
  Vector2 projected(const Vector3& point_m) const {
    return {across_.dot(point_m - centre_m_), along_.dot(point_m - centre_m_)};
  }

  Vector3 centre_m_ = Vector3::Zero(), normal_ = Vector3::UnitY(), across_ = Vector3::UnitX(),
          along_ = Vector3::UnitZ();
  std::vector<Vector3> points_m_;  // on the line; neighbours are apart
  std::vector<Vector2> outline_m_;
  Box2 box_m_;                   // around the outline
  double inner_radius_m_ = 0.0;  // of a circle around the centre that is inside the outline
};

}  // namespace spoonbill
