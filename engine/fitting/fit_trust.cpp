#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/fitting/nearest_points.h"
#include "engine/fitting/surface_fitter.h"

namespace spoonbill {

namespace {

constexpr double huber_deviations = 3.0;
constexpr double stray_deviations = 5.0, most_strays = 0.15;
constexpr std::size_t stray_neighbours = 15;
// Of the size: nearer than this nothing is a stray, however exact the others are.
constexpr double least_stray_share = 3e-4;

// Of the size: how far an open edge goes out to points past it.
constexpr double edge_share = 0.02;

}  // namespace

// What lies farther off than nearly all others weighs less, but no more than one in twenty does: at first the
// surface is what is wrong, not the points.
void SurfaceFitter::take_trust(FittedData& data) const {
  std::vector<double> sorted(data.distance_m.begin(),
                             data.distance_m.end() - static_cast<std::ptrdiff_t>(points_->spanning_nodes));
  const auto at = [&](double share) {
    const auto place =
        sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), place, sorted.end());
    return *place;
  };
  const double reach =
      std::max({huber_deviations * 1.4826 * at(0.5), at(0.95), 1e-9 * size_of(points_->scan.points_m)});
  for (std::size_t p = 0; p < data.trust.size(); ++p) {
    const double distance = data.distance_m[p] <= reach ? data.distance_m[p] : distance_off(data, p);
    data.trust[p] = distance <= reach ? 1.0 : reach / distance;
  }
}

// Of what lies a little way past an open edge, how far it is off the surface's plane there: the edge must go
// out to it.
double SurfaceFitter::distance_off(const FittedData& data, std::size_t point) const {
  const Vector2& uv = data.uv[point];
  const auto is_end = [](double parameter) { return parameter <= 0.0 || parameter >= 1.0; };
  const bool at_edge = !closed() && (is_end(uv.y()) || (!periodic() && is_end(uv.x())));
  if (!at_edge || data.distance_m[point] > edge_share * size_of(points_->scan.points_m)) {
    return data.distance_m[point];
  }
  const SurfacePoint at = evaluate(surface_, uv.x(), uv.y());
  return std::abs(at.du.cross(at.dv).normalized().dot(data.points_m[point] - at.position_m));
}

// Of a cloud, what lies off the surface otherwise than the points around it in (u, v): where the surface is
// wrong, all of them lie off alike.
void SurfaceFitter::distrust_strays() {
  if (points_->is_mesh) return;
  const Vector2 scale(static_cast<double>(span_count(structure_.u)),
                      static_cast<double>(span_count(structure_.v)));
  const std::size_t count = points_->scan.points_m.size();
  std::vector<Vector3> places;
  std::vector<double> heights;
  for (std::size_t p = 0; p < count; ++p) {
    const SurfacePoint at = evaluate(surface_, all_.uv[p].x(), all_.uv[p].y());
    const Vector3 normal = at.du.cross(at.dv).normalized();
    places.emplace_back(all_.uv[p].x() * scale.x(), all_.uv[p].y() * scale.y(), 0.0);
    heights.push_back(normal.dot(all_.points_m[p] - at.position_m));
  }
  const NearestPoints nearest(places);
  std::vector<NearestPoints::Found> found;
  std::vector<double> near, off(count);
  for (std::size_t p = 0; p < count; ++p) {
    nearest.nearest(places[p], stray_neighbours, found);
    near.clear();
    for (const NearestPoints::Found& other : found) near.push_back(heights[other.index]);
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    off[p] = std::abs(heights[p] - *middle);
  }
  std::vector<double> sorted = off;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double reach =
      std::max(stray_deviations * 1.4826 * *middle, least_stray_share * size_of(points_->scan.points_m));
  const auto strays = std::count_if(off.begin(), off.end(), [&](double height) { return height > reach; });
  // More are no strays, but what the surface cannot follow.
  if (static_cast<double>(strays) > most_strays * static_cast<double>(count)) return;
  for (std::size_t p = 0; p < count; ++p) {
    if (off[p] > reach) all_.trust[p] = 0.0;
  }
}

}  // namespace spoonbill
