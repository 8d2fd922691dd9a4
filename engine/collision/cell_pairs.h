// The cells of two surfaces that could meet, found from coarse to fine: boxes of the present control points,
// spheres that cover their patches, and at the end the triangles of the samples with the slack that the
// surfaces may leave them by.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/collision/element_tree.h"
#include "engine/collision/surface_levels.h"

namespace spoonbill {

inline constexpr std::size_t cell_pair_capacity = 1 << 16;

struct CellPair {
  LevelCell first, second;
  // For ContactRegions: cell_index() of both, and the region.
  int first_index = 0, second_index = 0, region = 0;
};

// One owner, one thread; allocates only when made.
class CellPairs {
 public:
  CellPairs(SurfaceLevels& first, SurfaceLevels& second);

  // The control points of one have moved; after SurfaceLevels::begin() of it.
  void begin_first();
  void begin_second();

  // All pairs of cells that can be within `reach_m` of each other: of the finest level, or of one where every
  // cell of both surfaces is in some of many pairs, below which spheres tell nothing apart.
  std::vector<CellPair>& within(double reach_m);

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

  // Whether a capacity was met in the last within(), and pairs may be missing.
  bool overflow() const { return overflow_; }

  const ElementTree& first_tree() const { return first_tree_; }
  const ElementTree& second_tree() const { return second_tree_; }

 private:
  double gap(const std::array<int, 2>& nodes) const {
    return first_tree_.box(nodes[0]).gap(second_tree_.box(nodes[1]));
  }
  CellPair elements(const std::array<int, 2>& nodes) const;
  std::array<std::array<int, 2>, 2> split(const std::array<int, 2>& nodes) const;
  static void tighten(ElementTree& tree, SurfaceLevels& levels, const ElementTree& other, double reach);
  bool are_apart(const CellPair& pair, double reach);
  bool refine(double reach);
  bool all_meet();
  int cells_in(const SurfaceLevels& levels, LevelCell CellPair::*side, int offset);
  void keep_meeting_triangles(double reach);

  SurfaceLevels* first_;
  SurfaceLevels* second_;
  ElementTree first_tree_, second_tree_;
  std::vector<std::array<int, 2>> node_pairs_;  // working memory: a path down both trees
  std::vector<CellPair> pairs_, finer_;
  std::vector<std::uint32_t> counted_at_;  // by cell_index() of the first, then of the second
  std::uint32_t count_ = 0;
  bool overflow_ = false;
};

}  // namespace spoonbill
