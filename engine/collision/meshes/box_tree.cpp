#include "engine/collision/meshes/box_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {

namespace {

struct Item {
  std::array<float, 3> centre;
  std::uint32_t index;
};

// A range of items for which a node must still be made. `right_of` is the parent's index if the node is a
// right child, otherwise `none`.
struct PendingNode {
  std::uint32_t begin, end;
  std::uint32_t right_of;
};

constexpr std::uint32_t none = 0xffffffffU;

std::vector<Item> make_items(const std::vector<Box>& boxes) {
  std::vector<Item> items(boxes.size());
  for (std::uint32_t k = 0; k < items.size(); ++k) {
    const Eigen::Vector3f centre = (0.5 * (boxes[k].low + boxes[k].high)).cast<float>();
    items[k] = {{centre.x(), centre.y(), centre.z()}, k};
  }
  return items;
}

int longest_axis(const std::vector<Item>& items, const PendingNode& range) {
  std::array<float, 3> low = items[range.begin].centre, high = low;
  for (std::uint32_t k = range.begin; k < range.end; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], items[k].centre[axis]);
      high[axis] = std::max(high[axis], items[k].centre[axis]);
    }
  }
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  }
  return longest;
}

void halve(std::vector<Item>& items, const PendingNode& range, std::uint32_t median) {
  const int axis = longest_axis(items, range);
  std::nth_element(items.begin() + range.begin, items.begin() + median, items.begin() + range.end,
                   [axis](const Item& a, const Item& b) {
                     return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis]
                                                             : a.index < b.index;
                   });
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes, std::uint32_t leaf_size) {
  SPOONBILL_ASSERT(!boxes.empty() && leaf_size >= 1);
  SPOONBILL_ASSERT_DEBUG(std::all_of(boxes.begin(), boxes.end(), [](const Box& box) {
    return (box.low.array() <= box.high.array()).all();
  }));
  std::vector<Item> items = make_items(boxes);
  std::vector<PendingNode> pending = {{0, static_cast<std::uint32_t>(items.size()), none}};
  while (!pending.empty()) {
    const PendingNode range = pending.back();
    pending.pop_back();
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    if (range.right_of != none) nodes_[range.right_of].first = index;
    const std::uint32_t count = range.end - range.begin;
    const Box empty{Vector3::Zero(), Vector3::Zero()};
    nodes_.push_back({empty, range.begin, count <= leaf_size ? count : 0});
    if (count <= leaf_size) continue;
    const std::uint32_t median = range.begin + count / 2;
    halve(items, range, median);
    pending.push_back({median, range.end, index});
    pending.push_back({range.begin, median, none});
  }
  order_.reserve(items.size());
  for (const Item& item : items) order_.push_back(item.index);
  refit([&](std::uint32_t position) { return boxes[order_[position]]; });
}

namespace {

// Smallest cosine of the angle between the outward normal and a line that counts as passing through a wall.
// The angle is 50 degrees. At the common edge angles of 45 and 60 degrees, rounding therefore cannot change
// the result.
constexpr double wall_cosine = 0.6428;

// Returns true if a ray hits a box, by the slab method (Kay and Kajiya 1986).
bool ray_hits_box(const Box& box, const Vector3& from, const Vector3& direction, double farthest) {
  double near = 0.0, far = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (from[axis] < box.low[axis] || from[axis] > box.high[axis]) return false;
      continue;
    }
    double enter = (box.low[axis] - from[axis]) / direction[axis];
    double leave = (box.high[axis] - from[axis]) / direction[axis];
    if (enter > leave) std::swap(enter, leave);
    near = std::max(near, enter);
    far = std::min(far, leave);
  }
  return near <= far;
}

}  // namespace

LineExits::LineExits(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::vector<Box> boxes;
  boxes.reserve(triangles_.size());
  for (const Triangle& triangle : triangles_) boxes.push_back(bounding_box(triangle));
  tree_ = std::make_unique<BoxTree>(boxes, triangle_leaf_size);
}

std::optional<LineExit> LineExits::first(const Vector3& from, const Vector3& direction) const {
  SPOONBILL_ASSERT_DEBUG(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  std::optional<LineExit> first;
  const auto farthest = [&] { return first ? first->distance_m : std::numeric_limits<double>::infinity(); };
  const auto descend = [&](std::uint32_t index) {
    return ray_hits_box(tree_->nodes()[index].box, from, direction, farthest());
  };
  const auto test_triangle = [&](std::uint32_t position) {
    const Triangle& triangle = triangles_[position];
    // Tolerance of the intersection, as a fraction of the triangle's sides. It ensures that a line through an
    // edge hits at least one of the two triangles at the edge.
    constexpr double tolerance = 1e-6;
    const auto hit =
        intersect_line_triangle(from, direction, triangle[0], triangle[1], triangle[2], tolerance);
    if (!hit || !(hit->facing < 0.0) || !(hit->along > 0.0) || !(hit->along < farthest())) return;
    first = LineExit{hit->along, position, hit->to_b, hit->to_c};
  };
  tree_->search(
      descend, [](std::uint32_t, std::uint32_t) { return false; },
      [&](std::uint32_t start, std::uint32_t count) {
        for (std::uint32_t k = 0; k < count; ++k) test_triangle(tree_->order()[start + k]);
      });
  return first;
}

bool exits_through_wall(const Triangle& triangle, const Vector3& direction) {
  SPOONBILL_ASSERT_DEBUG(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  const Vector3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  return normal.dot(direction) >= wall_cosine * normal.norm() * direction.norm();
}

namespace {

constexpr double corner_shrink = 1e-6;
constexpr std::size_t pairs_per_triangle = 200;
constexpr std::size_t steps_between_reports = 4096;

Triangle shrink_to_centroid(const Triangle& triangle) {
  const Vector3 centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  Triangle smaller = triangle;
  for (Vector3& corner : smaller) corner += corner_shrink * (centroid - corner);
  return smaller;
}

bool has_common_corner(const TriangleCorners& a, const TriangleCorners& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](std::uint32_t corner) { return std::find(b.begin(), b.end(), corner) != b.end(); });
}

double penetration_through_plane(const Triangle& triangle, const Triangle& plane) {
  const Vector3 normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]).stableNormalized();
  const auto [low, high] =
      std::minmax({normal.dot(triangle[0] - plane[0]), normal.dot(triangle[1] - plane[0]),
                   normal.dot(triangle[2] - plane[0])});
  return std::max(0.0, std::min(high, -low));
}

class SelfIntersectionSearch {
 public:
  SelfIntersectionSearch(const std::vector<Vector3>& vertices, const std::vector<TriangleCorners>& triangles,
                         const BoxTree& tree, std::size_t limit)
      : vertices_(vertices),
        triangles_(triangles),
        tree_(tree),
        pairs_left_(pairs_per_triangle * triangles.size()),
        limit_(limit) {}

  MeshIntersections run(const Progress& progress) {
    pending_.assign(1, {0, 0});
    for (std::size_t step = 1; !pending_.empty() && result_.complete; ++step) {
      if (step % steps_between_reports == 0 && !progress.report(0.0)) result_.complete = false;
      const auto [a, b] = pending_.back();
      pending_.pop_back();
      const BoxTree::Node &first = tree_.nodes()[a], &second = tree_.nodes()[b];
      if (a != b && !first.box.overlaps(second.box)) continue;
      if (first.is_leaf() && second.is_leaf()) {
        test_leaves(first, second);
      } else if (a == b) {
        pending_.insert(pending_.end(), {{a + 1, a + 1}, {first.first, first.first}, {a + 1, first.first}});
      } else if (second.is_leaf() || (!first.is_leaf() && first.box.size() > second.box.size())) {
        pending_.insert(pending_.end(), {{a + 1, b}, {first.first, b}});
      } else {
        pending_.insert(pending_.end(), {{a, b + 1}, {a, second.first}});
      }
    }
    return std::move(result_);
  }

 private:
  Triangle triangle(std::uint32_t index) const {
    const auto& [a, b, c] = triangles_[index];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }

  void test_leaves(const BoxTree::Node& first, const BoxTree::Node& second) {
    for (std::uint32_t s = first.first; s < first.first + first.count; ++s) {
      const Triangle a = triangle(s);
      const Box box_a = bounding_box(a);
      for (std::uint32_t t = std::max(second.first, &first == &second ? s + 1 : 0U);
           t < second.first + second.count; ++t) {
        if (pairs_left_-- == 0) {
          result_.complete = false;
          return;
        }
        const Triangle b = triangle(t);
        if (!box_a.overlaps(bounding_box(b))) continue;
        const bool neighbours = has_common_corner(triangles_[s], triangles_[t]);
        if (!(neighbours ? triangles_meet(shrink_to_centroid(a), shrink_to_centroid(b))
                         : triangles_meet(a, b)))
          continue;
        if (result_.found.size() == limit_) {
          result_.complete = false;
          return;
        }
        result_.found.push_back(
            {s, t, std::min(penetration_through_plane(a, b), penetration_through_plane(b, a))});
      }
    }
  }

  const std::vector<Vector3>& vertices_;
  const std::vector<TriangleCorners>& triangles_;
  const BoxTree& tree_;
  std::size_t pairs_left_, limit_;
  MeshIntersections result_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pending_;
};

}  // namespace

MeshIntersections self_intersections(const std::vector<Vector3>& vertices_m,
                                     const std::vector<TriangleCorners>& triangles, const BoxTree& tree,
                                     std::size_t limit, const Progress& progress) {
  SPOONBILL_ASSERT(tree.order().size() == triangles.size());
  return SelfIntersectionSearch(vertices_m, triangles, tree, limit).run(progress);
}

bool is_self_intersecting(const std::vector<Vector3>& vertices_m,
                          const std::vector<TriangleCorners>& triangles, const BoxTree& tree) {
  return !self_intersections(vertices_m, triangles, tree, 0).complete;
}

}  // namespace spoonbill
