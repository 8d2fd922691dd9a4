#include "engine/collision/meshes/mesh_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {

namespace {

constexpr std::uint32_t no_part = 0xffffffffU;
// Largest number of box tests and visited triangles in the search for cavities. It bounds the time for files
// with very many tiny parts.
constexpr std::size_t cavity_work = 50'000'000;

struct Flood {
  std::vector<std::uint32_t> part_index;  // part of each triangle
  std::vector<bool> flipped;
  std::vector<bool> orientable;  // true for each part that can be oriented consistently
};

void flood_from(std::uint32_t seed, const std::vector<TriangleCorners>& triangles, const MeshEdges& edges,
                Flood& flood, std::vector<std::uint32_t>& reached) {
  const auto part = static_cast<std::uint32_t>(flood.orientable.size());
  flood.orientable.push_back(true);
  flood.part_index[seed] = part;
  reached.assign(1, seed);
  std::size_t flipped = 0;
  for (std::size_t at = 0; at < reached.size(); ++at) {
    const std::uint32_t triangle = reached[at];
    for (MeshSide side = 3 * triangle; side < 3 * triangle + 3; ++side) {
      const MeshSide other = edges.across(side);
      if (other == MeshEdges::open || other == MeshEdges::branching) continue;
      const bool same_direction = side_start(triangles, side) == side_start(triangles, other);
      const bool flip = flood.flipped[triangle] != same_direction;
      const std::uint32_t neighbour = other / 3;
      if (flood.part_index[neighbour] == no_part) {
        flood.part_index[neighbour] = part;
        flood.flipped[neighbour] = flip;
        flipped += flip ? 1 : 0;
        reached.push_back(neighbour);
      } else if (flood.flipped[neighbour] != flip) {
        flood.orientable[part] = false;
      }
    }
  }
  if (2 * flipped <= reached.size()) return;
  for (const std::uint32_t triangle : reached) flood.flipped[triangle] = !flood.flipped[triangle];
}

Flood flood_parts(const TriangleMesh& mesh) {
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  Flood flood{std::vector<std::uint32_t>(mesh.triangles.size(), no_part),
              std::vector<bool>(mesh.triangles.size(), false),
              {}};
  std::vector<std::uint32_t> reached;
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (flood.part_index[seed] == no_part) flood_from(seed, mesh.triangles, edges, flood, reached);
  }
  return flood;
}

// Returns the triangles sorted by part, in their original order within each part. Sets the range of triangles
// of each part.
std::vector<std::uint32_t> sort_by_part(const Flood& flood, std::vector<MeshPart>& parts) {
  for (const std::uint32_t part : flood.part_index) ++parts[part].end_triangle;
  std::uint32_t begin = 0;
  for (MeshPart& part : parts) {
    part.first_triangle = begin;
    begin += std::exchange(part.end_triangle, begin);
  }
  std::vector<std::uint32_t> order(flood.part_index.size());
  for (std::uint32_t triangle = 0; triangle < order.size(); ++triangle) {
    order[parts[flood.part_index[triangle]].end_triangle++] = triangle;
  }
  return order;
}

Box part_box(const TriangleMesh& mesh, const MeshPart& part) {
  Box box;
  for (std::uint32_t v = part.first_vertex; v < part.end_vertex; ++v) box.include(mesh.vertices_m[v]);
  return box;
}

bool encloses(const TriangleMesh& mesh, const MeshPart& part, const Vector3& point) {
  double angle = 0.0;
  for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    angle += solid_angle(mesh.vertices_m[a] - point, mesh.vertices_m[b] - point, mesh.vertices_m[c] - point);
  }
  return std::abs(angle) > 0.5 * full_solid_angle;
}

// Marks the cavities. Visits the closed parts from the largest to the smallest, so that a part is visited
// after the part that contains it.
void find_cavities(const TriangleMesh& mesh, std::vector<MeshPart>& parts,
                   const std::vector<double>& volumes) {
  std::vector<int> closed;
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    if (parts[p].closed) closed.push_back(p);
  }
  std::stable_sort(closed.begin(), closed.end(),
                   [&](int a, int b) { return std::abs(volumes[a]) > std::abs(volumes[b]); });
  // Closed parts that are not cavities: first those with inward normals, then those with outward normals.
  std::vector<std::pair<int, Box>> containers[2];
  std::size_t work = 0;
  for (const int p : closed) {
    const bool outward = volumes[p] > 0.0;
    const Box box = part_box(mesh, parts[p]);
    for (const auto& [container, around] : containers[outward ? 0 : 1]) {
      if (++work > cavity_work) return;
      if (!around.holds(box)) continue;
      work += parts[container].end_triangle - parts[container].first_triangle;
      if (encloses(mesh, parts[container], mesh.vertices_m[parts[p].first_vertex]))
        parts[p].cavity_of = container;
    }
    if (parts[p].cavity_of < 0) containers[outward ? 1 : 0].emplace_back(p, box);
  }
}

}  // namespace

MeshParts split_into_parts(const TriangleMesh& mesh) {
  Flood flood = flood_parts(mesh);
  MeshParts result;
  result.parts.resize(flood.orientable.size());
  const std::vector<std::uint32_t> order = sort_by_part(flood, result.parts);
  result.mesh.triangles.reserve(order.size());
  result.mesh.vertices_m.reserve(mesh.vertices_m.size());
  std::vector<std::uint32_t> copy(mesh.vertices_m.size(), no_part);
  for (MeshPart& part : result.parts) {
    part.first_vertex = static_cast<std::uint32_t>(result.mesh.vertices_m.size());
    for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
      TriangleCorners corners = mesh.triangles[order[t]];
      for (std::uint32_t& corner : corners) {
        std::uint32_t& own = copy[corner];
        // If the index is below the part's first vertex, the vertex was copied for an earlier part and needs
        // another copy.
        if (own == no_part || own < part.first_vertex) {
          own = static_cast<std::uint32_t>(result.mesh.vertices_m.size());
          result.mesh.vertices_m.push_back(mesh.vertices_m[corner]);
        }
        corner = own;
      }
      if (flood.flipped[order[t]]) {
        std::swap(corners[1], corners[2]);
        ++result.triangles_flipped;
      }
      result.mesh.triangles.push_back(corners);
    }
    part.end_vertex = static_cast<std::uint32_t>(result.mesh.vertices_m.size());
  }
  result.orientable = std::move(flood.orientable);
  return result;
}

std::size_t drop_specks(MeshParts& parts) {
  SPOONBILL_ASSERT(parts.orientable.size() == parts.parts.size());
  double closed = 0.0;
  for (const MeshPart& part : parts.parts) closed += part.closed ? part_area(parts.mesh, part) : 0.0;
  const auto is_speck = [&](const MeshPart& part) {
    return !part.closed && part_area(parts.mesh, part) < speck_area_fraction * closed;
  };
  if (std::none_of(parts.parts.begin(), parts.parts.end(), is_speck)) return 0;
  MeshParts remaining;
  remaining.triangles_flipped = parts.triangles_flipped;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    if (is_speck(parts.parts[p])) continue;
    remaining.parts.push_back(append_part(parts.mesh, parts.parts[p], remaining.mesh));
    remaining.orientable.push_back(parts.orientable[p]);
  }
  const std::size_t dropped = parts.parts.size() - remaining.parts.size();
  parts = std::move(remaining);
  return dropped;
}

double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

double part_area(const TriangleMesh& mesh, const MeshPart& part) {
  SPOONBILL_ASSERT(part.first_triangle <= part.end_triangle && part.end_triangle <= mesh.triangles.size());
  double sum = 0.0;
  for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    sum += triangle_area(mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]);
  }
  return sum;
}

MeshPart append_part(const TriangleMesh& from, const MeshPart& part, TriangleMesh& to) {
  SPOONBILL_ASSERT(part.first_vertex <= part.end_vertex && part.end_vertex <= from.vertices_m.size());
  SPOONBILL_ASSERT(part.first_triangle <= part.end_triangle && part.end_triangle <= from.triangles.size());
  MeshPart copied = part;
  copied.first_vertex = static_cast<std::uint32_t>(to.vertices_m.size());
  copied.first_triangle = static_cast<std::uint32_t>(to.triangles.size());
  to.vertices_m.insert(to.vertices_m.end(), from.vertices_m.begin() + part.first_vertex,
                       from.vertices_m.begin() + part.end_vertex);
  for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
    TriangleCorners corners = from.triangles[t];
    for (std::uint32_t& corner : corners) corner = corner - part.first_vertex + copied.first_vertex;
    to.triangles.push_back(corners);
  }
  copied.end_vertex = static_cast<std::uint32_t>(to.vertices_m.size());
  copied.end_triangle = static_cast<std::uint32_t>(to.triangles.size());
  return copied;
}

double signed_volume(const TriangleMesh& mesh, const MeshPart& part) {
  SPOONBILL_ASSERT(part.first_triangle <= part.end_triangle && part.end_triangle <= mesh.triangles.size());
  // Coordinates are relative to one of the part's own vertices, so that small parts far from the origin lose
  // no precision.
  const Vector3 origin = mesh.vertices_m[part.first_vertex];
  double six_volumes = 0.0;
  for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vector3 to_a = mesh.vertices_m[a] - origin, to_b = mesh.vertices_m[b] - origin;
    six_volumes += to_a.cross(to_b).dot(mesh.vertices_m[c] - origin);
  }
  return six_volumes / 6.0;
}

void orient_outward(TriangleMesh& mesh, std::vector<MeshPart>& parts, MeshReport& report) {
  std::vector<double> volumes(parts.size(), 0.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].closed) volumes[p] = signed_volume(mesh, parts[p]);
  }
  find_cavities(mesh, parts, volumes);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const MeshPart& part = parts[p];
    const bool cavity = part.cavity_of >= 0;
    (!part.closed ? report.sheets : cavity ? report.cavities : report.closed_parts) += 1;
    if (!part.closed || (volumes[p] < 0.0) == cavity) continue;
    for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
    ++report.parts_flipped;
  }
}

namespace {

// Vertices of a boundary loop, in the order in which the adjacent triangles pass through them. The triangles
// that fill the hole pass through them in the opposite order.
using VertexLoop = std::vector<std::uint32_t>;

// Divides the boundary sides into simple loops, which visit no vertex twice. Parts have no vertex in common,
// so each loop belongs to one part.
class BoundaryWalk {
 public:
  BoundaryWalk(const TriangleMesh& mesh, const std::vector<MeshSide>& boundary)
      : mesh_(mesh),
        first_(mesh.vertices_m.size(), no_part),
        next_(boundary.size(), no_part),
        position_(mesh.vertices_m.size(), no_part),
        boundary_(boundary) {
    for (std::uint32_t k = 0; k < boundary.size(); ++k) {
      std::uint32_t& first = first_[side_start(mesh.triangles, boundary[k])];
      next_[k] = std::exchange(first, k);
    }
  }

  // Calls visit(loop) for each loop. A chain of sides that does not close is discarded; in a consistently
  // oriented mesh every chain closes.
  template <class Visit>
  void walk(const Visit& visit) {
    for (const MeshSide side : boundary_) {
      std::uint32_t vertex = side_start(mesh_.triangles, side);
      while (first_[vertex] != no_part) {
        const MeshSide leaving = boundary_[std::exchange(first_[vertex], next_[first_[vertex]])];
        position_[vertex] = static_cast<std::uint32_t>(path_.size());
        path_.push_back(vertex);
        vertex = side_end(mesh_.triangles, leaving);
        if (position_[vertex] != no_part) cut_at(vertex, visit);
      }
      for (const std::uint32_t left : path_) position_[left] = no_part;
      path_.clear();
    }
  }

 private:
  template <class Visit>
  void cut_at(std::uint32_t vertex, const Visit& visit) {
    const VertexLoop loop(path_.begin() + position_[vertex], path_.end());
    for (const std::uint32_t vertex_in_loop : loop) position_[vertex_in_loop] = no_part;
    path_.resize(path_.size() - loop.size());
    visit(loop);
  }

  const TriangleMesh& mesh_;
  // For each vertex, a linked list of the unused sides that leave it, as indices into boundary_.
  std::vector<std::uint32_t> first_, next_;
  std::vector<std::uint32_t> position_;  // position of each vertex in path_, if it is there
  const std::vector<MeshSide>& boundary_;
  std::vector<std::uint32_t> path_;
};

Vector3 loop_centre(const TriangleMesh& mesh, const VertexLoop& loop) {
  Vector3 sum = Vector3::Zero();
  double length = 0.0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vector3& a = mesh.vertices_m[loop[k]];
    const Vector3& b = mesh.vertices_m[loop[(k + 1) % loop.size()]];
    sum += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  return sum / length;
}

double fan_area(const TriangleMesh& mesh, const VertexLoop& loop) {
  const Vector3 centre = loop_centre(mesh, loop);
  double sum = 0.0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    sum += triangle_area(mesh.vertices_m[loop[k]], mesh.vertices_m[loop[(k + 1) % loop.size()]], centre);
  }
  return sum;
}

struct Openings {
  std::vector<VertexLoop> loops;
  double area_m2 = 0.0;
};

// Returns true for a crack: a hole so narrow that the triangles filling it would have no normal.
bool is_crack(const TriangleMesh& mesh, const VertexLoop& loop) {
  double longest = 0.0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    longest = std::max(longest, (mesh.vertices_m[loop[k]] - mesh.vertices_m[loop[0]]).norm());
  }
  return fan_area(mesh, loop) <= vertex_joining_fraction * longest * longest;
}

void add_fan(TriangleMesh& mesh, const VertexLoop& loop) {
  if (loop.size() == 3) {
    mesh.triangles.push_back({loop[0], loop[2], loop[1]});
    return;
  }
  const auto centre = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.push_back(loop_centre(mesh, loop));
  for (std::size_t k = 0; k < loop.size(); ++k) {
    mesh.triangles.push_back({loop[(k + 1) % loop.size()], loop[k], centre});
  }
}

std::size_t find_part_of_vertex(const std::vector<MeshPart>& parts, std::uint32_t vertex) {
  const auto after = std::upper_bound(parts.begin(), parts.end(), vertex,
                                      [](std::uint32_t v, const MeshPart& p) { return v < p.first_vertex; });
  return static_cast<std::size_t>(after - parts.begin()) - 1;
}

std::vector<Openings> find_openings(MeshParts& parts) {
  const TriangleMesh& mesh = parts.mesh;
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  // An edge of three or more triangles in the whole mesh may have only two triangles in one part. These two
  // need not be oriented consistently, because split_into_parts() did not compare them.
  for (MeshSide side = 0; side < 3 * mesh.triangles.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other == MeshEdges::open || other == MeshEdges::branching) continue;
    const std::uint32_t start = side_start(mesh.triangles, side);
    if (start == side_start(mesh.triangles, other)) {
      parts.orientable[find_part_of_vertex(parts.parts, start)] = false;
    }
  }
  std::vector<Openings> openings(parts.parts.size());
  BoundaryWalk(mesh, edges.boundary()).walk([&](const VertexLoop& loop) {
    Openings& own = openings[find_part_of_vertex(parts.parts, loop[0])];
    own.area_m2 += fan_area(mesh, loop);
    own.loops.push_back(loop);
  });
  return openings;
}

}  // namespace

std::size_t fill_small_holes(MeshParts& parts) {
  SPOONBILL_ASSERT(parts.orientable.size() == parts.parts.size());
  std::vector<Openings> openings = find_openings(parts);
  std::size_t filled = 0, cracks = 0;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    MeshPart& part = parts.parts[p];
    std::vector<VertexLoop>& loops = openings[p].loops;
    part.closed = parts.orientable[p] &&
                  (loops.empty() || openings[p].area_m2 <= hole_area_fraction * part_area(parts.mesh, part));
    if (!part.closed) loops.clear();
    cracks += loops.size();
    std::erase_if(loops, [&](const VertexLoop& loop) { return is_crack(parts.mesh, loop); });
    cracks -= loops.size();
    filled += loops.size();
  }
  if (filled == 0) return cracks;

  TriangleMesh whole;
  whole.vertices_m.reserve(parts.mesh.vertices_m.size() + filled);
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    MeshPart& part = parts.parts[p];
    const std::uint32_t before = part.first_vertex;
    part = append_part(parts.mesh, part, whole);
    for (VertexLoop& loop : openings[p].loops) {
      for (std::uint32_t& vertex : loop) vertex = vertex - before + part.first_vertex;
      add_fan(whole, loop);
    }
    part.end_vertex = static_cast<std::uint32_t>(whole.vertices_m.size());
    part.end_triangle = static_cast<std::uint32_t>(whole.triangles.size());
  }
  parts.mesh = std::move(whole);
  return filled + cracks;
}

}  // namespace spoonbill
