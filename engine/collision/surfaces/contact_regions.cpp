#include "engine/collision/surfaces/contact_regions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

constexpr std::size_t region_capacity = 64;

}  // namespace

ContactRegions::ContactRegions(const SurfaceLevels& first, const SurfaceLevels& second)
    : first_(&first), second_(&second) {
  const auto cells_around = [](const GridDirection& direction) {
    const int cells = direction.cell_count();
    return direction.knots.is_periodic() ? cells : std::numeric_limits<int>::max();
  };
  around_u_ = cells_around(second.nested().grid.u);
  around_v_ = cells_around(second.nested().grid.v);
  parent_.reserve(cell_pair_capacity);
  previous_.reserve(cell_pair_capacity);
  unordered_.reserve(cell_pair_capacity);
  cell_.reserve(cell_pair_capacity);
  paired_.resize(static_cast<std::size_t>(first.total_cell_count()));
  regions_.reserve(region_capacity);
  end_.reserve(region_capacity);
}

int ContactRegions::root(int pair) {
  while (parent_[pair] != pair) pair = parent_[pair] = parent_[parent_[pair]];
  return pair;
}

// `cell` and `other` are equal or neighbouring cells of the first surface. Joins the pairs of `cell` with the
// pairs of `other`. Two pairs are joined if their cells of the second surface are equal or neighbours, too.
void ContactRegions::join(const std::vector<CellPair>& pairs, const Paired& cell, const Paired& other) {
  const int step = second_->step(pairs[cell.last_pair].second.level);
  const bool same = &cell == &other, whole = !same && !cell.split && !other.split;
  if (whole && root(cell.last_pair) == root(other.last_pair)) return;
  for (int k = cell.last_pair; k >= 0; k = previous_[k]) {
    for (int m = same ? previous_[k] : other.last_pair; m >= 0; m = previous_[m]) {
      if (!are_neighbours(pairs[k].second, pairs[m].second, step)) continue;
      const int a = root(k), b = root(m);
      parent_[std::max(a, b)] = std::min(a, b);
      if (whole) return;
    }
  }
}

// Joins the pairs of the first cell of `pair` with the pairs of half of that cell's neighbours. The other
// neighbours are joined when they are visited.
void ContactRegions::join_neighbours(const std::vector<CellPair>& pairs, int pair) {
  const LevelCell& cell = pairs[pair].first;
  const Grid& grid = first_->nested().grid;
  const int step = first_->step(cell.level), here = cell_[pair];
  const int next = grid.u.wrap_cell(cell.i + step);
  const int columns[3] = {cell.j, grid.v.wrap_cell(cell.j + step), grid.v.wrap_cell(cell.j - step)};
  const auto offer = [&](int there) {
    if (paired_[there].at == group_) join(pairs, paired_[here], paired_[there]);
  };
  if (columns[1] >= 0) offer(first_->cell_index({cell.i, columns[1], cell.level}));
  if (next < 0) return;
  const int below = first_->cell_index({next, cell.j, cell.level}), shift = first_->shift(cell.level);
  for (const int column : columns) {
    if (column >= 0) offer(below + ((column - cell.j) >> shift));
  }
}

void ContactRegions::collect_cells(const std::vector<CellPair>& pairs) {
  ++group_;
  const std::size_t count = pairs.size();
  parent_.resize(count);
  previous_.resize(count);
  cell_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    cell_[k] = first_->cell_index(pairs[k].first);
    parent_[k] = k > 0 && pairs[k].region < 0 ? parent_[k - 1] : static_cast<int>(k);
    Paired& cell = paired_[cell_[k]];
    previous_[k] = cell.at == group_ ? cell.last_pair : -1;
    cell = {group_, static_cast<int>(k), false};
  }
}

const std::vector<ContactRegions::Region>& ContactRegions::group(std::vector<CellPair>& pairs) {
  const int count = static_cast<int>(pairs.size());
  collect_cells(pairs);
  // Each cell of the first surface is visited only once, at its first pair.
  for (int k = 0; k < count; ++k) {
    if (previous_[k] >= 0) continue;
    Paired& cell = paired_[cell_[k]];
    if (cell.last_pair == k) continue;
    join(pairs, cell, cell);
    for (int m = cell.last_pair; m >= 0; m = previous_[m]) cell.split = cell.split || root(m) != root(k);
  }
  for (int k = 0; k < count; ++k) {
    if (previous_[k] < 0) join_neighbours(pairs, k);
  }
  order_by_region(pairs);
  return regions_;
}

void ContactRegions::order_by_region(std::vector<CellPair>& pairs) {
  regions_.clear();
  end_.clear();
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
    const int first = root(k);
    if (first == k && regions_.size() < region_capacity) regions_.push_back({0, 0});
    pairs[k].region = first == k ? static_cast<int>(regions_.size()) - 1 : pairs[first].region;
    ++regions_[pairs[k].region].end;
  }
  std::size_t count = 0;
  for (Region& region : regions_) {
    region = {count, count + region.end};
    count = region.end;
    end_.push_back(static_cast<int>(region.begin));
  }
  unordered_.assign(pairs.begin(), pairs.end());
  for (const CellPair& pair : unordered_) pairs[end_[pair.region]++] = pair;
}

namespace {

constexpr std::size_t depth_seeds = 8;

// Range of the samples of the finest grid that are in some given cells.
struct SampleRange {
  int i0 = std::numeric_limits<int>::max(), i1 = 0, j0 = std::numeric_limits<int>::max(), j1 = 0;
  void widen(const LevelCell& cell, int step) {
    i0 = std::min(i0, cell.i);
    i1 = std::max(i1, cell.i + step);
    j0 = std::min(j0, cell.j);
    j1 = std::max(j1, cell.j + step);
  }
  ParameterRange to_parameters(const Grid& grid) const {
    return {grid.u.parameters[i0], grid.u.parameters[i1], grid.v.parameters[j0], grid.v.parameters[j1]};
  }
};

double cell_centre(const std::vector<double>& parameters, int at, int step) {
  return 0.5 * (parameters[at] + parameters[at + step]);
}

}  // namespace

PairParameters RegionCells::pair_centre(const CellPair& pair) const {
  const Grid& a = first->nested().grid;
  const Grid& b = second->nested().grid;
  const int step_a = first->step(pair.first.level), step_b = second->step(pair.second.level);
  return {
      cell_centre(a.u.parameters, pair.first.i, step_a), cell_centre(a.v.parameters, pair.first.j, step_a),
      cell_centre(b.u.parameters, pair.second.i, step_b), cell_centre(b.v.parameters, pair.second.j, step_b)};
}

RegionCells region_cells(const SurfaceLevels& first, const SurfaceLevels& second,
                         const std::vector<CellPair>& pairs, const ContactRegions::Region& region) {
  SPOONBILL_ASSERT(region.begin < region.end && region.end <= pairs.size());
  return {&first, &second, std::span(pairs).subspan(region.begin, region.end - region.begin)};
}

RegionRanges region_ranges(const RegionCells& cells) {
  SPOONBILL_ASSERT(!cells.pairs.empty());
  SampleRange first, second;
  for (const CellPair& pair : cells.pairs) {
    first.widen(pair.first, cells.first->step(pair.first.level));
    second.widen(pair.second, cells.second->step(pair.second.level));
  }
  return {first.to_parameters(cells.first->nested().grid), second.to_parameters(cells.second->nested().grid)};
}

PairParameters find_deepest_seed(const RegionCells& cells, const PairParameters& touch, double outside) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  const std::size_t seeds = cells.at_most(depth_seeds);
  PairParameters deepest = touch;
  double depth = 0.0;
  for (std::size_t k = 0; k < seeds; ++k) {
    const PairParameters at = cells.pair_centre(k, seeds);
    const double here = depth_behind(cells.first->pieces(), cells.second->pieces(), at, outside);
    if (!(here > depth)) continue;
    depth = here;
    deepest = at;
  }
  return deepest;
}

double facing_side(const Vector3& normal, const Vector3& own) {
  return normal.dot(own) < 0.0 ? 1.0 : -1.0;
}

}  // namespace spoonbill
