#include "engine/collision/cell_pairs.h"

#include <algorithm>

#include "engine/collision/patch_distance.h"
#include "engine/collision/triangle.h"

namespace spoonbill {
namespace {

// Fewer pairs are refined though all spheres meet: that costs little and gives narrower regions.
constexpr std::size_t few_pairs = 2048;

bool meet(const CoverSphere& a, const CoverSphere& b, double reach) {
  const double apart = a.radius + b.radius + reach;
  return (a.centre - b.centre).squaredNorm() <= apart * apart;
}

// How far the two triangles of a cell can be from the surface: its bulge from the bilinear patch, and a
// quarter of what the corners are from a parallelogram.
double triangle_slack(const PatchCorners& corners, double bulge) {
  return bulge + 0.25 * (corners[0] - corners[1] - corners[2] + corners[3]).norm();
}

bool cells_meet(const PatchCorners& a, const PatchCorners& b, double slack) {
  const Triangle of_a[2] = {{a[0], a[1], a[2]}, {a[3], a[2], a[1]}};
  const Triangle of_b[2] = {{b[0], b[1], b[2]}, {b[3], b[2], b[1]}};
  for (const Triangle& first : of_a) {
    for (const Triangle& second : of_b) {
      if (triangles_meet(first, second, slack)) return true;
    }
  }
  return false;
}

// Calls take() for the cells of the next level within a cell; the finest are their own.
template <class Take>
void for_each_finer(const SurfaceLevels& levels, const LevelCell& cell, const Take& take) {
  if (levels.is_finest(cell)) {
    take(cell);
    return;
  }
  const int half = levels.step(cell.level + 1);
  for (int corner = 0; corner < 4; ++corner) {
    take(LevelCell{cell.i + (corner >> 1) * half, cell.j + (corner & 1) * half, cell.level + 1});
  }
}

}  // namespace

CellPairs::CellPairs(SurfaceLevels& first, SurfaceLevels& second)
    : first_(&first),
      second_(&second),
      first_tree_(first.nested().grid.u.knots, first.nested().grid.v.knots),
      second_tree_(second.nested().grid.u.knots, second.nested().grid.v.knots) {
  // Each step down leaves one pair behind.
  node_pairs_.reserve(256);
  pairs_.reserve(cell_pair_capacity);
  finer_.reserve(cell_pair_capacity);
  counted_at_.assign(static_cast<std::size_t>(first.all_cells() + second.all_cells()), 0);
}

void CellPairs::begin_first() {
  first_tree_.update(first_->surface().net);
}

void CellPairs::begin_second() {
  second_tree_.update(second_->surface().net);
}

std::vector<CellPair>& CellPairs::within(double reach_m) {
  overflow_ = false;
  tighten(first_tree_, *first_, second_tree_, reach_m);
  tighten(second_tree_, *second_, first_tree_, reach_m);
  pairs_.clear();
  visit_elements([&] { return reach_m; },
                 [&](const CellPair& pair) {
                   overflow_ = overflow_ || pairs_.size() == cell_pair_capacity;
                   if (pairs_.size() < cell_pair_capacity) pairs_.push_back(pair);
                 });
  while (!all_meet() && refine(reach_m)) continue;
  keep_meeting_triangles(reach_m);
  return pairs_;
}

// The boxes of control points are several elements wide. Those of elements that the other surface could meet
// are taken from their corners instead.
void CellPairs::tighten(ElementTree& tree, SurfaceLevels& levels, const ElementTree& other, double reach) {
  const int step = levels.step(0);
  tree.tighten(other.box(other.root()), reach, [&](int element_u, int element_v) {
    levels.sample_column(element_v * step);
    levels.sample_column((element_v + 1) * step);
    const LevelCell cell{element_u * step, element_v * step, 0};
    const PatchCorners corners = levels.corners(cell);
    const Vector3 bulge = Vector3::Constant(levels.bulge(cell));
    const Vector3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).cwiseMin(corners[3]);
    const Vector3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).cwiseMax(corners[3]);
    return Box{low - bulge, high + bulge};
  });
}

CellPair CellPairs::elements(const std::array<int, 2>& nodes) const {
  const ElementTree::Node& a = first_tree_.node(nodes[0]);
  const ElementTree::Node& b = second_tree_.node(nodes[1]);
  const int step_a = first_->step(0), step_b = second_->step(0);
  return {{a.first_u * step_a, a.first_v * step_a, 0}, {b.first_u * step_b, b.first_v * step_b, 0}};
}

// The larger box in halves, beside the other.
std::array<std::array<int, 2>, 2> CellPairs::split(const std::array<int, 2>& nodes) const {
  const auto [a, b] = nodes;
  const ElementTree::Node& node_a = first_tree_.node(a);
  const ElementTree::Node& node_b = second_tree_.node(b);
  const bool split_a =
      node_b.is_leaf() || (!node_a.is_leaf() && first_tree_.box(a).size() >= second_tree_.box(b).size());
  if (split_a) return {{{node_a.left, b}, {node_a.right, b}}};
  return {{{a, node_b.left}, {a, node_b.right}}};
}

// One level down; false where both surfaces are at their finest.
bool CellPairs::refine(double reach) {
  if (pairs_.empty() || (first_->is_finest(pairs_[0].first) && second_->is_finest(pairs_[0].second))) {
    return false;
  }
  finer_.clear();
  for (const CellPair& pair : pairs_) {
    if (are_apart(pair, reach)) continue;
    for_each_finer(*first_, pair.first, [&](const LevelCell& a) {
      const CoverSphere& cover = first_->cover(a);
      for_each_finer(*second_, pair.second, [&](const LevelCell& b) {
        if (!meet(cover, second_->cover(b), reach)) return;
        overflow_ = overflow_ || finer_.size() == cell_pair_capacity;
        if (finer_.size() < cell_pair_capacity) finer_.push_back({a, b});
      });
    });
  }
  pairs_.swap(finer_);
  return true;
}

int CellPairs::cells_in(const SurfaceLevels& levels, LevelCell CellPair::*side, int offset) {
  int cells = 0;
  for (const CellPair& pair : pairs_) {
    std::uint32_t& counted = counted_at_[offset + levels.cell_index(pair.*side)];
    cells += counted == count_ ? 0 : 1;
    counted = count_;
  }
  return cells;
}

bool CellPairs::all_meet() {
  if (pairs_.size() <= few_pairs) return false;
  ++count_;
  return cells_in(*first_, &CellPair::first, 0) == first_->cell_count(pairs_[0].first.level) &&
         cells_in(*second_, &CellPair::second, first_->all_cells()) ==
             second_->cell_count(pairs_[0].second.level);
}

// By their spheres or, at a little more cost, by planes between their corners.
bool CellPairs::are_apart(const CellPair& pair, double reach) {
  if (!meet(first_->cover(pair.first), second_->cover(pair.second), reach)) return true;
  return patch_distance(first_->corners(pair.first), first_->bulge(pair.first), second_->corners(pair.second),
                        second_->bulge(pair.second)) > reach;
}

void CellPairs::keep_meeting_triangles(double reach) {
  const auto apart = [&](const CellPair& pair) {
    if (are_apart(pair, reach)) return true;
    const PatchCorners a = first_->corners(pair.first), b = second_->corners(pair.second);
    return !cells_meet(a, b,
                       triangle_slack(a, first_->bulge(pair.first)) +
                           triangle_slack(b, second_->bulge(pair.second)) + reach);
  };
  pairs_.erase(std::remove_if(pairs_.begin(), pairs_.end(), apart), pairs_.end());
}

}  // namespace spoonbill
