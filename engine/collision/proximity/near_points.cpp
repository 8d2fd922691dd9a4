#include "engine/collision/proximity/near_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/collision/proximity/nearest_on_cell.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {
namespace {

constexpr std::size_t near_capacity = 4096;
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

NearPoints::NearPoints(const NestedGrid& nested) : levels_(nested) {
  const auto samples = static_cast<std::size_t>(nested.grid.rows() * nested.grid.columns());
  place_.assign(samples, 0);
  placed_at_.assign(samples, 0);
  near_.reserve(near_capacity);
}

bool NearPoints::begin(const Surface& surface) {
  ++begun_;
  least_gap_m_ = infinity;
  overflow_ = false;
  near_.clear();
  return levels_.begin(surface);
}

void NearPoints::offer_corners(const LevelCell& cell, SurfaceLevels& other, const LevelCell& patch) {
  const PatchCorners corners = other.corners(patch);
  const int step = levels_.step(cell.level);
  for (int corner = 0; corner < 4; ++corner) {
    offer(cell.i + (corner >> 1) * step, cell.j + (corner & 1) * step, other, patch, corners);
  }
}

void NearPoints::offer(int i, int j, const SurfaceLevels& other, const LevelCell& patch,
                       const PatchCorners& corners) {
  SPOONBILL_ASSERT_DEBUG(i >= 0 && i < levels_.nested().grid.rows() && j >= 0 &&
                         j < levels_.nested().grid.columns());
  const Grid& grid = levels_.nested().grid;
  const int sample = i * grid.columns() + j;
  const Vector3 point = levels_.sample(sample);
  const OnCell on = nearest_on_cell(point, corners);
  if (placed_at_[sample] != begun_) {
    if (near_.size() == near_capacity) {
      overflow_ = true;
      return;
    }
    placed_at_[sample] = begun_;
    place_[sample] = static_cast<int>(near_.size());
    near_.push_back(
        {sample, grid.u.parameters[i], grid.v.parameters[j], 0.0, 0.0, point, Vector3::UnitY(), infinity});
  }
  // Until settle(), the distance to the other's triangles.
  NearPoint& near = near_[place_[sample]];
  if (on.distance >= near.gap_m) return;
  const auto between = [](const std::vector<double>& parameters, int at, int to, double share) {
    return parameters[at] + share * (parameters[to] - parameters[at]);
  };
  const Grid& of_patch = other.nested().grid;
  const int step = other.step(patch.level);
  near.gap_m = on.distance;
  near.other_u = between(of_patch.u.parameters, patch.i, patch.i + step, on.u);
  near.other_v = between(of_patch.v.parameters, patch.j, patch.j + step, on.v);
}

double NearPoints::offered_m(int sample) const {
  SPOONBILL_ASSERT_DEBUG(sample >= 0 &&
                         sample < levels_.nested().grid.rows() * levels_.nested().grid.columns());
  return placed_at_[sample] == begun_ ? near_[place_[sample]].gap_m : infinity;
}

void NearPoints::settle(const SurfaceLevels& other, double outside, double margin_m) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  SPOONBILL_ASSERT(margin_m >= 0.0);
  for (NearPoint& near : near_) {
    const NearestPoint nearest = nearest_point(other.pieces(), near.point_m, near.other_u, near.other_v);
    near.other_u = nearest.u;
    near.other_v = nearest.v;
    near.normal = outside * unit_normal(other.surface(), nearest.u, nearest.v);
    near.gap_m = (near.point_m - nearest.at.position_m).dot(near.normal);
  }
  keep_if([&](const NearPoint& near) { return !(near.gap_m > margin_m); });
}

bool NearPoints::is_local_deepest(const NearPoint& near) const {
  const Grid& grid = levels_.nested().grid;
  const int row = near.sample / grid.columns(), column = near.sample % grid.columns();
  for (int i = std::max(0, row - 1); i <= std::min(row + 1, grid.rows() - 1); ++i) {
    for (int j = std::max(0, column - 1); j <= std::min(column + 1, grid.columns() - 1); ++j) {
      const int sample = i * grid.columns() + j;
      if (sample == near.sample || placed_at_[sample] != begun_) continue;
      const double gap = near_[place_[sample]].gap_m;
      if (gap < near.gap_m || (gap == near.gap_m && sample < near.sample)) return false;
    }
  }
  return true;
}

// From the nearest samples, on both surfaces themselves. deepest_pair() climbs from before the other surface
// too, where a gap is a depth below zero.
void NearPoints::add_between_samples(const SurfaceLevels& other, double outside) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  const std::size_t samples = near_.size();
  for (std::size_t s = 0; s < samples; ++s) {
    const NearPoint& near = near_[s];
    if (!is_local_deepest(near)) continue;
    if (near_.size() == near_capacity) {
      overflow_ = true;
      return;
    }
    const DeepestPair deepest = deepest_pair(levels_.pieces(), other.pieces(),
                                             {near.u, near.v, near.other_u, near.other_v}, outside, infinity);
    const PairParameters& at = deepest.pair.at;
    near_.push_back({-1, at.u, at.v, at.s, at.t, deepest.pair.first_m, deepest.normal, -deepest.depth_m});
    least_gap_m_ = std::min(least_gap_m_, -deepest.depth_m);
  }
}

}  // namespace spoonbill
