#include "app/edit/surface_pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

// Fine enough for a hand: cells of a millimetre, a tenth of one beside the true surface.
constexpr double picking_px_per_m = 1000.0;
constexpr SamplingTarget target{1.0, 0.1};

// The first t where |origin + t direction - point| = reach; none where the ray passes by or starts beyond.
std::optional<double> first_crossing(const Ray& ray, const Vector3& point, double reach) {
  const Vector3 to_point = point - ray.origin_m;
  const double along = to_point.dot(ray.direction);
  const double beside_squared = to_point.squaredNorm() - along * along;
  const double half_chord_squared = reach * reach - beside_squared;
  if (half_chord_squared < 0.0) return std::nullopt;
  const double t = along - std::sqrt(half_chord_squared);
  return t > 0.0 ? std::optional<double>(t) : std::nullopt;
}

Vector3 position(const GridSamples<float>& samples, std::size_t i) {
  return {samples.x[i], samples.y[i], samples.z[i]};
}

// Half the longest edge's length stands for half a cell's diagonal: cells are nearly square.
double ball_radius(const TessellatedSurface& surface) {
  double longest_squared = 0.0;
  const auto& corners = surface.indices();
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Vector3 a = position(surface.samples(), corners[i]);
    longest_squared =
        std::max({longest_squared, (a - position(surface.samples(), corners[i + 1])).squaredNorm(),
                  (a - position(surface.samples(), corners[i + 2])).squaredNorm()});
  }
  return 0.5 * std::sqrt(longest_squared);
}

}  // namespace

// Those of triangles alone: others are trimmed away.
void SurfacePick::take_vertices(Sampled& sampled) {
  if (sampled.topology == sampled.surface.topology_version()) return;
  sampled.topology = sampled.surface.topology_version();
  sampled.vertices = sampled.surface.indices();
  std::sort(sampled.vertices.begin(), sampled.vertices.end());
  sampled.vertices.erase(std::unique(sampled.vertices.begin(), sampled.vertices.end()),
                         sampled.vertices.end());
}

void SurfacePick::update(const Snapshot& snapshot) {
  // The last of the bodies may be a soft tool, which is no body to bring it to.
  surfaces_.resize(snapshot.bodies.size() - (is_soft(snapshot.tool) ? 1 : 0));
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    Sampled& sampled = surfaces_[i];
    const SamplingLevel level =
        choose_sampling_level(snapshot.bodies[i].surface, picking_px_per_m, sampled.surface.level(), target);
    const bool evaluated = check_net(snapshot.bodies[i].surface).ok() &&
                           sampled.surface.update(snapshot.bodies[i].surface, level).ok();
    if (!evaluated) sampled = Sampled();
    sampled.ball_m = ball_radius(sampled.surface);
    take_vertices(sampled);
  }
}

std::optional<PickedPoint> SurfacePick::first_touch(const Ray& ray, double radius_m) const {
  double nearest = std::numeric_limits<double>::infinity();
  Vector3 touched = Vector3::Zero();
  for (const Sampled& sampled : surfaces_) {
    const GridSamples<float>& samples = sampled.surface.samples();
    for (const std::uint32_t i : sampled.vertices) {
      const Vector3 point = position(samples, i);
      const auto t = first_crossing(ray, point, radius_m + sampled.ball_m);
      if (!t || *t >= nearest) continue;
      nearest = *t;
      touched = point;
    }
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  const Vector3 centre = ray.origin_m + nearest * ray.direction;
  return PickedPoint{centre, (centre - touched).normalized()};
}

}  // namespace spoonbill
