// The cells of two surfaces that could meet, found from coarse to fine: boxes of the present control points
// and corners, then slabs about the patches, which hold the slack that the surfaces may leave their samples
// by.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/collision/levels/cell_slabs.h"
#include "engine/collision/levels/element_tree.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

inline constexpr std::size_t cell_pair_capacity = 1 << 19;

struct CellPair {
  LevelCell first, second;
  // From ContactRegions; before it, -1 where both cells are neighbours of the pair before's.
  int region = 0;
};

// One owner, one thread; allocates only when made.
class CellPairs {
 public:
  CellPairs(SurfaceLevels& first, SurfaceLevels& second);

  // The control points of one have moved; after SurfaceLevels::begin() of it.
  void begin_first();
  void begin_second();

  // Brings the trees up to date; within() does so itself.
  void update();

  // Two elements, as coarsest cells, that are likely to be near each other.
  CellPair likely_near() const;

  // All pairs of cells that can be within `reach_m` of each other: of the finest level, or where the surfaces
  // meet over a whole area, of the finest at which there are not too many.
  std::vector<CellPair>& within(double reach_m);
  // The same on the way there: the pairs of cells of one level, counted from the coarsest, that were kept.
  const std::vector<CellPair>& within_at(double reach_m, int level);
  // Those of the last within(), in the order that others have given them.
  const std::vector<CellPair>& pairs() const { return pairs_; }

  // Calls visit(pair) for the elements, as coarsest cells, whose boxes are within reach() of each other,
  // nearer ones first by and large; reach() may fall meanwhile.
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

  // Calls visit(pair) for all elements whose boxes are within reach of each other.
  template <class Visit>
  void visit_near_elements(double reach, const Visit& visit) {
    node_pairs_.clear();
    node_pairs_.push_back({first_tree_.root(), second_tree_.root()});
    while (!node_pairs_.empty()) {
      const std::array<int, 2> nodes = node_pairs_.back();
      node_pairs_.pop_back();
      if (!first_tree_.box(nodes[0]).is_near(second_tree_.box(nodes[1]), reach)) continue;
      if (first_tree_.node(nodes[0]).is_leaf() && second_tree_.node(nodes[1]).is_leaf()) {
        visit(elements(nodes));
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

  // Whether a capacity was met in the last within(), and pairs may be missing.
  bool overflow() const { return overflow_; }

  const ElementTree& first_tree() const { return first_tree_; }
  const ElementTree& second_tree() const { return second_tree_; }

 private:
  double gap(const std::array<int, 2>& nodes) const {
    return first_tree_.box(nodes[0]).gap(second_tree_.box(nodes[1]));
  }
  CellPair elements(const std::array<int, 2>& nodes) const;
  // The larger box in halves, beside the other.
  std::array<std::array<int, 2>, 2> split(const std::array<int, 2>& nodes) const {
    const auto [a, b] = nodes;
    const ElementTree::Node& node_a = first_tree_.node(a);
    const ElementTree::Node& node_b = second_tree_.node(b);
    const bool split_a =
        node_b.is_leaf() || (!node_a.is_leaf() && first_tree_.size(a) >= second_tree_.size(b));
    if (split_a) return {{{node_a.left, b}, {node_a.right, b}}};
    return {{{a, node_b.left}, {a, node_b.right}}};
  }
  void take_pairs(double reach, int level);

  SurfaceLevels* first_;
  SurfaceLevels* second_;
  CellSlabs first_slabs_, second_slabs_;
  ElementTree first_tree_, second_tree_;
  std::vector<std::array<int, 2>> node_pairs_;  // working memory: a path down both trees
  std::vector<CellPair> pairs_;
  struct Places {
    CellSlabs::Place first, second;
  };
  void refine(const CellPair& elements, double reach, int level);
  void emit(const Places& places, bool is_first);

  std::vector<Places> path_;  // working memory: what is left to refine of two elements
  std::size_t limit_ = cell_pair_capacity;
  bool overflow_ = false;
  bool first_is_stale_ = true, second_is_stale_ = true;
};

}  // namespace spoonbill
