// Coarse-to-fine search for pairs of cells of two surfaces that may meet. An element is a polynomial piece of
// a surface; a cell is a rectangle between samples of an element. The search tests boxes around elements,
// then slabs around cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Cache of the slabs (SlabGroup) that bound the cells of one surface. A cell is a rectangle between samples.
// Not thread-safe. Allocates only on construction.
class CellSlabs {
 public:
  explicit CellSlabs(SurfaceLevels& levels);

  // Clears the cache. Must be called after SurfaceLevels::begin().
  void begin();

  // A cell and its index in the quadtree of its element. `element_key` is the first of the keys that are
  // reserved for the cells of the element.
  struct QuadtreeCell {
    LevelCell cell;
    int element_key, index_in_element;
    int key() const { return element_key + index_in_element; }
  };
  QuadtreeCell element(int element_u, int element_v) const {
    const int stride = levels_->step(0);
    return {{element_u * stride, element_v * stride, 0},
            (element_u * elements_v_ + element_v) * keys_per_element_,
            0};
  }
  // Returns the child cell in the given lane of children().
  QuadtreeCell child(const QuadtreeCell& node, int lane) const {
    const int half = levels_->step(node.cell.level + 1);
    return {{node.cell.i + (lane >> 1) * half, node.cell.j + (lane & 1) * half, node.cell.level + 1},
            node.element_key,
            4 * node.index_in_element + 1 + lane};
  }

  // Returns the slabs of the four children of a cell that is not at the finest level. Lane 2 a + b contains
  // the child in half a along u and half b along v. The result is valid until the next call.
  const SlabGroup& children(const QuadtreeCell& node) {
    SlabGroup* group = nullptr;
    if (claim_slot(node.key(), group)) compute_children(node.cell, *group);
    return *group;
  }
  // Returns the slab of the cell itself, repeated in each lane. The result is valid until the next call.
  const SlabGroup& single(const QuadtreeCell& node) {
    SlabGroup* group = nullptr;
    if (claim_slot(keys_ + node.key(), group)) compute_single(node.cell, *group);
    return *group;
  }

 private:
  // Finds the cached group of slabs for `key`, or claims a free group. Returns true if the slabs of the group
  // must still be computed.
  bool claim_slot(int key, SlabGroup*& group) {
    Slot& slot = slots_[key];
    const bool is_current = slot.generation == generation_;
    if (!is_current) {
      if (used_ == static_cast<int>(groups_.size())) begin();
      slot = {generation_, used_++};
    }
    group = &groups_[slot.group];
    return !is_current;
  }
  void compute_children(const LevelCell& cell, SlabGroup& group);
  void compute_single(const LevelCell& cell, SlabGroup& group);
  void gather_samples(const LevelCell& cell, int stride);

  SurfaceLevels* levels_;
  AlignedVector<SlabGroup> groups_;
  struct Slot {
    std::uint32_t generation = 0;  // value of generation_ when the slot was claimed
    int group = 0;
  };
  int elements_v_, keys_per_element_, keys_;
  // Indexed by key: first a slot for the children of each cell, then a slot for each cell itself.
  std::vector<Slot> slots_;
  std::uint32_t generation_ = 0;
  int used_ = 0;
  double samples_[3][9];  // working memory: 3 x 3 samples of each coordinate
};

// Binary tree of boxes over the elements of one surface. It limits the parameter ranges that can meet another
// surface, as section 4.1 of Pungotra et al. 2013 does by overlapping hulls. Not thread-safe. Allocates only
// on construction.
class ElementTree {
 public:
  ElementTree(const KnotVector& u, const KnotVector& v);

  struct Node {
    int first_u, end_u, first_v, end_v;  // ranges of the elements that the node contains
    int left = -1, right = -1;           // child nodes; -1 in a leaf, which is one element
    bool is_leaf() const { return left < 0; }
  };

  // Updates the boxes to the current shape. The box of an element encloses its four corners, enlarged by the
  // bulge, which is a bound of the surface's distance from the bilinear patch of the corners. If the bulge is
  // large, the box is intersected with that of the element's control points.
  void update(SurfaceLevels& levels);

  int root() const { return 0; }
  // Returns the leaf whose box centre is nearest to the point.
  int find_leaf_near(const Vector3& point) const;
  const Node& node(int index) const { return nodes_[index]; }
  const Box& box(int index) const { return boxes_[index]; }
  // Returns the sum of the box's side lengths, in metres.
  double size(int index) const { return sizes_[index]; }

 private:
  struct Direction {
    int degree;
    std::vector<int> first_control;  // for each element, index into `control` of its first control point
    std::vector<int> control;        // control point indices of all elements, one element after the other
    int elements() const { return static_cast<int>(first_control.size()); }
  };
  static Direction unroll(const KnotVector& knots);
  int add(const Node& range);
  void update_strip(SurfaceLevels& levels, int element_u);
  Box control_box(const ControlNet& net, int element_u, int element_v) const;
  void join_boxes();

  Direction u_, v_;
  std::vector<Node> nodes_;  // a parent precedes its children
  std::vector<Box> boxes_;
  std::vector<double> sizes_;
  std::vector<Box> strip_;      // working memory: boxes of the elements of one span of u
  std::vector<double> bulges_;  // working memory: bulges of the elements of one span of u
  std::vector<int> leaf_;       // node index of each element's leaf
};

inline constexpr std::size_t cell_pair_capacity = 1 << 19;

// A pair of cells, one of each surface.
struct CellPair {
  LevelCell first, second;
  // Index of the pair's contact region, set by ContactRegions. Before that, -1 if each cell is known to be
  // equal or adjacent to the corresponding cell of the preceding pair, otherwise 0.
  int region = 0;
};

// Coarse-to-fine search for pairs of cells of two surfaces that may meet. Not thread-safe. Allocates only on
// construction.
class CellPairs {
 public:
  CellPairs(SurfaceLevels& first, SurfaceLevels& second);

  // invalidate_first() must be called when the control points of the first surface have moved, after the
  // begin() of its SurfaceLevels. The same applies to invalidate_second() and the second surface.
  void invalidate_first();
  void invalidate_second();

  // Updates the trees to the surfaces' current shapes. find_within() and find_within_at_level() call update()
  // themselves.
  void update();

  // Returns two elements that are likely to be near each other, each as a cell of level 0.
  CellPair find_likely_near_elements() const;

  // Returns all pairs of cells that may be within `reach_m` of each other, at the finest level. If these
  // pairs exceed the capacity, because the surfaces meet over a large area, returns the pairs of the finest
  // level at which they fit.
  std::vector<CellPair>& find_within(double reach_m);
  // Returns the pairs of cells at one level, 0 being the coarsest, that may be within `reach_m` of each
  // other.
  const std::vector<CellPair>& find_within_at_level(double reach_m, int level);
  // Returns the pairs that the last search found. ContactRegions may have changed their order.
  const std::vector<CellPair>& pairs() const { return pairs_; }

  // Calls visit(pair) for each pair of elements, as cells of level 0, whose boxes are within reach() of each
  // other, roughly nearest first. reach() may decrease during the search.
  template <class Reach, class Visit>
  void visit_elements(const Reach& reach, const Visit& visit) {
    node_pairs_.clear();
    node_pairs_.push_back({first_tree_.root(), second_tree_.root()});
    while (!node_pairs_.empty()) {
      const std::array<int, 2> nodes = node_pairs_.back();
      node_pairs_.pop_back();
      if (gap(nodes) > reach()) continue;
      if (first_tree_.node(nodes[0]).is_leaf() && second_tree_.node(nodes[1]).is_leaf()) {
        visit(elements(nodes));
        continue;
      }
      const std::array<std::array<int, 2>, 2> halves = split(nodes);
      const bool nearer = gap(halves[0]) < gap(halves[1]);
      node_pairs_.push_back(halves[nearer ? 1 : 0]);
      node_pairs_.push_back(halves[nearer ? 0 : 1]);
    }
  }

  // Calls visit(pair) for each pair of elements, as cells of level 0, whose boxes are within `reach` of each
  // other, in metres. Stops when visit() returns false.
  template <class Visit>
  void visit_near_elements(double reach, const Visit& visit) {
    node_pairs_.clear();
    node_pairs_.push_back({first_tree_.root(), second_tree_.root()});
    while (!node_pairs_.empty()) {
      const std::array<int, 2> nodes = node_pairs_.back();
      node_pairs_.pop_back();
      if (!first_tree_.box(nodes[0]).is_near(second_tree_.box(nodes[1]), reach)) continue;
      if (first_tree_.node(nodes[0]).is_leaf() && second_tree_.node(nodes[1]).is_leaf()) {
        if (!visit(elements(nodes))) return;
        continue;
      }
      const ElementTree::Node& a = first_tree_.node(nodes[0]);
      const ElementTree::Node& b = second_tree_.node(nodes[1]);
      if (a.is_leaf() || b.is_leaf()) {
        for (const std::array<int, 2>& half : split(nodes)) node_pairs_.push_back(half);
        continue;
      }
      for (const int part : {a.left, a.right}) {
        for (const int other : {b.left, b.right}) node_pairs_.push_back({part, other});
      }
    }
  }

  // Returns true if the last search exceeded a capacity, so that pairs may be missing.
  bool overflow() const { return overflow_; }

  const ElementTree& first_tree() const { return first_tree_; }
  const ElementTree& second_tree() const { return second_tree_; }

 private:
  double gap(const std::array<int, 2>& nodes) const {
    return first_tree_.box(nodes[0]).gap(second_tree_.box(nodes[1]));
  }
  CellPair elements(const std::array<int, 2>& nodes) const;
  // Splits the node with the larger box into its two child nodes. Returns two pairs, one of each child with
  // the node that is not split.
  std::array<std::array<int, 2>, 2> split(const std::array<int, 2>& nodes) const {
    const auto [a, b] = nodes;
    const ElementTree::Node& node_a = first_tree_.node(a);
    const ElementTree::Node& node_b = second_tree_.node(b);
    const bool split_a =
        node_b.is_leaf() || (!node_a.is_leaf() && first_tree_.size(a) >= second_tree_.size(b));
    if (split_a) return {{{node_a.left, b}, {node_a.right, b}}};
    return {{{a, node_b.left}, {a, node_b.right}}};
  }
  void collect_pairs(double reach, int level);

  SurfaceLevels* first_;
  SurfaceLevels* second_;
  CellSlabs first_slabs_, second_slabs_;
  ElementTree first_tree_, second_tree_;
  std::vector<std::array<int, 2>> node_pairs_;  // working memory: stack of the descent through both trees
  std::vector<CellPair> pairs_;
  struct NodePair {
    CellSlabs::QuadtreeCell first, second;
  };
  void refine(const CellPair& elements, double reach, int level);
  void add_pair(const NodePair& nodes, bool is_first);

  std::vector<NodePair> pending_;  // working memory: stack of cell pairs still to be refined
  std::size_t limit_ = cell_pair_capacity;
  bool overflow_ = false;
  bool first_is_stale_ = true, second_is_stale_ = true;
};

}  // namespace spoonbill
