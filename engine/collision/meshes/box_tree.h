// Bounding volume tree over triangles, and searches that it speeds up: ray casting and self-intersection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/progress.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Largest number of triangles in a leaf of a BoxTree over a mesh.
inline constexpr std::uint32_t triangle_leaf_size = 4;

// Tree of boxes over items such as triangles, stored in one array. Its depth is bounded, so a search needs
// neither recursion nor the heap. The grouping of the items never changes. Any thread may read the tree while
// no thread calls refit().
class BoxTree {
 public:
  struct Node {
    Box box;
    // Start of a leaf's items in order(). In an inner node, index of the right child; the left child directly
    // follows its parent.
    std::uint32_t first;
    std::uint32_t count;  // number of items in a leaf; 0 in an inner node
    bool is_leaf() const { return count > 0; }
  };

  // Builds the tree by repeatedly halving the items at the median of their box centres, along the axis in
  // which the centres extend farthest. A leaf has at most `leaf_size` items. `boxes` must not be empty, and
  // `leaf_size` must be at least 1.
  BoxTree(const std::vector<Box>& boxes, std::uint32_t leaf_size);

  // Updates all boxes: bounding_box(position) returns the current box of the item at a position in order().
  // Allocates nothing.
  template <class BoxOf>
  void refit(const BoxOf& bounding_box) {
    // Children come after their parents in nodes_, so the boxes are updated from the last node to the first.
    for (auto index = static_cast<std::uint32_t>(nodes_.size()); index-- > 0;) {
      Node& node = nodes_[index];
      node.box =
          node.is_leaf() ? bounding_box(node.first) : joined(nodes_[index + 1].box, nodes_[node.first].box);
      for (std::uint32_t k = 1; k < node.count; ++k)
        node.box = joined(node.box, bounding_box(node.first + k));
    }
  }

  const std::vector<Node>& nodes() const { return nodes_; }           // the root is first
  const std::vector<std::uint32_t>& order() const { return order_; }  // item indices, leaf by leaf

  // Traverses the tree depth first. descend(node) returns false to skip a node. leaf(first, count) receives a
  // range of order(). first_right(left, right) returns true to visit the right child first.
  template <class Descend, class FirstRight, class Leaf>
  void search(const Descend& descend, const FirstRight& first_right, const Leaf& leaf) const {
    // At most 2^32 items are halved at most 32 times, and each halving adds at most two entries.
    std::array<std::uint32_t, 66> pending;
    std::uint32_t count = 1;
    pending[0] = 0;
    while (count > 0) {
      const std::uint32_t index = pending[--count];
      const Node& node = nodes_[index];
      if (!descend(index)) continue;
      if (node.is_leaf()) {
        leaf(node.first, node.count);
        continue;
      }
      const bool right = first_right(index + 1, node.first);
      pending[count++] = right ? index + 1 : node.first;
      pending[count++] = right ? node.first : index + 1;
    }
  }

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

// Returns a lower bound of the signed distance from a point to whatever the box contains. It is the signed
// distance to the box itself, positive outside and negative inside.
inline double signed_distance(const Box& box, const Vector3& point) {
  const Vector3 beyond = (box.low - point).cwiseMax(point - box.high);
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

// Result of LineExits::first().
struct LineExit {
  double distance_m = 0.0;
  std::uint32_t triangle = 0;
  double to_b = 0.0, to_c = 0.0;  // barycentric weights of the second and third corner
};

// Search for the point at which a line leaves a body that is bounded by triangles. Immutable, so any thread
// may use it. Too slow for a tick.
class LineExits {
 public:
  // `triangles` must not be empty and must be counter-clockwise seen from outside.
  explicit LineExits(std::vector<Triangle> triangles);

  // Returns the nearest exit: the first triangle along the unit direction at which the line leaves the body.
  // Triangles at which the line enters the body are ignored.
  std::optional<LineExit> first(const Vector3& from, const Vector3& direction) const;

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const BoxTree& tree() const { return *tree_; }

 private:
  std::vector<Triangle> triangles_;
  std::unique_ptr<BoxTree> tree_;
};

// Returns true if a line that leaves through the triangle passes through a wall, that is, if its unit
// direction is within 50 degrees of the triangle's normal. A more oblique exit is usually near an edge of the
// body, where the length of the line is not the thickness of a wall.
bool exits_through_wall(const Triangle& triangle, const Vector3& direction);

struct MeshIntersection {
  std::uint32_t first = 0, second = 0;  // indices of the two triangles
  // The smaller of the two depths, in metres, by which each triangle penetrates the plane of the other. It is
  // at most the size of the triangles.
  double depth_m = 0.0;
};

struct MeshIntersections {
  std::vector<MeshIntersection> found;
  // False if there are more pairs than the limit, if the search needed too many pair tests, or if it was
  // stopped.
  bool complete = true;
};

// Finds up to `limit` pairs of intersecting triangles. Triangles with a common corner are first shrunk by a
// millionth, so that they do not intersect there. `triangles` must be in the order of the tree's leaves.
//
// On a mesh without intersections, the search takes about a microsecond per triangle. It ends early if it
// needs more than 200 pair tests per triangle, for example with long needles. `progress` can stop it, but
// does not receive the fraction done.
MeshIntersections self_intersections(const std::vector<Vector3>& vertices_m,
                                     const std::vector<TriangleCorners>& triangles, const BoxTree& tree,
                                     std::size_t limit, const Progress& progress = {});

// Returns true if the mesh intersects itself, or if the search ended before it could decide.
bool is_self_intersecting(const std::vector<Vector3>& vertices_m,
                          const std::vector<TriangleCorners>& triangles, const BoxTree& tree);

}  // namespace spoonbill
