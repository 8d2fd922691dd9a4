// A tree of boxes in one flat array, whose depth is bounded, so that a search needs no recursion and no heap.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Which items lie together never changes once made; any thread may read it while none refits.
class BoxTree {
 public:
  struct Node {
    Box box;
    std::uint32_t first;  // of a leaf, into order(); else the right child, the left follows its parent
    std::uint32_t count;  // of a leaf's items; 0 in a node with children
    bool is_leaf() const { return count > 0; }
  };

  // Halves the items by the middles of their boxes along the longest side. At least one box.
  BoxTree(const std::vector<Box>& boxes, std::uint32_t leaf_size);

  // Takes the boxes that the same items have now: bounding_box(place) of each place in order(). Allocates nothing.
  template <class BoxOf>
  void refit(const BoxOf& bounding_box) {
    // Children stand behind their parents.
    for (auto index = static_cast<std::uint32_t>(nodes_.size()); index-- > 0;) {
      Node& node = nodes_[index];
      node.box = node.is_leaf() ? bounding_box(node.first) : joined(nodes_[index + 1].box, nodes_[node.first].box);
      for (std::uint32_t k = 1; k < node.count; ++k) node.box = joined(node.box, bounding_box(node.first + k));
    }
  }

  const std::vector<Node>& nodes() const { return nodes_; }           // the root first
  const std::vector<std::uint32_t>& order() const { return order_; }  // the items, leaf by leaf

  // Depth first: descend(node) says whether its box is worth a look, leaf(first, count) gets the items in
  // order(). `first_right(left, right)` says which child to see first.
  template <class Descend, class FirstRight, class Leaf>
  void search(const Descend& descend, const FirstRight& first_right, const Leaf& leaf) const {
    // Two for each halving of at most 2^32 items.
    std::array<std::uint32_t, 66> waiting;
    std::uint32_t count = 1;
    waiting[0] = 0;
    while (count > 0) {
      const std::uint32_t index = waiting[--count];
      const Node& node = nodes_[index];
      if (!descend(index)) continue;
      if (node.is_leaf()) {
        leaf(node.first, node.count);
        continue;
      }
      const bool right = first_right(index + 1, node.first);
      waiting[count++] = right ? index + 1 : node.first;
      waiting[count++] = right ? node.first : index + 1;
    }
  }

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

// A lower bound of the signed distance to what lies in the box: outside the way to it, inside minus the way
// out.
inline double signed_distance(const Box& box, const Vector3& point) {
  const Vector3 beyond = (box.low - point).cwiseMax(point - box.high);
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

}  // namespace spoonbill
