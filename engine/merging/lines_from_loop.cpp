#include "engine/merging/lines_from_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

using std::numbers::pi;

// The circle's distance from the pole, of that of the loop's farthest point, unless the far pole is near.
constexpr double circle_of_loop = 1.3, most_of_way_left = 0.5;

Eigen::Vector2d polar(double radius, double angle) {
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

}  // namespace

LinesFromLoop::LinesFromLoop(const Surface& body, const std::vector<Eigen::Vector2d>& loop)
    : body_(&body),
      u_start_(body.u.domain_start()),
      u_length_(body.u.domain_end() - body.u.domain_start()),
      v_start_(body.v.domain_start()),
      v_length_(body.v.domain_end() - body.v.domain_start()) {
  SPOONBILL_ASSERT(body.u.is_periodic() && loop.size() >= 3);
  double farthest = 0.0;
  for (const Eigen::Vector2d& uv : loop) {
    middle_ += on_plane(uv) / static_cast<double>(loop.size());
    farthest = std::max(farthest, on_plane(uv).norm());
  }
  circle_ = std::min(circle_of_loop * farthest, farthest + most_of_way_left * (1.0 - farthest));
  double to_circle = 0.0, shortest = 1.0, shortest_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& uv : loop) {
    const Eigen::Vector2d start = on_plane(uv);
    const double length = (polar(circle_, 2.0 * pi * angle_of(uv)) - start).norm();
    shortest_m = std::min(shortest_m, length * metres_of_step(start, (start - middle_).normalized()));
    to_circle += length / static_cast<double>(loop.size());
    shortest = std::min(shortest, length);
  }
  bend_ = to_circle / (to_circle + 1.0 - circle_);
  // No faster than the shortest line bears without turning back before it.
  constexpr double most_of_shortest = 1.5;
  speed_at_bend_ = std::min(to_circle, most_of_shortest * shortest) / bend_;
  start_speed_m_ = most_of_shortest * shortest_m;
}

Eigen::Vector2d LinesFromLoop::on_plane(const Eigen::Vector2d& uv) const {
  return polar((uv.y() - v_start_) / v_length_, 2.0 * pi * (uv.x() - u_start_) / u_length_);
}

double LinesFromLoop::angle_of(const Eigen::Vector2d& start) const {
  const Eigen::Vector2d from_middle = on_plane(start) - middle_;
  return std::atan2(from_middle.y(), from_middle.x()) / (2.0 * pi);
}

Eigen::Vector2d LinesFromLoop::at(const Eigen::Vector2d& start, double share) const {
  SPOONBILL_ASSERT_DEBUG(share >= 0.0 && share <= 1.0);
  const double angle = 2.0 * pi * angle_of(start);
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  if (share >= bend_) {
    const double s = (share - bend_) / (1.0 - bend_), start_slope = speed_at_bend_ * (1.0 - bend_);
    place = polar(circle_ + s * start_slope + s * s * (1.0 - circle_ - start_slope), angle);
  } else {
    // Hermite's cubic, which runs on into the line beyond with its speed.
    const Eigen::Vector2d from = on_plane(start), to = polar(circle_, angle);
    const Eigen::Vector2d away = (from - middle_).normalized();
    const Eigen::Vector2d out = start_speed_m_ / metres_of_step(from, away) * away;
    const Eigen::Vector2d in = polar(speed_at_bend_ * bend_, angle);
    const double s = share / bend_, t = 1.0 - s;
    place = t * t * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * t) * to + t * t * s * out - s * s * t * in;
  }
  return in_parameters(place);
}

Eigen::Vector2d LinesFromLoop::in_parameters(const Eigen::Vector2d& place) const {
  const double turned = std::atan2(place.y(), place.x()) / (2.0 * pi);
  return {u_start_ + u_length_ * turned, v_start_ + v_length_ * std::min(1.0, place.norm())};
}

double LinesFromLoop::metres_of_step(const Eigen::Vector2d& place, const Eigen::Vector2d& direction) const {
  constexpr double step = 1e-5;
  const Eigen::Vector2d from = in_parameters(place - step * direction);
  const Eigen::Vector2d to = in_parameters(place + step * direction);
  const double moved_m = (position(*body_, to.x(), to.y()) - position(*body_, from.x(), from.y())).norm();
  return moved_m / (2.0 * step);
}

}  // namespace spoonbill
