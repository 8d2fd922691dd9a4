// The profile of a body of revolution: lines and arcs in the half-plane beside the axis, by arc length.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// (radius, height) in metres.
using MeridianPoint = Eigen::Vector2d;

class Meridian {
 public:
  // Through the vertices, each inner corner rounded by an arc of its radius, 0 for none. The first and the
  // last vertex may lie on the axis; their rounding is that of the corner which the profile makes there with
  // its mirror image. Refused: roundings that do not fit between the corners, naming the corner.
  static Result<Meridian> rounded(std::span<const MeridianPoint> vertices, std::span<const double> roundings);

  // From the lowest point of a circle about a point of the axis to the highest.
  static Meridian half_circle(double radius_m);

  double length_m() const { return starts_.back(); }
  // At this distance along the profile.
  MeridianPoint at(double distance_m) const;
  // The distances at which pieces begin and end.
  const std::vector<double>& breaks_m() const { return starts_; }

 private:
  // An arc about `centre` from angle `from` through `sweep`, or a line where the radius is 0.
  struct Piece {
    MeridianPoint start, end, centre;
    double radius = 0.0, from = 0.0, sweep = 0.0;
  };
  void add_line(const MeridianPoint& start, const MeridianPoint& end);
  void add_arc(const MeridianPoint& centre, double radius, double from, double sweep);

  std::vector<Piece> pieces_;
  std::vector<double> starts_{0.0};
};

// Turned about the y axis, poles at both ends: a profile that runs upwards beside the axis has its outside
// away from it.
ExactShape revolved_shape(Meridian meridian);

}  // namespace spoonbill
