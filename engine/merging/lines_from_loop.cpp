#include "engine/merging/lines_from_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
    : u_start_(body.u.domain_start()),
      u_length_(body.u.domain_end() - body.u.domain_start()),
      v_start_(body.v.domain_start()),
      v_length_(body.v.domain_end() - body.v.domain_start()) {
  double farthest = 0.0;
  for (const Eigen::Vector2d& uv : loop) {
    middle_ += on_plane(uv) / static_cast<double>(loop.size());
    farthest = std::max(farthest, on_plane(uv).norm());
  }
  circle_ = std::min(circle_of_loop * farthest, farthest + most_of_way_left * (1.0 - farthest));
  double to_circle = 0.0, shortest = 1.0;
  for (const Eigen::Vector2d& uv : loop) {
    const double length = (polar(circle_, 2.0 * pi * angle_of(uv)) - on_plane(uv)).norm();
    to_circle += length / static_cast<double>(loop.size());
    shortest = std::min(shortest, length);
  }
  bend_ = to_circle / (to_circle + 1.0 - circle_);
  // No faster than the shortest line bears without turning back before it.
  constexpr double most_of_shortest = 1.5;
  speed_at_bend_ = std::min(to_circle, most_of_shortest * shortest) / bend_;
}

Eigen::Vector2d LinesFromLoop::on_plane(const Eigen::Vector2d& uv) const {
  return polar((uv.y() - v_start_) / v_length_, 2.0 * pi * (uv.x() - u_start_) / u_length_);
}

double LinesFromLoop::angle_of(const Eigen::Vector2d& start) const {
  const Eigen::Vector2d from_middle = on_plane(start) - middle_;
  return std::atan2(from_middle.y(), from_middle.x()) / (2.0 * pi);
}

Eigen::Vector2d LinesFromLoop::at(const Eigen::Vector2d& start, double share) const {
  const double angle = 2.0 * pi * angle_of(start);
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  if (share >= bend_) {
    const double s = (share - bend_) / (1.0 - bend_), start_slope = speed_at_bend_ * (1.0 - bend_);
    place = polar(circle_ + s * start_slope + s * s * (1.0 - circle_ - start_slope), angle);
  } else {
    // Hermite's cubic, which runs on into the line beyond with its speed.
    const Eigen::Vector2d from = on_plane(start), to = polar(circle_, angle);
    const Eigen::Vector2d out = (to - from).norm() * (from - middle_).normalized();
    const Eigen::Vector2d in = polar(speed_at_bend_ * bend_, angle);
    const double s = share / bend_, t = 1.0 - s;
    place = t * t * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * t) * to + t * t * s * out - s * s * t * in;
  }
  const double turned = std::atan2(place.y(), place.x()) / (2.0 * pi);
  return {u_start_ + u_length_ * turned, v_start_ + v_length_ * std::min(1.0, place.norm())};
}

}  // namespace spoonbill
