#include "engine/collision/surfaces/contact_regions.h"

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
  cell_.reserve(cell_pair_capacity);
  paired_.resize(static_cast<std::size_t>(first.all_cells()));
  regions_.reserve(region_capacity);
  end_.reserve(region_capacity);
}

int ContactRegions::root(int pair) {
  while (parent_[pair] != pair) pair = parent_[pair] = parent_[parent_[pair]];
  return pair;
}

// Joins pairs of two cells of the first surface, the same or neighbours.
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

// The cell itself and half of its neighbours: the other half find it.
void ContactRegions::join_neighbours(const std::vector<CellPair>& pairs, int pair) {
  const LevelCell& cell = pairs[pair].first;
  const Grid& grid = first_->nested().grid;
  const int step = first_->step(cell.level), here = cell_[pair];
  const int next = into_grid(grid.u, cell.i + step);
  const int columns[3] = {cell.j, into_grid(grid.v, cell.j + step), into_grid(grid.v, cell.j - step)};
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

void ContactRegions::take_cells(const std::vector<CellPair>& pairs) {
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
  take_cells(pairs);
  // Each cell once, by its first pair.
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

}  // namespace spoonbill
