#include "engine/collision/levels/cell_pairs.h"

#include <algorithm>
#include <bit>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Of more, a coarser level tells as much.
constexpr std::size_t fine_pairs = 1 << 16;

}  // namespace
CellPairs::CellPairs(SurfaceLevels& first, SurfaceLevels& second)
    : first_(&first),
      second_(&second),
      first_slabs_(first),
      second_slabs_(second),
      first_tree_(first.nested().grid.u.knots, first.nested().grid.v.knots),
      second_tree_(second.nested().grid.u.knots, second.nested().grid.v.knots) {
  // Each step down leaves one pair behind, and up to fifteen of cells.
  node_pairs_.reserve(256);
  path_.reserve(static_cast<std::size_t>(16 * (2 + std::max(first.nested().levels, second.nested().levels))));
  pairs_.reserve(cell_pair_capacity);
}

void CellPairs::begin_first() {
  first_slabs_.begin();
  first_is_stale_ = true;
}

void CellPairs::begin_second() {
  second_slabs_.begin();
  second_is_stale_ = true;
}

void CellPairs::update() {
  if (first_is_stale_) first_tree_.update(*first_);
  if (second_is_stale_) second_tree_.update(*second_);
  first_is_stale_ = second_is_stale_ = false;
}

std::vector<CellPair>& CellPairs::within(double reach_m) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  update();
  int level = std::max(first_->nested().levels, second_->nested().levels);
  take_pairs(reach_m, level);
  while (overflow_ && level > 0) take_pairs(reach_m, --level);
  return pairs_;
}

const std::vector<CellPair>& CellPairs::within_at(double reach_m, int level) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  SPOONBILL_ASSERT(level >= 0);
  update();
  take_pairs(reach_m, level);
  return pairs_;
}

// From the middle of the smaller surface's box, then back.
CellPair CellPairs::likely_near() const {
  const auto middle = [](const Box& box) -> Vector3 { return 0.5 * (box.low + box.high); };
  const bool first_is_smaller = first_tree_.size(first_tree_.root()) < second_tree_.size(second_tree_.root());
  const ElementTree& small = first_is_smaller ? first_tree_ : second_tree_;
  const ElementTree& large = first_is_smaller ? second_tree_ : first_tree_;
  const int of_large = large.leaf_near(middle(small.box(small.root())));
  const int of_small = small.leaf_near(middle(large.box(of_large)));
  return first_is_smaller ? elements({of_small, of_large}) : elements({of_large, of_small});
}

void CellPairs::take_pairs(double reach, int level) {
  pairs_.clear();
  limit_ = level == 0 ? cell_pair_capacity : fine_pairs;
  overflow_ = false;
  visit_near_elements(reach, [&](const CellPair& pair) { refine(pair, reach, level); });
}

void CellPairs::refine(const CellPair& elements, double reach, int level) {
  const int finest_first = std::min(level, first_->nested().levels),
            finest_second = std::min(level, second_->nested().levels);
  const auto meeting = [kernel = first_->kernels().meeting, reach_m = static_cast<float>(reach)](
                           const SlabGroup& a, int lanes, const SlabGroup& b) {
    return kernel(a, lanes, b, reach_m);
  };
  const auto element = [](const CellSlabs& slabs, const SurfaceLevels& levels, const LevelCell& cell) {
    return slabs.element(cell.i >> levels.nested().levels, cell.j >> levels.nested().levels);
  };
  const Places both{element(first_slabs_, *first_, elements.first),
                    element(second_slabs_, *second_, elements.second)};
  if ((meeting(first_slabs_.alone(both.first), 1, second_slabs_.alone(both.second)) & 1U) == 0U) {
    return;
  }
  if (finest_first == 0 && finest_second == 0) {
    emit(both, true);
    return;
  }
  path_.clear();
  path_.push_back(both);
  while (!path_.empty() && !overflow_) {
    const Places pair = path_.back();
    path_.pop_back();
    const bool cut_first = pair.first.cell.level < finest_first,
               cut_second = pair.second.cell.level < finest_second;
    const SlabGroup& first = cut_first ? first_slabs_.within(pair.first) : first_slabs_.alone(pair.first);
    const SlabGroup& second =
        cut_second ? second_slabs_.within(pair.second) : second_slabs_.alone(pair.second);
    const unsigned lanes = cut_second ? 0xffffU : 0x1111U;
    unsigned met = meeting(first, cut_first ? slab_lanes : 1, second) & lanes;
    const bool ended =
        pair.first.cell.level + 1 >= finest_first && pair.second.cell.level + 1 >= finest_second;
    for (bool is_first = true; met != 0U; met &= met - 1U, is_first = false) {
      const int lane = std::countr_zero(met);
      const Places finer{cut_first ? first_slabs_.finer(pair.first, lane >> 2) : pair.first,
                         cut_second ? second_slabs_.finer(pair.second, lane & 3) : pair.second};
      if (ended) {
        emit(finer, is_first);
      } else {
        path_.push_back(finer);
      }
    }
  }
}

// Cells within the same two cells are each other's neighbours.
void CellPairs::emit(const Places& places, bool is_first) {
  overflow_ = overflow_ || pairs_.size() == limit_;
  if (!overflow_) pairs_.push_back({places.first.cell, places.second.cell, is_first ? 0 : -1});
}

CellPair CellPairs::elements(const std::array<int, 2>& nodes) const {
  const ElementTree::Node& a = first_tree_.node(nodes[0]);
  const ElementTree::Node& b = second_tree_.node(nodes[1]);
  const int step_a = first_->step(0), step_b = second_->step(0);
  return {{a.first_u * step_a, a.first_v * step_a, 0}, {b.first_u * step_b, b.first_v * step_b, 0}};
}

}  // namespace spoonbill
