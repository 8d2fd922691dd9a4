#include "loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace spoonbill {

namespace {

double angle_between(int count) {
  return 2.0 * std::numbers::pi / count;
}

std::vector<double> stretched(const std::vector<double>& knots, double start, double end) {
  std::vector<double> result;
  for (const double knot : knots) result.push_back(start + (end - start) * knot);
  return result;
}

}  // namespace

KnotVector open_domain(double start, double end) {
  return KnotVector::open(2, stretched({0, 0, 0, 0.25, 0.5, 1, 1, 1}, start, end)).value();
}

KnotVector periodic_domain(double start, double end) {
  return KnotVector::periodic(3, stretched({0, 0.125, 0.5, 0.75, 1}, start, end)).value();
}

std::vector<Eigen::Vector2d> rectangle(double low_u, double low_v, double high_u, double high_v) {
  return {{low_u, low_v}, {high_u, low_v}, {high_u, high_v}, {low_u, high_v}};
}

std::vector<Eigen::Vector2d> backwards(std::vector<Eigen::Vector2d> points) {
  std::reverse(points.begin(), points.end());
  return points;
}

Result<TrimLoop> make_polygon_loop(const KnotVector& along_u, const KnotVector& along_v,
                                   const std::vector<Eigen::Vector2d>& points) {
  const int count = static_cast<int>(points.size());
  if (count < 3)
    return Error{ErrorCode::degenerate,
                 "a trim loop of " + std::to_string(count) + " points encloses nothing; give 3"};
  std::vector<double> u, v, ends{0.0};
  for (int i = 0; i <= count; ++i) {
    u.push_back(points[i % count].x());
    v.push_back(points[i % count].y());
    ends.push_back(i);
  }
  ends.push_back(count);
  auto knots = KnotVector::open(1, std::move(ends));
  if (!knots) return knots.error();
  return make_trim_loop(along_u, along_v, std::move(knots).value(), std::move(u), std::move(v));
}

TrimLoop polygon_loop(const KnotVector& u, const KnotVector& v, const std::vector<Eigen::Vector2d>& points) {
  auto loop = make_polygon_loop(u, v, points);
  EXPECT_TRUE(loop.ok()) << (loop ? "" : loop.error().message);
  return std::move(loop).value();
}

TrimLoop round_loop(const KnotVector& u, const KnotVector& v, const Eigen::Vector2d& middle, double radius,
                    int count, bool clockwise) {
  std::vector<double> points_u, points_v;
  for (int i = 0; i < count; ++i) {
    const double angle = (clockwise ? -i : i) * angle_between(count);
    points_u.push_back(middle.x() + radius * std::cos(angle));
    points_v.push_back(middle.y() + radius * std::sin(angle));
  }
  auto loop = make_trim_loop(u, v, KnotVector::periodic_uniform(3, count).value(), std::move(points_u),
                             std::move(points_v));
  EXPECT_TRUE(loop.ok()) << (loop ? "" : loop.error().message);
  return std::move(loop).value();
}

double round_loop_area(double radius, int count) {
  const double angle = angle_between(count);
  return count * radius * radius / 720.0 *
         (245.0 * std::sin(angle) + 56.0 * std::sin(2.0 * angle) + std::sin(3.0 * angle));
}

}  // namespace spoonbill
