#include "render/tessellation/reach_ring.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

// Largest number of triangles that a line crosses. It bounds the time on very fine triangles.
constexpr int most_steps = 4000;

Vector3 vertex_position(const TessellatedSurface& surface, std::uint32_t v) {
  const GridSamples<float>& samples = surface.samples();
  return {static_cast<double>(samples.x[v]), static_cast<double>(samples.y[v]),
          static_cast<double>(samples.z[v])};
}

Triangle triangle_at(const TessellatedSurface& surface, std::uint32_t first) {
  const std::uint32_t* const corners = &surface.indices()[first];
  return {vertex_position(surface, corners[0]), vertex_position(surface, corners[1]),
          vertex_position(surface, corners[2])};
}

Vector3 normal_of(const Triangle& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]);
}

double squared_length(const Triangle& t, int side) {
  return (t[static_cast<std::size_t>((side + 1) % 3)] - t[static_cast<std::size_t>(side)]).squaredNorm();
}

// At a pole, some triangles have two corners at the same point, but for rounding.
bool has_area(const Triangle& t) {
  constexpr double least_ratio = 1e-4;
  const auto [least, most] = std::minmax({squared_length(t, 0), squared_length(t, 1), squared_length(t, 2)});
  return least > least_ratio * least_ratio * most;
}

int next_corner(int corner) {
  return (corner + 1) % 3;
}

}  // namespace

void ReachRing::update(const TessellatedSurface& surface, const Vector3& centre_m, double radius_m) {
  clear();
  if (topology_version_ != surface.topology_version()) connect(surface);
  const std::optional<Place> start = find_place(surface, centre_m);
  if (!start) return;
  const Triangle triangle = triangle_at(surface, start->triangle);
  const Vector3 along = (triangle[1] - triangle[0]).normalized(),
                across = normal_of(triangle).normalized().cross(along);
  for (std::size_t k = 0; k < ends_m_.size(); ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / directions;
    trails_[k].clear();
    ends_m_[k] =
        walk(surface, *start, std::cos(angle) * along + std::sin(angle) * across, radius_m, trails_[k]);
  }
  drop_overtaken(radius_m);
}

// Drops the ends that another line has reached by a shorter way, as behind a bar around which lines meet.
void ReachRing::drop_overtaken(double radius_m) {
  // Lines beside each other end within a fifteenth of the radius of each other, and ways over a curved
  // surface are a little longer than straight ones.
  constexpr double shorter = 0.9;
  // Points whose normals differ more are compared with nearer ones only, because a straight way may lead
  // through the body.
  constexpr double same_side = 0.9;
  const auto is_overtaken = [&](std::size_t k) {
    const TrailPoint& end = trails_[k].back();
    return std::any_of(trails_.begin(), trails_.end(), [&](const std::vector<TrailPoint>& trail) {
      return std::any_of(trail.begin(), trail.end(), [&](const TrailPoint& point) {
        return point.normal.dot(end.normal) > same_side &&
               point.way_m + (point.position_m - end.position_m).norm() < shorter * radius_m;
      });
    });
  };
  std::array<bool, directions> overtaken{};
  for (std::size_t k = 0; k < ends_m_.size(); ++k) overtaken[k] = ends_m_[k] && is_overtaken(k);
  for (std::size_t k = 0; k < ends_m_.size(); ++k) {
    if (overtaken[k]) ends_m_[k].reset();
  }
}

// Lists the triangles around each vertex.
void ReachRing::connect(const TessellatedSurface& surface) {
  const std::vector<std::uint32_t>& corners = surface.indices();
  starts_.assign(surface.vertex_count() + 1, 0);
  for (const std::uint32_t vertex : corners) ++starts_[vertex + 1];
  for (std::size_t v = 0; v + 1 < starts_.size(); ++v) starts_[v + 1] += starts_[v];
  triangles_.resize(corners.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    triangles_[next[corners[c]]++] = static_cast<std::uint32_t>(c - c % 3);
  }
  topology_version_ = surface.topology_version();
}

// Returns the place on the triangles that is nearest to a point.
std::optional<ReachRing::Place> ReachRing::find_place(const TessellatedSurface& surface,
                                                      const Vector3& point_m) {
  std::optional<Place> place;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::uint32_t first = 0; first + 2 < surface.indices().size(); first += 3) {
    const Triangle triangle = triangle_at(surface, first);
    // A triangle is within its longest side of each of its corners.
    const double side_m = std::sqrt(
        std::max({squared_length(triangle, 0), squared_length(triangle, 1), squared_length(triangle, 2)}));
    if ((triangle[0] - point_m).norm() - side_m > least_m || !has_area(triangle)) continue;
    const Vector3 on_triangle = nearest_on_triangle(triangle[0], triangle[1], triangle[2], point_m).point;
    const double distance_m = (on_triangle - point_m).norm();
    if (!(distance_m < least_m)) continue;
    least_m = distance_m;
    place = Place{first, on_triangle};
  }
  return place;
}

// Returns where a line enters the triangle on the other side of a side; nothing at the edge of the surface.
std::optional<ReachRing::Entry> ReachRing::cross(const std::vector<std::uint32_t>& corners,
                                                 std::uint32_t triangle, int side) const {
  const std::uint32_t from = corners[triangle + static_cast<std::uint32_t>(side)],
                      to = corners[triangle + static_cast<std::uint32_t>(next_corner(side))];
  for (std::uint32_t t = starts_[from]; t < starts_[from + 1]; ++t) {
    const std::uint32_t other = triangles_[t];
    for (int k = 0; k < 3 && other != triangle; ++k) {
      const bool is_same_side = corners[other + static_cast<std::uint32_t>(k)] == to &&
                                corners[other + static_cast<std::uint32_t>(next_corner(k))] == from;
      if (is_same_side) return Entry{other, k};
    }
  }
  return std::nullopt;
}

// Follows a line that is straight in every triangle and keeps its angle to the sides that it crosses. Returns
// its end; nothing if it leaves the surface.
std::optional<Vector3> ReachRing::walk(const TessellatedSurface& surface, const Place& start,
                                       Vector3 direction, double length_m,
                                       std::vector<TrailPoint>& trail) const {
  const std::vector<std::uint32_t>& corners = surface.indices();
  const double whole_m = length_m, step_m = whole_m / trail_points;
  Vector3 point_m = start.point_m;
  std::uint32_t at = start.triangle;
  int entered = -1;
  Vector3 outward = Vector3::Zero(), along = Vector3::Zero();  // of the last side that the line has crossed
  for (int step = 0; step < most_steps; ++step) {
    const Triangle triangle = triangle_at(surface, at);
    int side = -1;
    if (has_area(triangle)) {
      const Vector3 normal = normal_of(triangle).normalized();
      if (entered >= 0) {
        direction = direction.dot(along) * along + direction.dot(outward) * along.cross(normal);
        direction.normalize();
      }
      double least_m = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        if (k == entered) continue;
        const Vector3& corner = triangle[static_cast<std::size_t>(k)];
        const Vector3 one = (triangle[static_cast<std::size_t>(next_corner(k))] - corner).normalized();
        const Vector3 out = one.cross(normal);
        const double speed = direction.dot(out);
        if (!(speed > 0.0)) continue;
        const double distance_m = std::max(0.0, (corner - point_m).dot(out) / speed);
        if (!(distance_m < least_m)) continue;
        least_m = distance_m;
        side = k;
        outward = out;
        along = one;
      }
      if (side < 0) return std::nullopt;
      const double along_m = std::min(least_m, length_m);
      const double way_m = whole_m - length_m;
      for (double next_m = step_m * (std::floor(way_m / step_m) + 1.0); next_m < way_m + along_m;
           next_m += step_m) {
        trail.push_back({point_m + (next_m - way_m) * direction, normal, next_m});
      }
      point_m += along_m * direction;
      if (least_m >= length_m) {
        trail.push_back({point_m, normal, whole_m});
        return point_m;
      }
      length_m -= least_m;
    } else {
      // The line passes between the two long sides of a triangle without area.
      side = next_corner(entered);
      if (squared_length(triangle, next_corner(side)) > squared_length(triangle, side)) {
        side = next_corner(side);
      }
    }
    const std::optional<Entry> entry = cross(corners, at, side);
    if (!entry) return std::nullopt;
    at = entry->triangle;
    entered = entry->side;
  }
  return std::nullopt;
}

}  // namespace spoonbill
