#include "engine/collision/meshes/mesh_edges.h"

#include <algorithm>
#include <cstdlib>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

struct SideAtVertex {
  std::uint32_t other;  // the higher vertex
  MeshSide side;
  friend bool operator<(const SideAtVertex& a, const SideAtVertex& b) {
    return a.other != b.other ? a.other < b.other : a.side < b.side;
  }
};

// Each side at its lower vertex, those of one vertex beside each other: `first` says where they begin.
std::vector<SideAtVertex> sides_by_vertex(const std::vector<TriangleCorners>& triangles,
                                          std::vector<std::uint32_t>& first) {
  const auto count = static_cast<MeshSide>(3 * triangles.size());
  const auto lower = [&](MeshSide side) {
    return std::min(start_of(triangles, side), end_of(triangles, side));
  };
  for (MeshSide side = 0; side < count; ++side) ++first[lower(side) + 1];
  for (std::size_t vertex = 1; vertex < first.size(); ++vertex) first[vertex] += first[vertex - 1];
  std::vector<SideAtVertex> sides(count);
  std::vector<std::uint32_t> place(first.begin(), first.end() - 1);
  for (MeshSide side = 0; side < count; ++side) {
    const std::uint32_t higher = std::max(start_of(triangles, side), end_of(triangles, side));
    sides[place[lower(side)]++] = {higher, side};
  }
  return sides;
}

}  // namespace

MeshEdges::MeshEdges(const std::vector<TriangleCorners>& triangles, std::size_t vertices) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(triangles.begin(), triangles.end(), [&](const TriangleCorners& t) {
    return t[0] < vertices && t[1] < vertices && t[2] < vertices && t[0] != t[1] && t[1] != t[2] &&
           t[2] != t[0];
  }));
  std::vector<std::uint32_t> first(vertices + 1, 0);
  std::vector<SideAtVertex> sides = sides_by_vertex(triangles, first);
  across_.assign(sides.size(), open);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto begin = sides.begin() + first[vertex], end = sides.begin() + first[vertex + 1];
    std::sort(begin, end);
    for (auto edge = begin; edge != end;) {
      const auto next =
          std::find_if(edge, end, [&](const SideAtVertex& at) { return at.other != edge->other; });
      if (next - edge == 1) {
        ++open_count_;
        boundary_.push_back(edge->side);
      } else if (next - edge == 2) {
        across_[edge[0].side] = edge[1].side;
        across_[edge[1].side] = edge[0].side;
      } else {
        ++branching_count_;
        std::ptrdiff_t upward = 0;
        for (auto at = edge; at != next; ++at) {
          across_[at->side] = branching;
          upward += start_of(triangles, at->side) == vertex ? 1 : -1;
        }
        std::ptrdiff_t more = std::abs(upward);
        for (auto at = edge; at != next && more > 0; ++at) {
          if ((start_of(triangles, at->side) == vertex) != (upward > 0)) continue;
          boundary_.push_back(at->side);
          --more;
        }
      }
      edge = next;
    }
  }
}

}  // namespace spoonbill
