#include "engine/collision/contact_regions.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace spoonbill {
namespace {

constexpr std::size_t region_capacity = 64;

// The cell at i, brought back over the seam of a periodic direction; -1 beyond an end.
int into_grid(const GridDirection& direction, int i) {
  const int cells = static_cast<int>(direction.parameters.size()) - 1;
  if (i >= 0 && i < cells) return i;
  return direction.knots.is_periodic() ? (i + cells) % cells : -1;
}

// Whether two cells of one level are the same or have a corner in common.
bool are_neighbours(const SurfaceLevels& levels, const LevelCell& a, const LevelCell& b) {
  const auto near = [&](const GridDirection& direction, int i, int j) {
    const int cells = static_cast<int>(direction.parameters.size()) - 1, step = levels.step(a.level);
    const int apart = std::abs(i - j);
    return apart <= step || (direction.knots.is_periodic() && cells - apart <= step);
  };
  const Grid& grid = levels.nested().grid;
  return near(grid.u, a.i, b.i) && near(grid.v, a.j, b.j);
}

}  // namespace

ContactRegions::ContactRegions(const SurfaceLevels& first, const SurfaceLevels& second)
    : first_(&first), second_(&second) {
  parent_.reserve(cell_pair_capacity);
  first_pair_.assign(static_cast<std::size_t>(first.all_cells()), 0);
  paired_at_.assign(static_cast<std::size_t>(first.all_cells()), 0);
  regions_.reserve(region_capacity);
}

int ContactRegions::root(int pair) {
  while (parent_[pair] != pair) pair = parent_[pair] = parent_[parent_[pair]];
  return pair;
}

void ContactRegions::join_neighbours(const std::vector<CellPair>& pairs, int pair) {
  const LevelCell& cell = pairs[pair].first;
  const Grid& grid = first_->nested().grid;
  const int step = first_->step(cell.level);
  // The cell itself and half of its neighbours: the other half find it.
  for (int k = 0; k < 5; ++k) {
    const int i = into_grid(grid.u, cell.i + (k / 3 - 1) * step);
    const int j = into_grid(grid.v, cell.j + (k % 3 - 1) * step);
    if (i < 0 || j < 0) continue;
    const int there = first_->cell_index({i, j, cell.level});
    if (paired_at_[there] != group_) continue;
    for (std::size_t other = static_cast<std::size_t>(first_pair_[there]);
         other < pairs.size() && pairs[other].first_index == there; ++other) {
      if (!are_neighbours(*second_, pairs[pair].second, pairs[other].second)) continue;
      parent_[root(static_cast<int>(other))] = root(pair);
    }
  }
}

const std::vector<ContactRegions::Region>& ContactRegions::group(std::vector<CellPair>& pairs) {
  ++group_;
  regions_.clear();
  parent_.clear();
  const auto order = [&](const CellPair& pair) {
    return std::tie(pair.region, pair.first_index, pair.second_index);
  };
  const auto sort = [&] {
    std::sort(pairs.begin(), pairs.end(),
              [&](const CellPair& a, const CellPair& b) { return order(a) < order(b); });
  };
  for (CellPair& pair : pairs) {
    pair.first_index = first_->cell_index(pair.first);
    pair.second_index = second_->cell_index(pair.second);
  }
  sort();
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
    parent_.push_back(k);
    const int cell = pairs[k].first_index;
    if (paired_at_[cell] != group_) first_pair_[cell] = k;
    paired_at_[cell] = group_;
  }
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) join_neighbours(pairs, k);
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) pairs[k].region = root(k);
  sort();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const bool starts = k == 0 || pairs[k].region != pairs[k - 1].region;
    if (starts && regions_.size() < region_capacity) regions_.push_back({k, k});
    regions_.back().end = k + 1;
  }
  return regions_;
}

}  // namespace spoonbill
