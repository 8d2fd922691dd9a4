#include "engine/shapes/lathe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "engine/base/number_text.h"
#include "engine/shapes/shape_sizes.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

namespace {

constexpr int samples = 600;

std::string place_text(const Vector3& point_m) {
  return "radius " + short_length_text(point_m.x()) + ", height " + short_length_text(point_m.y());
}

std::vector<Vector3> sampled(const SmoothCurve& profile) {
  std::vector<Vector3> points;
  for (int k = 0; k <= samples; ++k) points.push_back(profile.at(profile.end() * k / samples));
  return points;
}

double cross(const Vector3& a, const Vector3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Whether two pieces of the profile, not next to each other, cross.
bool crosses(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

Status check_profile(const std::vector<Vector3>& points, bool pole_first, bool pole_last) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool at_pole = (k == 0 && pole_first) || (k + 1 == points.size() && pole_last);
    if (!at_pole && !(points[k].x() > 0.0)) {
      return Error{"the curve through the profile's points crosses the axis near " + place_text(points[k]) +
                   "; give it points nearer together there"};
    }
  }
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    for (std::size_t other = k + 2; other + 1 < points.size(); ++other) {
      if (crosses(points[k], points[k + 1], points[other], points[other + 1])) {
        return Error{"the profile crosses itself near " + place_text(points[k])};
      }
    }
  }
  return {};
}

// Twice the volume over 2 pi: above zero where the profile runs up outside.
double turning(const std::vector<Vector3>& points) {
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const double radius = 0.5 * (points[k].x() + points[k + 1].x());
    sum += radius * radius * (points[k + 1].y() - points[k].y());
  }
  return sum;
}

ExactShape turned(const SmoothCurve& profile, bool pole_first, bool pole_last) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.v.periodic = profile.closed();
  shape.pole_at_start = pole_first;
  shape.pole_at_end = pole_last;
  shape.at = [=](double u, double v) {
    const Vector3 point = profile.at(v * profile.end());
    const bool at_pole = (pole_first && v <= 0.0) || (pole_last && v >= 1.0);
    const double radius = at_pole ? 0.0 : point.x(), angle = 2.0 * std::numbers::pi * u;
    return Vector3(radius * std::cos(angle), point.y(), -radius * std::sin(angle));
  };
  return shape;
}

}  // namespace

Result<ExactShape> lathe_shape(const std::vector<MeridianPoint>& profile_m) {
  std::vector<Vector3> points;
  double reach = 0.0;
  for (const MeridianPoint& point : profile_m) {
    if (!(point.x() >= 0.0) || !std::isfinite(point.y())) {
      return Error{"point " + std::to_string(points.size() + 1) + " of the profile has a radius of " +
                   short_length_text(point.x()) + "; radii are from 0 on"};
    }
    points.emplace_back(point.x(), point.y(), 0.0);
    reach = std::max(reach, (points.back() - points.front()).norm());
  }
  if (points.size() < 2) return Error{"a profile needs at least 2 points"};
  if (Status status = check_size("the profile's size", reach); !status) return status.error();
  const double on_axis = 1e-6 * reach;
  const bool closed =
      points.size() > 3 && (points.back() - points.front()).norm() <= on_axis && points.front().x() > on_axis;
  if (closed) points.pop_back();
  bool pole_first = !closed && points.front().x() <= on_axis;
  bool pole_last = !closed && points.back().x() <= on_axis;
  if (pole_first) points.front().x() = 0.0;
  if (pole_last) points.back().x() = 0.0;
  CurveEnds first, last;
  first.level_y = pole_first;
  last.level_y = pole_last;
  auto curve = SmoothCurve::through(points, closed, first, last);
  if (!curve) return Error{"profile: " + curve.error().message};
  const std::vector<Vector3> samples_m = sampled(curve.value());
  if (Status status = check_profile(samples_m, pole_first, pole_last); !status) return status.error();
  if (turning(samples_m) < 0.0) {
    std::reverse(points.begin(), points.end());
    std::swap(pole_first, pole_last);
    std::swap(first, last);
    curve = SmoothCurve::through(points, closed, first, last);
  }
  return turned(curve.value(), pole_first, pole_last);
}

}  // namespace spoonbill
