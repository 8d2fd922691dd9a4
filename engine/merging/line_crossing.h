// Intersections of a surface with lines, which are straight or are lines of constant u of another surface,
// and the contact of the ball that rolls along a corner. These searches are too slow for a tick.
#pragma once

#include <optional>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/box_tree.h"

namespace spoonbill {

struct LineCrossing {
  double along = 0.0;  // v on the crossing line, or the distance along a straight one
  double other_u = 0.0, other_v = 0.0;
  Vector3 point_m = Vector3::Zero();
};

// Finds where lines cross a surface. A triangle mesh gives start values; it is fine enough for all crossings
// steeper than a few degrees. The results are exact on the surface, except for rounding. The object does not
// change and may be used by several threads.
class CrossingFinder {
 public:
  explicit CrossingFinder(const Surface& other);

  // Returns the crossings of a line of constant u of `surface` with the finder's surface, in order of v. A
  // line that only touches the finder's surface may be missed.
  std::vector<LineCrossing> intersect_line(const Surface& surface, double u) const;

  // Returns the crossings of a straight line in order of distance, up to `length_m` along the unit direction.
  std::vector<LineCrossing> intersect_ray(const Vector3& from_m, const Vector3& direction,
                                          double length_m) const;

 private:
  struct Start {
    double fraction, other_u, other_v;
  };
  std::vector<Start> find_starts(const Vector3& from, const Vector3& to) const;
  template <class Curve>
  std::optional<LineCrossing> polish(const Curve& curve, double along, const Start& start) const;

  Surface other_;
  std::vector<double> u_, v_;
  std::vector<Vector3> points_m_;
  std::optional<BoxTree> tree_;
};

// Contact of a ball that touches the first surface on a line of constant u and the other surface anywhere.
struct BallContact {
  double v = 0.0;                       // parameter of the contact on the first surface, with the given u
  double other_u = 0.0, other_v = 0.0;  // parameters of the contact on the other surface
  Vector3 centre_m = Vector3::Zero();
};

// Side of each surface on which the ball is: 1 along the surface's normals, -1 against them.
struct BallSides {
  int of_surface = 1, of_other = 1;
};

// Finds the contact of a ball by Newton's method. It starts at the crossing with a radius of zero and
// increases the radius in steps. Returns nothing if no ball of the given radius fits.
std::optional<BallContact> ball_contact(const Surface& surface, double u, const Surface& other,
                                        const LineCrossing& crossing, BallSides sides, double radius_m);

}  // namespace spoonbill
