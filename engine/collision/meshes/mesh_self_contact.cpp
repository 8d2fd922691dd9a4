#include "engine/collision/meshes/mesh_self_contact.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

constexpr double left_out = 1e-6;
constexpr std::size_t pairs_a_triangle = 200;

bool overlap(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

Triangle shrunk(const Triangle& triangle) {
  const Vector3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  Triangle smaller = triangle;
  for (Vector3& corner : smaller) corner += left_out * (middle - corner);
  return smaller;
}

Box box_of(const Triangle& t) {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}

bool have_common_corner(const TriangleCorners& a, const TriangleCorners& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](std::uint32_t corner) { return std::find(b.begin(), b.end(), corner) != b.end(); });
}

class SelfContact {
 public:
  SelfContact(const std::vector<Vector3>& vertices, const std::vector<TriangleCorners>& triangles,
              const BoxTree& tree)
      : vertices_(vertices),
        triangles_(triangles),
        tree_(tree),
        pairs_left_(pairs_a_triangle * triangles.size()) {}

  bool found() {
    waiting_.assign(1, {0, 0});
    while (!waiting_.empty()) {
      const auto [a, b] = waiting_.back();
      waiting_.pop_back();
      const BoxTree::Node &first = tree_.nodes()[a], &second = tree_.nodes()[b];
      if (a != b && !overlap(first.box, second.box)) continue;
      if (first.is_leaf() && second.is_leaf()) {
        if (leaves_meet(first, second)) return true;
      } else if (a == b) {
        waiting_.insert(waiting_.end(), {{a + 1, a + 1}, {first.first, first.first}, {a + 1, first.first}});
      } else if (second.is_leaf() || (!first.is_leaf() && first.box.size() > second.box.size())) {
        waiting_.insert(waiting_.end(), {{a + 1, b}, {first.first, b}});
      } else {
        waiting_.insert(waiting_.end(), {{a, b + 1}, {a, second.first}});
      }
    }
    return false;
  }

 private:
  Triangle triangle(std::uint32_t index) const {
    const auto& [a, b, c] = triangles_[index];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }

  bool leaves_meet(const BoxTree::Node& first, const BoxTree::Node& second) {
    for (std::uint32_t s = first.first; s < first.first + first.count; ++s) {
      const Triangle a = triangle(s);
      const Box around = box_of(a);
      for (std::uint32_t t = std::max(second.first, &first == &second ? s + 1 : 0U);
           t < second.first + second.count; ++t) {
        if (pairs_left_-- == 0) return true;
        const Triangle b = triangle(t);
        if (!overlap(around, box_of(b))) continue;
        const bool neighbours = have_common_corner(triangles_[s], triangles_[t]);
        if (neighbours ? triangles_meet(shrunk(a), shrunk(b)) : triangles_meet(a, b)) return true;
      }
    }
    return false;
  }

  const std::vector<Vector3>& vertices_;
  const std::vector<TriangleCorners>& triangles_;
  const BoxTree& tree_;
  std::size_t pairs_left_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting_;
};

}  // namespace

bool meets_itself(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                  const BoxTree& tree) {
  return SelfContact(vertices_m, triangles, tree).found();
}

}  // namespace spoonbill
