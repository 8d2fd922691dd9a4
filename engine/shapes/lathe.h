// Bodies of revolution around the y axis: profiles of lines and arcs, and smooth profiles through points.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// A point of a profile: radius and height in metres.
using MeridianPoint = Eigen::Vector2d;

// A profile of lines and arcs in the half-plane beside the axis, parametrised by arc length.
class Meridian {
 public:
  // Makes a profile of straight sides between the vertices. The corner at a vertex is rounded by an arc with
  // the radius in `roundings` (0: not rounded). The first and the last vertex may be on the axis; their
  // roundings apply to the corner between the profile and its mirror image. Refuses roundings that do not fit
  // on a side, and names them.
  static Result<Meridian> rounded(std::span<const MeridianPoint> vertices, std::span<const double> roundings);

  // Makes a half circle around the origin from its lowest point to its highest.
  static Meridian half_circle(double radius_m);

  double length_m() const { return starts_.back(); }
  // Returns the point at a distance along the profile.
  MeridianPoint at(double distance_m) const;
  // Returns the distances along the profile at which its lines and arcs begin and end.
  const std::vector<double>& breaks_m() const { return starts_; }

 private:
  // An arc around `centre` from angle `from` through `sweep`, or a line if the radius is 0.
  struct Piece {
    MeridianPoint start, end, centre;
    double radius = 0.0, from = 0.0, sweep = 0.0;
  };
  void add_line(const MeridianPoint& start, const MeridianPoint& end);
  void add_arc(const MeridianPoint& centre, double radius, double from, double sweep);

  std::vector<Piece> pieces_;
  std::vector<double> starts_{0.0};
};

// Makes the body of revolution of a profile, with poles at both ends. If the profile runs upwards, the
// normals of the body point away from the axis.
ExactShape revolved_shape(Meridian meridian);

// Makes a body of revolution of a smooth profile through the points. An end of the profile on the axis
// becomes a pole, where the profile is horizontal. If both ends are on the axis, the shape is closed. If a
// profile ends at its first point, off the axis, the shape is a ring, which is closed in both directions. Any
// other shape is open, with normals that point away from the axis. Refuses too few or coincident points,
// negative radii, a size out of range, and a profile that crosses the axis or itself.
Result<ExactShape> lathe_shape(const std::vector<MeridianPoint>& profile_m);

}  // namespace spoonbill
