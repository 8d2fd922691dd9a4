// The ring that shows where a stroke of local reach ends, on a tessellated surface. Does not use GL.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

// Finds the points at a distance along a surface from one of its points. From this point, straightest lines
// (Polthier and Schmies 1998) lead over the triangles in all directions; the ring connects their ends. An end
// that another line reaches by a shorter way is left out, as behind a bar that is thinner than the ring. One
// owner, one thread.
class ReachRing {
 public:
  static constexpr int directions = 96;

  // Finds the ring of this radius around the point of the surface nearest to `centre_m`. A line that leaves
  // an open surface has no end.
  void update(const TessellatedSurface& surface, const Vector3& centre_m, double radius_m);
  void clear() { ends_m_.fill(std::nullopt); }

  // Returns the ends of the lines, in order around the point.
  const std::array<std::optional<Vector3>, directions>& ends_m() const { return ends_m_; }

 private:
  // A place on a triangle, which is given by the number of its first corner in indices().
  struct Place {
    std::uint32_t triangle = 0;
    Vector3 point_m = Vector3::Zero();
  };
  // A line that continues in a triangle over the side that begins at a corner, 0 to 2.
  struct Entry {
    std::uint32_t triangle = 0;
    int side = 0;
  };
  // A point on a line, and the length of the line up to there.
  struct TrailPoint {
    Vector3 position_m = Vector3::Zero(), normal = Vector3::Zero();
    double way_m = 0.0;
  };
  // Number of points of a line with which the ends of others are compared.
  static constexpr int trail_points = 16;

  void connect(const TessellatedSurface& surface);
  void drop_overtaken(double radius_m);
  static std::optional<Place> find_place(const TessellatedSurface& surface, const Vector3& point_m);
  std::optional<Entry> cross(const std::vector<std::uint32_t>& corners, std::uint32_t triangle,
                             int side) const;
  std::optional<Vector3> walk(const TessellatedSurface& surface, const Place& start, Vector3 direction,
                              double length_m, std::vector<TrailPoint>& trail) const;

  std::uint64_t topology_version_ = 0;
  // The triangles around vertex v are triangles_[starts_[v]] up to triangles_[starts_[v + 1]].
  std::vector<std::uint32_t> starts_, triangles_;
  std::array<std::optional<Vector3>, directions> ends_m_;
  std::array<std::vector<TrailPoint>, directions> trails_;
};

}  // namespace spoonbill
