#include <algorithm>
#include <tuple>

#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/solids/tool_bounds.h"

namespace spoonbill {
namespace {

// For the regions of one query.
constexpr int region_cut_capacity = 16000;

int cells_of(const GridDirection& direction) {
  return static_cast<int>(direction.parameters.size()) - 1;
}

// The cell at i, brought back over the seam of a periodic direction; -1 beyond an end.
int into_grid(const GridDirection& direction, int i) {
  const int cells = cells_of(direction);
  if (i >= 0 && i < cells) return i;
  return direction.knots.is_periodic() ? (i + cells) % cells : -1;
}

int cell_with(const GridDirection& direction, double parameter) {
  const auto& parameters = direction.parameters;
  const auto next = std::upper_bound(parameters.begin(), parameters.end(), parameter) - parameters.begin();
  return std::clamp(static_cast<int>(next) - 1, 0, cells_of(direction) - 1);
}

// One direction of a range, as far as it is known.
struct Reach {
  int low, high;  // cells

  void widen(int cell) {
    low = std::min(low, cell);
    high = std::max(high, cell);
  }
  double start(const GridDirection& direction) const { return direction.parameters[low]; }
  double end(const GridDirection& direction) const { return direction.parameters[high + 1]; }
};

}  // namespace

void SurfaceCollider::reserve_regions() {
  const Grid& grid = levels_.nested().grid;
  const std::size_t cells = static_cast<std::size_t>(cells_of(grid.u) * cells_of(grid.v));
  touched_index_.assign(cells, 0);
  touched_at_.assign(cells, 0);
  touched_.reserve(cells_.capacity());
  grouped_.reserve(cells_.capacity());
  regions_.reserve(tool_region_capacity);
}

int SurfaceCollider::finest_index(int i, int j) const {
  return i * cells_of(levels_.nested().grid.v) + j;
}

int SurfaceCollider::region_at(double u, double v) const {
  const Grid& grid = levels_.nested().grid;
  const int index = finest_index(cell_with(grid.u, u), cell_with(grid.v, v));
  return touched_at_[index] == query_ ? touched_[touched_index_[index]].region : -1;
}

// Cut until a corner touches or no patch can.
bool SurfaceCollider::touches(const Surface& surface, const ToolShape& tool, const LevelCell& cell) {
  if (is_cut(cell)) return touches_cut(surface, tool, cell);
  patches_.clear();
  patches_.push_back(whole(cell));
  while (!patches_.empty()) {
    const Patch patch = patches_.back();
    patches_.pop_back();
    for (const Vector3& corner : patch.corners) {
      if (tool.distance_within(corner, 2.0 * touch_tolerance_m) <= touch_tolerance_m) return true;
    }
    if (lower_bound(tool, patch.corners, bulge(patch), 0.0) > 0.0) continue;
    if (!can_cut(patch)) {
      regions_overflow_ = true;
      continue;
    }
    cut(surface, patch, position(surface, 0.5 * (patch.u0 + patch.u1), 0.5 * (patch.v0 + patch.v1)));
  }
  return false;
}

void SurfaceCollider::take_touched(const Surface& surface, const ToolShape& tool) {
  touched_.clear();
  for (const LevelCell& cell : finest_) {
    if (!touches(surface, tool, cell)) continue;
    const int index = finest_index(cell.i, cell.j);
    touched_index_[index] = static_cast<int>(touched_.size());
    touched_at_[index] = query_;
    touched_.push_back({cell, -1});
  }
}

// All cells that hang together with one, across a seam too, come after each other in grouped_.
void SurfaceCollider::join_neighbours(int first, int region) {
  const Grid& grid = levels_.nested().grid;
  std::size_t next = grouped_.size();
  touched_[first].region = region;
  grouped_.push_back(first);
  for (; next < grouped_.size(); ++next) {
    const LevelCell cell = touched_[grouped_[next]].cell;
    for (int k = 0; k < 9; ++k) {
      const int i = into_grid(grid.u, cell.i + k / 3 - 1), j = into_grid(grid.v, cell.j + k % 3 - 1);
      if (i < 0 || j < 0) continue;
      const int index = finest_index(i, j);
      if (touched_at_[index] != query_) continue;
      TouchedCell& neighbour = touched_[touched_index_[index]];
      if (neighbour.region >= 0) continue;
      neighbour.region = region;
      grouped_.push_back(touched_index_[index]);
    }
  }
}

void SurfaceCollider::add_region(const Surface& surface, const ToolShape& tool, int begin, int end) {
  const Grid& grid = levels_.nested().grid;
  const LevelCell& first = touched_[grouped_[begin]].cell;
  Reach along_u{first.i, first.i}, along_v{first.j, first.j};
  best_ = {};
  best_.distance_m = std::numeric_limits<double>::infinity();
  for (int k = begin; k < end; ++k) {
    const LevelCell& cell = touched_[grouped_[k]].cell;
    along_u.widen(cell.i);
    along_v.widen(cell.j);
    for (int corner = 0; corner < 4; ++corner) {
      const int i = cell.i + (corner >> 1), j = cell.j + (corner & 1);
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  }
  RimEdges rim;
  for (int k = begin; k < end; ++k) {
    if (is_cut(touched_[grouped_[k]].cell)) offer_rim(surface, tool, touched_[grouped_[k]].cell, rim);
  }
  narrow(surface, tool, rim);
  region_ = touched_[grouped_[begin]].region;
  polish(surface, tool);
  for (int k = begin; k < end; ++k) {
    search_between_samples(surface, tool, touched_[grouped_[k]].cell, regions_overflow_);
  }
  region_ = -1;
  const ParameterRange range{along_u.start(grid.u), along_u.end(grid.u), along_v.start(grid.v),
                             along_v.end(grid.v)};
  regions_.push_back({range, contact_at(surface, best_)});
}

const std::vector<ToolContactRegion>& SurfaceCollider::take_regions(const Surface& surface,
                                                                    const ToolShape& tool) {
  regions_.clear();
  grouped_.clear();
  regions_overflow_ = false;
  proof_ = Proof::deepest;
  cuts_left_ = region_cut_capacity;
  take_touched(surface, tool);
  for (int k = 0; k < static_cast<int>(touched_.size()); ++k) {
    if (touched_[k].region >= 0) continue;
    if (regions_.size() == tool_region_capacity) {
      regions_overflow_ = true;
      break;
    }
    const int begin = static_cast<int>(grouped_.size());
    join_neighbours(k, static_cast<int>(regions_.size()));
    add_region(surface, tool, begin, static_cast<int>(grouped_.size()));
  }
  std::sort(regions_.begin(), regions_.end(), [](const ToolContactRegion& a, const ToolContactRegion& b) {
    return std::tie(b.deepest.depth_m, a.deepest.u, a.deepest.v) <
           std::tie(a.deepest.depth_m, b.deepest.u, b.deepest.v);
  });
  return regions_;
}

}  // namespace spoonbill
