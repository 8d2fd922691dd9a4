#include "engine/collision/contact_regions.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace spoonbill {
namespace {

constexpr std::size_t region_capacity = 64;

// The cell at i, brought back over the seam of a periodic direction; -1 beyond an end.
int into_grid(const GridDirection& direction, int i) {
  const int cells = static_cast<int>(direction.parameters.size()) - 1;
  if (i >= 0 && i < cells) return i;
  return direction.knots.is_periodic() ? (i + cells) % cells : -1;
}

}  // namespace

ContactRegions::ContactRegions(const SurfaceLevels& first, const SurfaceLevels& second)
    : first_(&first), second_(&second) {
  const auto cells_around = [](const GridDirection& direction) {
    const int cells = static_cast<int>(direction.parameters.size()) - 1;
    return direction.knots.is_periodic() ? cells : std::numeric_limits<int>::max();
  };
  around_u_ = cells_around(second.nested().grid.u);
  around_v_ = cells_around(second.nested().grid.v);
  parent_.reserve(cell_pair_capacity);
  previous_.reserve(cell_pair_capacity);
  unordered_.reserve(cell_pair_capacity);
  last_pair_.assign(static_cast<std::size_t>(first.all_cells()), 0);
  split_.assign(static_cast<std::size_t>(first.all_cells()), false);
  paired_at_.assign(static_cast<std::size_t>(first.all_cells()), 0);
  regions_.reserve(region_capacity);
  end_.reserve(region_capacity);
}

int ContactRegions::root(int pair) {
  while (parent_[pair] != pair) pair = parent_[pair] = parent_[parent_[pair]];
  return pair;
}

// Joins pairs of two cells of the first surface, the same or neighbours.
void ContactRegions::join(const std::vector<CellPair>& pairs, int cell, int other) {
  const int step = second_->step(pairs[last_pair_[cell]].second.level);
  const bool whole = cell != other && !split_[cell] && !split_[other];
  if (whole && root(last_pair_[cell]) == root(last_pair_[other])) return;
  for (int k = last_pair_[cell]; k >= 0; k = previous_[k]) {
    for (int m = cell == other ? previous_[k] : last_pair_[other]; m >= 0; m = previous_[m]) {
      if (!are_neighbours(pairs[k].second, pairs[m].second, step)) continue;
      const int a = root(k), b = root(m);
      parent_[std::max(a, b)] = std::min(a, b);
      if (whole) return;
    }
  }
}

// The cell itself and half of its neighbours: the other half find it.
void ContactRegions::join_neighbours(const std::vector<CellPair>& pairs, int pair) {
  const LevelCell& cell = pairs[pair].first;
  const Grid& grid = first_->nested().grid;
  const int step = first_->step(cell.level), here = first_->cell_index(cell);
  constexpr int steps[4][2] = {{0, 1}, {1, -1}, {1, 0}, {1, 1}};
  for (const auto& [along_u, along_v] : steps) {
    const int i = into_grid(grid.u, cell.i + along_u * step);
    const int j = into_grid(grid.v, cell.j + along_v * step);
    if (i < 0 || j < 0) continue;
    const int there = first_->cell_index({i, j, cell.level});
    if (paired_at_[there] == group_) join(pairs, here, there);
  }
}

const std::vector<ContactRegions::Region>& ContactRegions::group(std::vector<CellPair>& pairs) {
  ++group_;
  parent_.clear();
  previous_.clear();
  const int count = static_cast<int>(pairs.size());
  for (int k = 0; k < count; ++k) {
    const int cell = first_->cell_index(pairs[k].first);
    parent_.push_back(k > 0 && pairs[k].region < 0 ? parent_[k - 1] : k);
    previous_.push_back(paired_at_[cell] == group_ ? last_pair_[cell] : -1);
    last_pair_[cell] = k;
    paired_at_[cell] = group_;
  }
  // Each cell once, by its first pair.
  for (int k = 0; k < count; ++k) {
    if (previous_[k] >= 0) continue;
    const int cell = first_->cell_index(pairs[k].first);
    split_[cell] = false;
    if (last_pair_[cell] == k) continue;
    join(pairs, cell, cell);
    for (int m = last_pair_[cell]; m >= 0; m = previous_[m]) {
      split_[cell] = split_[cell] || root(m) != root(k);
    }
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

}  // namespace spoonbill
