#include "engine/collision/meshes/mesh_self_contact.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

constexpr double left_out = 1e-6;
constexpr std::size_t pairs_a_triangle = 200;
constexpr std::size_t looks_between_stops = 4096;

Triangle shrunk(const Triangle& triangle) {
  const Vector3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  Triangle smaller = triangle;
  for (Vector3& corner : smaller) corner += left_out * (middle - corner);
  return smaller;
}

bool have_common_corner(const TriangleCorners& a, const TriangleCorners& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](std::uint32_t corner) { return std::find(b.begin(), b.end(), corner) != b.end(); });
}

double reach_through_plane(const Triangle& triangle, const Triangle& plane) {
  const Vector3 normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]).stableNormalized();
  const auto [low, high] =
      std::minmax({normal.dot(triangle[0] - plane[0]), normal.dot(triangle[1] - plane[0]),
                   normal.dot(triangle[2] - plane[0])});
  return std::max(0.0, std::min(high, -low));
}

class SelfContact {
 public:
  SelfContact(const std::vector<Vector3>& vertices, const std::vector<TriangleCorners>& triangles,
              const BoxTree& tree, std::size_t most)
      : vertices_(vertices),
        triangles_(triangles),
        tree_(tree),
        pairs_left_(pairs_a_triangle * triangles.size()),
        most_(most) {}

  MeshMeetings meetings(const Progress& progress) {
    waiting_.assign(1, {0, 0});
    for (std::size_t looks = 1; !waiting_.empty() && meetings_.complete; ++looks) {
      if (looks % looks_between_stops == 0 && !progress.report(0.0)) meetings_.complete = false;
      const auto [a, b] = waiting_.back();
      waiting_.pop_back();
      const BoxTree::Node &first = tree_.nodes()[a], &second = tree_.nodes()[b];
      if (a != b && !first.box.overlaps(second.box)) continue;
      if (first.is_leaf() && second.is_leaf()) {
        meet(first, second);
      } else if (a == b) {
        waiting_.insert(waiting_.end(), {{a + 1, a + 1}, {first.first, first.first}, {a + 1, first.first}});
      } else if (second.is_leaf() || (!first.is_leaf() && first.box.size() > second.box.size())) {
        waiting_.insert(waiting_.end(), {{a + 1, b}, {first.first, b}});
      } else {
        waiting_.insert(waiting_.end(), {{a, b + 1}, {a, second.first}});
      }
    }
    return std::move(meetings_);
  }

 private:
  Triangle triangle(std::uint32_t index) const {
    const auto& [a, b, c] = triangles_[index];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }

  void meet(const BoxTree::Node& first, const BoxTree::Node& second) {
    for (std::uint32_t s = first.first; s < first.first + first.count; ++s) {
      const Triangle a = triangle(s);
      const Box around = bounding_box(a);
      for (std::uint32_t t = std::max(second.first, &first == &second ? s + 1 : 0U);
           t < second.first + second.count; ++t) {
        if (pairs_left_-- == 0) {
          meetings_.complete = false;
          return;
        }
        const Triangle b = triangle(t);
        if (!around.overlaps(bounding_box(b))) continue;
        const bool neighbours = have_common_corner(triangles_[s], triangles_[t]);
        if (!(neighbours ? triangles_meet(shrunk(a), shrunk(b)) : triangles_meet(a, b))) continue;
        if (meetings_.found.size() == most_) {
          meetings_.complete = false;
          return;
        }
        meetings_.found.push_back({s, t, std::min(reach_through_plane(a, b), reach_through_plane(b, a))});
      }
    }
  }

  const std::vector<Vector3>& vertices_;
  const std::vector<TriangleCorners>& triangles_;
  const BoxTree& tree_;
  std::size_t pairs_left_, most_;
  MeshMeetings meetings_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting_;
};

}  // namespace

MeshMeetings self_meetings(const std::vector<Vector3>& vertices_m,
                           const std::vector<TriangleCorners>& triangles, const BoxTree& tree,
                           std::size_t most, const Progress& progress) {
  SPOONBILL_ASSERT(tree.order().size() == triangles.size());
  return SelfContact(vertices_m, triangles, tree, most).meetings(progress);
}

bool meets_itself(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                  const BoxTree& tree) {
  return !self_meetings(vertices_m, triangles, tree, 0).complete;
}

}  // namespace spoonbill
