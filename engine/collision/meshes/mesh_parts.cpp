#include "engine/collision/meshes/mesh_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/solid_angle.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t none = 0xffffffffU;
// Triangles looked at for cavities: a file of countless specks is read in bounded time.
constexpr std::size_t cavity_work = 50'000'000;

struct Flood {
  std::vector<std::uint32_t> part_of;  // of each triangle
  std::vector<bool> turned;
  std::vector<bool> orientable;  // of each part
};

void flood_from(std::uint32_t seed, const std::vector<TriangleCorners>& triangles, const MeshEdges& edges,
                Flood& flood, std::vector<std::uint32_t>& reached) {
  const auto part = static_cast<std::uint32_t>(flood.orientable.size());
  flood.orientable.push_back(true);
  flood.part_of[seed] = part;
  reached.assign(1, seed);
  std::size_t turned = 0;
  for (std::size_t at = 0; at < reached.size(); ++at) {
    const std::uint32_t triangle = reached[at];
    for (MeshSide side = 3 * triangle; side < 3 * triangle + 3; ++side) {
      const MeshSide other = edges.across(side);
      if (other == MeshEdges::open || other == MeshEdges::branching) continue;
      const bool same_way = start_of(triangles, side) == start_of(triangles, other);
      const bool turn = flood.turned[triangle] != same_way;
      const std::uint32_t neighbour = other / 3;
      if (flood.part_of[neighbour] == none) {
        flood.part_of[neighbour] = part;
        flood.turned[neighbour] = turn;
        turned += turn ? 1 : 0;
        reached.push_back(neighbour);
      } else if (flood.turned[neighbour] != turn) {
        flood.orientable[part] = false;
      }
    }
  }
  if (2 * turned <= reached.size()) return;
  for (const std::uint32_t triangle : reached) flood.turned[triangle] = !flood.turned[triangle];
}

Flood flood_parts(const TriangleMesh& mesh) {
  const MeshEdges edges(mesh.triangles, mesh.vertices_m.size());
  Flood flood{std::vector<std::uint32_t>(mesh.triangles.size(), none),
              std::vector<bool>(mesh.triangles.size(), false),
              {}};
  std::vector<std::uint32_t> reached;
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (flood.part_of[seed] == none) flood_from(seed, mesh.triangles, edges, flood, reached);
  }
  return flood;
}

// The triangles by part, each part's in their order.
std::vector<std::uint32_t> by_part(const Flood& flood, std::vector<MeshPart>& parts) {
  for (const std::uint32_t part : flood.part_of) ++parts[part].end_triangle;
  std::uint32_t begin = 0;
  for (MeshPart& part : parts) {
    part.first_triangle = begin;
    begin += std::exchange(part.end_triangle, begin);
  }
  std::vector<std::uint32_t> order(flood.part_of.size());
  for (std::uint32_t triangle = 0; triangle < order.size(); ++triangle) {
    order[parts[flood.part_of[triangle]].end_triangle++] = triangle;
  }
  return order;
}

Box box_of_part(const TriangleMesh& mesh, const MeshPart& part) {
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

// From the largest part to the smallest, so that what could hold a part is known before it.
void find_cavities(const TriangleMesh& mesh, std::vector<MeshPart>& parts,
                   const std::vector<double>& volumes) {
  std::vector<int> closed;
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    if (parts[p].closed) closed.push_back(p);
  }
  std::stable_sort(closed.begin(), closed.end(),
                   [&](int a, int b) { return std::abs(volumes[a]) > std::abs(volumes[b]); });
  std::vector<std::pair<int, Box>> holders[2];  // solids facing inward, outward
  std::size_t work = 0;
  for (const int p : closed) {
    const bool outward = volumes[p] > 0.0;
    const Box box = box_of_part(mesh, parts[p]);
    for (const auto& [holder, around] : holders[outward ? 0 : 1]) {
      if (++work > cavity_work) return;
      if (!around.holds(box)) continue;
      work += parts[holder].end_triangle - parts[holder].first_triangle;
      if (encloses(mesh, parts[holder], mesh.vertices_m[parts[p].first_vertex])) parts[p].cavity_of = holder;
    }
    if (parts[p].cavity_of < 0) holders[outward ? 1 : 0].emplace_back(p, box);
  }
}

}  // namespace

MeshParts split_into_parts(const TriangleMesh& mesh) {
  Flood flood = flood_parts(mesh);
  MeshParts result;
  result.parts.resize(flood.orientable.size());
  const std::vector<std::uint32_t> order = by_part(flood, result.parts);
  result.mesh.triangles.reserve(order.size());
  result.mesh.vertices_m.reserve(mesh.vertices_m.size());
  std::vector<std::uint32_t> copy(mesh.vertices_m.size(), none);
  for (MeshPart& part : result.parts) {
    part.first_vertex = static_cast<std::uint32_t>(result.mesh.vertices_m.size());
    for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
      TriangleCorners corners = mesh.triangles[order[t]];
      for (std::uint32_t& corner : corners) {
        std::uint32_t& mine = copy[corner];
        // A copy below the part's first vertex is another part's.
        if (mine == none || mine < part.first_vertex) {
          mine = static_cast<std::uint32_t>(result.mesh.vertices_m.size());
          result.mesh.vertices_m.push_back(mesh.vertices_m[corner]);
        }
        corner = mine;
      }
      if (flood.turned[order[t]]) {
        std::swap(corners[1], corners[2]);
        ++result.triangles_turned;
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
  for (const MeshPart& part : parts.parts) closed += part.closed ? area_of(parts.mesh, part) : 0.0;
  const auto is_speck = [&](const MeshPart& part) {
    return !part.closed && area_of(parts.mesh, part) < speck_share * closed;
  };
  if (std::none_of(parts.parts.begin(), parts.parts.end(), is_speck)) return 0;
  MeshParts kept;
  kept.triangles_turned = parts.triangles_turned;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    if (is_speck(parts.parts[p])) continue;
    kept.parts.push_back(append_part(parts.mesh, parts.parts[p], kept.mesh));
    kept.orientable.push_back(parts.orientable[p]);
  }
  const std::size_t dropped = parts.parts.size() - kept.parts.size();
  parts = std::move(kept);
  return dropped;
}

double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

double area_of(const TriangleMesh& mesh, const MeshPart& part) {
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
  // About one of its own vertices, so that a small part far away loses no digits.
  const Vector3 origin = mesh.vertices_m[part.first_vertex];
  double six_volumes = 0.0;
  for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vector3 to_a = mesh.vertices_m[a] - origin, to_b = mesh.vertices_m[b] - origin;
    six_volumes += to_a.cross(to_b).dot(mesh.vertices_m[c] - origin);
  }
  return six_volumes / 6.0;
}

void turn_outward(TriangleMesh& mesh, std::vector<MeshPart>& parts, MeshReport& report) {
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
    ++report.parts_turned;
  }
}

}  // namespace spoonbill
