// How a closed body is run through from a loop that lies beside its pole: along lines that start on the loop
// and lead to the pole on the far side. Outside the tick; pure functions.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/bspline/surface.h"

namespace spoonbill {

// The body's parameters seen as a plane: v from the pole at its start is the distance from the origin, u the
// angle. A line leads from the loop away from its middle, bends, and becomes one of the body's own lines of
// constant u on a circle around the loop: beyond, no rounding of the body lies askew to its lines. All leave
// the loop at one speed, as a fillet that ends there does.
class LinesFromLoop {
 public:
  // Along v, from the pole beside the loop; closed along u; must outlive this. The loop's u, v in its order,
  // any u of a period.
  LinesFromLoop(const Surface& body, const std::vector<Eigen::Vector2d>& loop);

  // Shares of a turn about the loop's middle.
  double angle_of(const Eigen::Vector2d& start) const;
  // The u, v at a share of the way along the line that starts there.
  Eigen::Vector2d at(const Eigen::Vector2d& start, double share) const;
  // Where lines become the body's own.
  double share_of_bend() const { return bend_; }

 private:
  Eigen::Vector2d on_plane(const Eigen::Vector2d& uv) const;
  Eigen::Vector2d in_parameters(const Eigen::Vector2d& place) const;
  // How far the body leads from a place for a step on the plane.
  double metres_of_step(const Eigen::Vector2d& place, const Eigen::Vector2d& direction) const;

  const Surface* body_;
  double u_start_, u_length_, v_start_, v_length_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double circle_ = 0.0;
  double bend_ = 0.0;
  double speed_at_bend_ = 0.0, start_speed_m_ = 0.0;
};

}  // namespace spoonbill
