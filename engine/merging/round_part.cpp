#include "engine/merging/round_part.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/base/assert.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// Smooth edges turn less from chord to chord.
constexpr double corner_cosine = 0.98;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d centroid_of(const Polygon& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double twice = 0.0;
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Eigen::Vector2d from = polygon[c] - polygon[0], to = polygon[(c + 1) % polygon.size()] - polygon[0];
    twice += cross(from, to);
    sum += cross(from, to) * (from + to) / 3.0;
  }
  return polygon[0] + sum / twice;
}

// Whether every line from the centre meets the polygon once, which runs around it the way that `turn` tells.
bool is_star_about(const Polygon& polygon, const Eigen::Vector2d& centre, double turn) {
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Eigen::Vector2d &from = polygon[c], &to = polygon[(c + 1) % polygon.size()];
    if (!(turn * cross(from - centre, to - centre) > 0.0)) return false;
  }
  return true;
}

// Seen in three dimensions, where a corner is one for the hand.
bool is_smooth(const std::vector<Vector3>& points_m) {
  const std::size_t count = points_m.size();
  for (std::size_t c = 0; c < count; ++c) {
    const Vector3 to = (points_m[c] - points_m[(c + count - 1) % count]).stableNormalized();
    if (to.dot((points_m[(c + 1) % count] - points_m[c]).stableNormalized()) < corner_cosine) return false;
  }
  return true;
}

std::vector<Vector3> points_of(const Surface& surface, const Polygon& polygon) {
  std::vector<Vector3> points_m;
  points_m.reserve(polygon.size());
  for (const Eigen::Vector2d& at : polygon) points_m.push_back(position(surface, at.x(), at.y()));
  return points_m;
}

// A closed polygon by the share of its length in metres.
class RoundEdge {
 public:
  RoundEdge(Polygon polygon, const std::vector<Vector3>& points_m) : polygon_(std::move(polygon)) {
    double length_m = 0.0;
    for (std::size_t c = 0; c < polygon_.size(); ++c) {
      ends_.push_back(length_m += (points_m[(c + 1) % points_m.size()] - points_m[c]).norm());
    }
    for (double& end : ends_) end /= length_m;
  }

  Eigen::Vector2d at(double share) const {
    const double within = share - std::floor(share);
    const auto chord = std::min(
        static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), within) - ends_.begin()),
        ends_.size() - 1);
    const double start = chord == 0 ? 0.0 : ends_[chord - 1];
    const double along = (within - start) / (ends_[chord] - start);
    return polygon_[chord] + along * (polygon_[(chord + 1) % polygon_.size()] - polygon_[chord]);
  }

 private:
  Polygon polygon_;
  std::vector<double> ends_;  // of each chord
};

// Where the line from the centre towards `to` leaves a hole that is star-shaped about it.
Eigen::Vector2d on_hole(const Polygon& hole, const Eigen::Vector2d& centre, const Eigen::Vector2d& to) {
  const Eigen::Vector2d way = to - centre;
  for (std::size_t c = 0; c < hole.size(); ++c) {
    const Eigen::Vector2d from = hole[(c + 1) % hole.size()] - centre, next = hole[c] - centre;
    if (cross(from, way) < 0.0 || cross(way, next) < 0.0) continue;
    return centre + way * (cross(from, next - from) / cross(way, next - from));
  }
  return centre;
}

}  // namespace

std::optional<Result<FittedShape>> round_part(const Surface& surface, const std::vector<Polygon>& polygons,
                                              double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m > 0.0);
  if (polygons.empty() || polygons.size() > 2) return std::nullopt;
  const bool first_is_outer = signed_area(polygons.front()) > 0.0;
  const Polygon& outer = first_is_outer ? polygons.front() : polygons.back();
  const Polygon* hole = polygons.size() == 1 ? nullptr
                        : first_is_outer     ? &polygons.back()
                                             : &polygons.front();
  const Eigen::Vector2d centre = centroid_of(hole ? *hole : outer);
  const std::vector<Vector3> outer_m = points_of(surface, outer);
  if (!is_star_about(outer, centre, 1.0) || !is_smooth(outer_m)) return std::nullopt;
  if (hole && (!is_star_about(*hole, centre, -1.0) || !is_smooth(points_of(surface, *hole)))) {
    return std::nullopt;
  }

  const RoundEdge edge(outer, outer_m);
  std::map<double, std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;  // a fit asks for the same ones again
  ExactShape shape;
  shape.u = {true, {0.0, 1.0}};
  shape.v = {false, {0.0, 1.0}};
  shape.pole_at_end = hole == nullptr;
  shape.at = [&](double u, double v) {
    auto known = lines.find(u);
    if (known == lines.end()) {
      const Eigen::Vector2d start = edge.at(u);
      known = lines.emplace(u, std::pair(start, hole ? on_hole(*hole, centre, start) : centre)).first;
    }
    const Eigen::Vector2d at = known->second.first + v * (known->second.second - known->second.first);
    return position(surface, at.x(), at.y());
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.min_spans = 4;
  fit.keeps_parameters = true;
  return fit_shape(shape, fit);
}

}  // namespace spoonbill
