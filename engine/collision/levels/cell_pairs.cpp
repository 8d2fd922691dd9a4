#include "engine/collision/levels/cell_pairs.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Number of groups of slabs in the cache, which is cleared when it is full.
constexpr int group_capacity = 8192;
// Factor by which bulges are enlarged, because rounding makes the parameter steps of an element's cells
// differ slightly.
constexpr double size_tolerance = 1.0 + 1e-9;

}  // namespace

CellSlabs::CellSlabs(SurfaceLevels& levels)
    : levels_(&levels),
      elements_v_(levels.bounds().elements_v()),
      keys_per_element_(((4 << (2 * levels.nested().levels)) - 1) / 3),
      keys_(keys_per_element_ * levels.cell_count(0)) {
  groups_.resize(static_cast<std::size_t>(std::min(2 * keys_, group_capacity)));
  slots_.resize(static_cast<std::size_t>(2 * keys_));
  begin();
}

void CellSlabs::begin() {
  ++generation_;
  used_ = 0;
}

// Copies 3 x 3 samples of the finest grid, `stride` apart, starting at the cell's low corner.
void CellSlabs::gather_samples(const LevelCell& cell, int stride) {
  levels_->sample_element(cell.i >> levels_->nested().levels, cell.j >> levels_->nested().levels);
  const PlanarPoints from = levels_->samples();
  const int columns = levels_->nested().grid.columns();
  const double* const values[3] = {from.x, from.y, from.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* row = values[axis] + cell.i * columns + cell.j;
    for (int a = 0; a < 3; ++a, row += stride * columns) {
      for (int b = 0; b < 3; ++b) samples_[axis][3 * a + b] = row[b * stride];
    }
  }
}

void CellSlabs::compute_children(const LevelCell& cell, SlabGroup& group) {
  gather_samples(cell, levels_->step(cell.level + 1));
  // The bulge grows with the square of a cell's sides, and a child's sides are half as long.
  const double bulge = 0.25 * size_tolerance * levels_->bulge(cell);
  levels_->kernels().compute_slabs({samples_[0], samples_[1], samples_[2]}, bulge, group);
}

void CellSlabs::compute_single(const LevelCell& cell, SlabGroup& group) {
  // All lanes get the same four corners; in some lanes the cell is mirrored.
  const PatchCorners corners = levels_->corners(cell);
  constexpr int corner_index[9] = {0, 1, 0, 2, 3, 2, 0, 1, 0};
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 9; ++k) samples_[axis][k] = corners[corner_index[k]][axis];
  }
  levels_->kernels().compute_slabs({samples_[0], samples_[1], samples_[2]}, levels_->bulge(cell), group);
}

ElementTree::Direction ElementTree::unroll(const KnotVector& knots) {
  Direction direction{knots.degree(), {}, {}};
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    direction.first_control.push_back(static_cast<int>(direction.control.size()));
    const int span = knots.find_span(0.5 * (breaks[b] + breaks[b + 1]));
    for (int j = 0; j <= knots.degree(); ++j) direction.control.push_back(knots.control_index(span, j));
  }
  return direction;
}

ElementTree::ElementTree(const KnotVector& u, const KnotVector& v) : u_(unroll(u)), v_(unroll(v)) {
  leaf_.resize(static_cast<std::size_t>(u_.elements() * v_.elements()));
  add({0, u_.elements(), 0, v_.elements()});
  boxes_.resize(nodes_.size());
  sizes_.resize(nodes_.size());
  strip_.resize(static_cast<std::size_t>(v_.elements()));
  bulges_.resize(static_cast<std::size_t>(v_.elements()));
}

int ElementTree::add(const Node& range) {
  const int index = static_cast<int>(nodes_.size()), length_u = range.end_u - range.first_u,
            length_v = range.end_v - range.first_v;
  nodes_.push_back(range);
  if (length_u == 1 && length_v == 1) {
    leaf_[range.first_u * v_.elements() + range.first_v] = index;
    return index;
  }
  Node low = range, high = range;
  if (length_u >= length_v) {
    low.end_u = high.first_u = range.first_u + length_u / 2;
  } else {
    low.end_v = high.first_v = range.first_v + length_v / 2;
  }
  const int left = add(low), right = add(high);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

void ElementTree::update(SurfaceLevels& levels) {
  SPOONBILL_ASSERT_DEBUG(levels.bounds().elements_u() == u_.elements());
  levels.bounds().update(levels.surface().net);
  for (int e = 0; e < u_.elements(); ++e) update_strip(levels, e);
  join_boxes();
}

void ElementTree::join_boxes() {
  for (int index = static_cast<int>(nodes_.size()) - 1; index >= 0; --index) {
    const Node& node = nodes_[index];
    if (node.is_leaf()) continue;
    boxes_[index] = joined(boxes_[node.left], boxes_[node.right]);
    sizes_[index] = (boxes_[index].high - boxes_[index].low).sum();
  }
}

int ElementTree::find_leaf_near(const Vector3& point) const {
  SPOONBILL_ASSERT(!boxes_.empty());
  int nearest = leaf_[0];
  double least = std::numeric_limits<double>::infinity();
  for (const int leaf : leaf_) {
    const double squared = (0.5 * (boxes_[leaf].low + boxes_[leaf].high) - point).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    nearest = leaf;
  }
  return nearest;
}

// Updates the boxes of the elements in row element_u. The box around an element's corners is intersected with
// the box of its control points if the bulge is large compared to the box around the corners.
void ElementTree::update_strip(SurfaceLevels& levels, int element_u) {
  levels.element_boxes(element_u, strip_.data(), bulges_.data());
  for (int element_v = 0; element_v < v_.elements(); ++element_v) {
    const int index = leaf_[element_u * v_.elements() + element_v];
    Box& box = boxes_[index];
    box = strip_[element_v];
    sizes_[index] = (box.high - box.low).sum();
    // A box's size is the sum of its three side lengths, and each of them includes the bulge twice.
    if (bulges_[element_v] <= 0.1 * sizes_[index]) continue;
    const Box hull = control_box(levels.surface().net, element_u, element_v);
    box = {box.low.cwiseMax(hull.low), box.high.cwiseMin(hull.high)};
    sizes_[index] = (box.high - box.low).sum();
  }
}

Box ElementTree::control_box(const ControlNet& net, int element_u, int element_v) const {
  const int* const rows = u_.control.data() + u_.first_control[element_u];
  const int* const columns = v_.control.data() + v_.first_control[element_v];
  Box box;
  for (int i = 0; i <= u_.degree; ++i) {
    for (int j = 0; j <= v_.degree; ++j) box.include(net.point(rows[i], columns[j]));
  }
  return box;
}

namespace {

// Largest number of pairs at any level except the coarsest. If there are more, the surfaces meet over so
// large an area that a coarser level is precise enough.
constexpr std::size_t fine_pair_capacity = 1 << 16;

}  // namespace
CellPairs::CellPairs(SurfaceLevels& first, SurfaceLevels& second)
    : first_(&first),
      second_(&second),
      first_slabs_(first),
      second_slabs_(second),
      first_tree_(first.nested().grid.u.knots, first.nested().grid.v.knots),
      second_tree_(second.nested().grid.u.knots, second.nested().grid.v.knots) {
  // Each step of a descent removes one entry from a stack. It adds at most four entries to node_pairs_, or
  // sixteen to pending_.
  node_pairs_.reserve(256);
  pending_.reserve(
      static_cast<std::size_t>(16 * (2 + std::max(first.nested().levels, second.nested().levels))));
  pairs_.reserve(cell_pair_capacity);
}

void CellPairs::invalidate_first() {
  first_slabs_.begin();
  first_is_stale_ = true;
}

void CellPairs::invalidate_second() {
  second_slabs_.begin();
  second_is_stale_ = true;
}

void CellPairs::update() {
  if (first_is_stale_) first_tree_.update(*first_);
  if (second_is_stale_) second_tree_.update(*second_);
  first_is_stale_ = second_is_stale_ = false;
}

std::vector<CellPair>& CellPairs::find_within(double reach_m) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  update();
  int level = std::max(first_->nested().levels, second_->nested().levels);
  collect_pairs(reach_m, level);
  while (overflow_ && level > 0) collect_pairs(reach_m, --level);
  return pairs_;
}

const std::vector<CellPair>& CellPairs::find_within_at_level(double reach_m, int level) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  SPOONBILL_ASSERT(level >= 0);
  update();
  collect_pairs(reach_m, level);
  return pairs_;
}

// Pairs two elements. One is the larger surface's element nearest to the centre of the smaller surface's box;
// the other is the smaller surface's element nearest to the first element.
CellPair CellPairs::find_likely_near_elements() const {
  const auto centre = [](const Box& box) -> Vector3 { return 0.5 * (box.low + box.high); };
  const bool first_is_smaller = first_tree_.size(first_tree_.root()) < second_tree_.size(second_tree_.root());
  const ElementTree& small = first_is_smaller ? first_tree_ : second_tree_;
  const ElementTree& large = first_is_smaller ? second_tree_ : first_tree_;
  const int large_leaf = large.find_leaf_near(centre(small.box(small.root())));
  const int small_leaf = small.find_leaf_near(centre(large.box(large_leaf)));
  return first_is_smaller ? elements({small_leaf, large_leaf}) : elements({large_leaf, small_leaf});
}

void CellPairs::collect_pairs(double reach, int level) {
  pairs_.clear();
  limit_ = level == 0 ? cell_pair_capacity : fine_pair_capacity;
  overflow_ = false;
  visit_near_elements(reach, [&](const CellPair& pair) {
    refine(pair, reach, level);
    return !overflow_;
  });
}

void CellPairs::refine(const CellPair& elements, double reach, int level) {
  const int finest_first = std::min(level, first_->nested().levels),
            finest_second = std::min(level, second_->nested().levels);
  const auto meeting = [kernel = first_->kernels().find_meeting, reach_m = static_cast<float>(reach)](
                           const SlabGroup& a, int lanes, const SlabGroup& b) {
    return kernel(a, lanes, b, reach_m);
  };
  const auto element = [](const CellSlabs& slabs, const SurfaceLevels& levels, const LevelCell& cell) {
    return slabs.element(cell.i >> levels.nested().levels, cell.j >> levels.nested().levels);
  };
  const NodePair both{element(first_slabs_, *first_, elements.first),
                      element(second_slabs_, *second_, elements.second)};
  if ((meeting(first_slabs_.single(both.first), 1, second_slabs_.single(both.second)) & 1U) == 0U) {
    return;
  }
  if (finest_first == 0 && finest_second == 0) {
    add_pair(both, true);
    return;
  }
  pending_.clear();
  pending_.push_back(both);
  while (!pending_.empty() && !overflow_) {
    const NodePair pair = pending_.back();
    pending_.pop_back();
    const bool split_first = pair.first.cell.level < finest_first,
               split_second = pair.second.cell.level < finest_second;
    const SlabGroup& first =
        split_first ? first_slabs_.children(pair.first) : first_slabs_.single(pair.first);
    const SlabGroup& second =
        split_second ? second_slabs_.children(pair.second) : second_slabs_.single(pair.second);
    const unsigned lanes = split_second ? 0xffffU : 0x1111U;
    unsigned lanes_left = meeting(first, split_first ? slab_lanes : 1, second) & lanes;
    const bool is_last_step =
        pair.first.cell.level + 1 >= finest_first && pair.second.cell.level + 1 >= finest_second;
    for (bool is_first = true; lanes_left != 0U; lanes_left &= lanes_left - 1U, is_first = false) {
      const int lane = std::countr_zero(lanes_left);
      const NodePair child{split_first ? first_slabs_.child(pair.first, lane >> 2) : pair.first,
                           split_second ? second_slabs_.child(pair.second, lane & 3) : pair.second};
      if (is_last_step) {
        add_pair(child, is_first);
      } else {
        pending_.push_back(child);
      }
    }
  }
}

// Adds a pair of cells. Pairs of children of the same two cells are neighbours, so all of them except the
// first get the region -1, which marks a neighbour of the preceding pair.
void CellPairs::add_pair(const NodePair& nodes, bool is_first) {
  overflow_ = overflow_ || pairs_.size() == limit_;
  if (!overflow_) pairs_.push_back({nodes.first.cell, nodes.second.cell, is_first ? 0 : -1});
}

CellPair CellPairs::elements(const std::array<int, 2>& nodes) const {
  const ElementTree::Node& a = first_tree_.node(nodes[0]);
  const ElementTree::Node& b = second_tree_.node(nodes[1]);
  const int step_a = first_->step(0), step_b = second_->step(0);
  return {{a.first_u * step_a, a.first_v * step_a, 0}, {b.first_u * step_b, b.first_v * step_b, 0}};
}

}  // namespace spoonbill
