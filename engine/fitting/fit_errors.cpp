#include "engine/fitting/fit_errors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/fitting/closest_parameters.h"
#include "engine/fitting/nearest_points.h"

namespace spoonbill {
namespace {

constexpr int projection_steps = 4;
constexpr int samples_a_span = 4;
constexpr std::size_t plane_points = 10;
// A sample is seen within so many distances between neighbouring points, beyond a rim within one.
constexpr double seen_spacings = 3.0;

// Of a mesh the points all over its triangles, of which its vertices alone may be a few corners.
bool measures_fitted_points(const FitPoints& points) {
  return points.is_mesh && points.scan.points_m.size() > points.given_m.size();
}

void measure_data(const FittedSurface& fit, const FitPoints& points, FitErrors& errors) {
  const bool are_fitted = measures_fitted_points(points);
  errors.places_m = are_fitted ? points.scan.points_m : points.given_m;
  const ClosestParameters closest(fit.surface);
  std::vector<double> trusted;
  for (std::size_t g = 0; g < errors.places_m.size(); ++g) {
    const std::size_t fitted = are_fitted ? g : points.stands_for[g];
    const Vector3& point = errors.places_m[g];
    ClosestPoint found = closest.from(point, fit.uv[fitted], projection_steps);
    // One that was stuck on the other side of something gets a second chance.
    if (found.distance_m > 1.5 * fit.distance_m[fitted] || fit.trust[fitted] < 1.0) {
      const ClosestPoint other = closest.anywhere(point, projection_steps);
      if (other.distance_m < found.distance_m) found = other;
    }
    errors.uv.push_back(found.uv);
    errors.distance_m.push_back(found.distance_m);
    errors.is_stray.push_back(fit.trust[fitted] == 0.0);
    if (!errors.is_stray.back()) trusted.push_back(found.distance_m);
  }
  errors.strays = errors.places_m.size() - trusted.size();
  errors.data_to_surface = deviation_of(std::move(trusted));
  errors.all_to_surface = deviation_of(errors.distance_m);
}

std::vector<Vector3> surface_samples(const Surface& surface) {
  const auto parameters = [](const KnotVector& knots) {
    const std::vector<double> breaks = knots.breakpoints();
    std::vector<double> middles;
    for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
      for (int k = 0; k < samples_a_span; ++k) {
        middles.push_back(breaks[s] + (breaks[s + 1] - breaks[s]) * (k + 0.5) / samples_a_span);
      }
    }
    return middles;
  };
  std::vector<Vector3> samples;
  for (const double u : parameters(surface.u)) {
    for (const double v : parameters(surface.v)) samples.push_back(position(surface, u, v));
  }
  return samples;
}

// From the plane in which the found points spread.
double plane_distance(const Vector3& sample, const std::vector<Vector3>& points,
                      const std::vector<NearestPoints::Found>& found) {
  Vector3 mean = Vector3::Zero();
  for (const NearestPoints::Found& near : found) {
    mean += points[near.index] / static_cast<double>(found.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const NearestPoints::Found& near : found) {
    spread += (points[near.index] - mean) * (points[near.index] - mean).transpose();
  }
  const Vector3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return std::abs(normal.dot(sample - mean));
}

// The mean distance to the sixth neighbour, of some of the points: as far as all around a point reach.
double usual_spacing(const std::vector<Vector3>& points, const NearestPoints& nearest) {
  constexpr std::size_t neighbours = 6, most = 2000;
  std::vector<NearestPoints::Found> found;
  double sum = 0.0, count = 0.0;
  for (std::size_t p = 0; p < points.size(); p += 1 + points.size() / most, count += 1.0) {
    nearest.nearest(points[p], neighbours + 1, found);
    sum += found.back().distance;
  }
  return sum / count;
}

void measure_surface(const FittedSurface& fit, const FitPoints& points, FitErrors& errors) {
  const std::vector<Vector3>& data = points.scan.points_m;
  const NearestPoints nearest(data);
  const double spacing = usual_spacing(data, nearest);
  const std::vector<Vector3> samples = surface_samples(fit.surface);
  std::vector<bool> at_rim(points.graph.size(), false);
  for (const Rim& rim : points.rims) {
    for (const std::uint32_t node : rim.nodes) {
      at_rim[node] = true;
      for (const std::uint32_t near : points.graph.of(node)) at_rim[near] = true;
    }
  }
  std::vector<NearestPoints::Found> found;
  std::vector<double> distances;
  for (const Vector3& sample : samples) {
    nearest.nearest(sample, plane_points, found);
    const double away = found.front().distance, plane = plane_distance(sample, data, found);
    const double aside = std::sqrt(std::max(0.0, away * away - plane * plane));
    const bool beyond_rim = at_rim[points.node_of[found.front().index]] && away > spacing;
    if (beyond_rim || aside > seen_spacings * spacing) continue;
    distances.push_back(std::min(away, plane));
  }
  errors.unseen_share = 1.0 - static_cast<double>(distances.size()) / static_cast<double>(samples.size());
  errors.surface_to_data = deviation_of(std::move(distances));
}

}  // namespace

Deviation deviation_of(std::vector<double> distances_m) {
  if (distances_m.empty()) return {};
  std::sort(distances_m.begin(), distances_m.end());
  const double sum = std::accumulate(distances_m.begin(), distances_m.end(), 0.0);
  const std::size_t last = distances_m.size() - 1;
  const auto place = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(last)));
  return {distances_m[last], distances_m[place], sum / static_cast<double>(distances_m.size())};
}

FitErrors measure_errors(const FittedSurface& fit, const FitPoints& points) {
  SPOONBILL_ASSERT(fit.uv.size() == points.scan.points_m.size());
  SPOONBILL_ASSERT(fit.trust.size() == fit.uv.size());
  FitErrors errors;
  measure_data(fit, points, errors);
  measure_surface(fit, points, errors);
  return errors;
}

}  // namespace spoonbill
