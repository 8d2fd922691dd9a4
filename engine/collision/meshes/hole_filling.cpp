#include "engine/collision/meshes/hole_filling.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_edges.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t none = 0xffffffffU;

// Vertices in the order in which the triangles beside the hole go; the hole's own go the other way.
using BoundaryLoop = std::vector<std::uint32_t>;

// Cuts the sides of a boundary into rims that meet no vertex twice. Sides of different parts have no vertex
// in common, so every rim belongs to one part.
class RimWalk {
 public:
  RimWalk(const TriangleMesh& mesh, const std::vector<MeshSide>& boundary)
      : mesh_(mesh),
        first_(mesh.vertices_m.size(), none),
        next_(boundary.size(), none),
        place_(mesh.vertices_m.size(), none),
        boundary_(boundary) {
    for (std::uint32_t k = 0; k < boundary.size(); ++k) {
      std::uint32_t& first = first_[start_of(mesh.triangles, boundary[k])];
      next_[k] = std::exchange(first, k);
    }
  }

  // Calls take(rim) for each. Stops short where sides do not come round, which those of triangles that agree
  // always do.
  template <class Take>
  void walk(const Take& take) {
    for (const MeshSide side : boundary_) {
      std::uint32_t vertex = start_of(mesh_.triangles, side);
      while (first_[vertex] != none) {
        const MeshSide leaving = boundary_[std::exchange(first_[vertex], next_[first_[vertex]])];
        place_[vertex] = static_cast<std::uint32_t>(path_.size());
        path_.push_back(vertex);
        vertex = end_of(mesh_.triangles, leaving);
        if (place_[vertex] != none) cut_at(vertex, take);
      }
      for (const std::uint32_t left : path_) place_[left] = none;
      path_.clear();
    }
  }

 private:
  template <class Take>
  void cut_at(std::uint32_t vertex, const Take& take) {
    const BoundaryLoop rim(path_.begin() + place_[vertex], path_.end());
    for (const std::uint32_t passed : rim) place_[passed] = none;
    path_.resize(path_.size() - rim.size());
    take(rim);
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> first_, next_;  // the unused sides that leave a vertex, into boundary_
  std::vector<std::uint32_t> place_;         // of a vertex in the path
  const std::vector<MeshSide>& boundary_;
  std::vector<std::uint32_t> path_;
};

Vector3 middle(const TriangleMesh& mesh, const BoundaryLoop& rim) {
  Vector3 sum = Vector3::Zero();
  double length = 0.0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const Vector3& a = mesh.vertices_m[rim[k]];
    const Vector3& b = mesh.vertices_m[rim[(k + 1) % rim.size()]];
    sum += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  return sum / length;
}

double fan_area(const TriangleMesh& mesh, const BoundaryLoop& rim) {
  const Vector3 centre = middle(mesh, rim);
  double sum = 0.0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    sum += triangle_area(mesh.vertices_m[rim[k]], mesh.vertices_m[rim[(k + 1) % rim.size()]], centre);
  }
  return sum;
}

struct Openings {
  std::vector<BoundaryLoop> rims;
  double area_m2 = 0.0;
};

// A crack's own triangles would have no normal.
bool is_crack(const TriangleMesh& mesh, const BoundaryLoop& rim) {
  double longest = 0.0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    longest = std::max(longest, (mesh.vertices_m[rim[k]] - mesh.vertices_m[rim[0]]).norm());
  }
  return fan_area(mesh, rim) <= vertex_joining_share * longest * longest;
}

void add_fan(TriangleMesh& mesh, const BoundaryLoop& rim) {
  if (rim.size() == 3) {
    mesh.triangles.push_back({rim[0], rim[2], rim[1]});
    return;
  }
  const auto centre = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.push_back(middle(mesh, rim));
  for (std::size_t k = 0; k < rim.size(); ++k) {
    mesh.triangles.push_back({rim[(k + 1) % rim.size()], rim[k], centre});
  }
}

std::size_t part_of_vertex(const std::vector<MeshPart>& parts, std::uint32_t vertex) {
  const auto after = std::upper_bound(parts.begin(), parts.end(), vertex,
                                      [](std::uint32_t v, const MeshPart& p) { return v < p.first_vertex; });
  return static_cast<std::size_t>(after - parts.begin()) - 1;
}

std::vector<Openings> find_openings(MeshParts& parts) {
  const TriangleMesh& mesh = parts.mesh;
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  // Two of the triangles on an edge where others branch off may have stayed in one part without agreeing.
  for (MeshSide side = 0; side < 3 * mesh.triangles.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other == MeshEdges::open || other == MeshEdges::branching) continue;
    const std::uint32_t start = start_of(mesh.triangles, side);
    if (start == start_of(mesh.triangles, other)) {
      parts.orientable[part_of_vertex(parts.parts, start)] = false;
    }
  }
  std::vector<Openings> openings(parts.parts.size());
  RimWalk(mesh, edges.boundary()).walk([&](const BoundaryLoop& rim) {
    Openings& mine = openings[part_of_vertex(parts.parts, rim[0])];
    mine.area_m2 += fan_area(mesh, rim);
    mine.rims.push_back(rim);
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
    std::vector<BoundaryLoop>& rims = openings[p].rims;
    part.closed = parts.orientable[p] &&
                  (rims.empty() || openings[p].area_m2 <= hole_share * area_of(parts.mesh, part));
    if (!part.closed) rims.clear();
    cracks += rims.size();
    std::erase_if(rims, [&](const BoundaryLoop& rim) { return is_crack(parts.mesh, rim); });
    cracks -= rims.size();
    filled += rims.size();
  }
  if (filled == 0) return cracks;

  TriangleMesh whole;
  whole.vertices_m.reserve(parts.mesh.vertices_m.size() + filled);
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    MeshPart& part = parts.parts[p];
    const std::uint32_t before = part.first_vertex;
    part = append_part(parts.mesh, part, whole);
    for (BoundaryLoop& rim : openings[p].rims) {
      for (std::uint32_t& vertex : rim) vertex = vertex - before + part.first_vertex;
      add_fan(whole, rim);
    }
    part.end_vertex = static_cast<std::uint32_t>(whole.vertices_m.size());
    part.end_triangle = static_cast<std::uint32_t>(whole.triangles.size());
  }
  parts.mesh = std::move(whole);
  return filled + cracks;
}

}  // namespace spoonbill
