#include "engine/collision/surface_proximity.h"

#include <algorithm>
#include <array>
#include <limits>

namespace spoonbill {
namespace {

constexpr std::size_t near_capacity = 4096;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The point of a triangle nearest to `point`, as shares of its edges from the first corner (Ericson 2005,
// 5.1.5).
std::array<double, 2> nearest_on_triangle(const Vector3& point, const Vector3& corner, const Vector3& edge_a,
                                          const Vector3& edge_b) {
  const Vector3 apart = point - corner;
  const double aa = edge_a.squaredNorm(), ab = edge_a.dot(edge_b), bb = edge_b.squaredNorm();
  const double pa = apart.dot(edge_a), pb = apart.dot(edge_b);
  const double determinant = aa * bb - ab * ab;
  const double s = determinant > 0.0 ? (bb * pa - ab * pb) / determinant : -1.0;
  const double t = determinant > 0.0 ? (aa * pb - ab * pa) / determinant : -1.0;
  if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return {s, t};
  const auto share = [](double along, double square) {
    return square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  };
  const double on_a = share(pa, aa), on_b = share(pb, bb);
  const Vector3 across = edge_b - edge_a;
  const double on_c = share((apart - edge_a).dot(across), across.squaredNorm());
  const std::array<std::array<double, 2>, 3> candidates = {{{on_a, 0.0}, {0.0, on_b}, {1.0 - on_c, on_c}}};
  return *std::min_element(candidates.begin(), candidates.end(), [&](const auto& one, const auto& other) {
    return (apart - one[0] * edge_a - one[1] * edge_b).squaredNorm() <
           (apart - other[0] * edge_a - other[1] * edge_b).squaredNorm();
  });
}

// Shares along u and v of a cell, of its point nearest to `point`.
struct OnCell {
  double u, v, distance;
};
OnCell nearest_on_cell(const Vector3& point, const PatchCorners& at) {
  const auto [a, b] = nearest_on_triangle(point, at[0], at[2] - at[0], at[1] - at[0]);
  const OnCell low{a, b, (point - at[0] - a * (at[2] - at[0]) - b * (at[1] - at[0])).norm()};
  const auto [c, d] = nearest_on_triangle(point, at[3], at[1] - at[3], at[2] - at[3]);
  const OnCell high{1.0 - c, 1.0 - d, (point - at[3] - c * (at[1] - at[3]) - d * (at[2] - at[3])).norm()};
  return low.distance <= high.distance ? low : high;
}

}  // namespace

SurfaceProximity::Side::Side(const NestedGrid& nested) : levels(nested) {
  const auto samples = static_cast<std::size_t>(nested.grid.rows() * nested.grid.columns());
  place.assign(samples, 0);
  placed_at.assign(samples, 0);
  near.reserve(near_capacity);
}

SurfaceProximity::SurfaceProximity(const NestedGrid& first, const NestedGrid& second)
    : first_(first), second_(second), cells_(first_.levels, second_.levels) {}

void SurfaceProximity::find(const Surface& first, const Surface& second, double margin_m,
                            double second_outside) {
  ++search_;
  least_gap_m_ = infinity;
  overflow_ = false;
  first_.near.clear();
  second_.near.clear();
  if (first_.levels.begin(first)) cells_.begin_first();
  if (second_.levels.begin(second)) cells_.begin_second();
  cells_.update();
  const ElementTree &one = cells_.first_tree(), &other = cells_.second_tree();
  if (one.box(one.root()).gap(other.box(other.root())) > margin_m) return;
  for (const CellPair& pair : cells_.within(margin_m)) {
    offer_corners(first_, pair.first, second_, pair.second);
    offer_corners(second_, pair.second, first_, pair.first);
  }
  overflow_ |= cells_.overflow();
  settle(first_, second_.levels, second_outside, margin_m);
  settle(second_, first_.levels, 1.0, margin_m);
  add_between_samples(first_, second_.levels, second_outside);
  add_between_samples(second_, first_.levels, 1.0);
}

// The corners of a cell against a cell of the other surface.
void SurfaceProximity::offer_corners(Side& side, const LevelCell& cell, Side& other, const LevelCell& patch) {
  const Grid& grid = side.levels.nested().grid;
  const Grid& of_patch = other.levels.nested().grid;
  const PatchCorners corners = other.levels.corners(patch);
  const int step = side.levels.step(cell.level), patch_step = other.levels.step(patch.level);
  const auto between = [](const std::vector<double>& parameters, int at, int to, double share) {
    return parameters[at] + share * (parameters[to] - parameters[at]);
  };
  for (int corner = 0; corner < 4; ++corner) {
    const int i = cell.i + (corner >> 1) * step, j = cell.j + (corner & 1) * step;
    const int sample = i * grid.columns() + j;
    const Vector3& point = side.levels.sample(sample);
    const OnCell on = nearest_on_cell(point, corners);
    if (side.placed_at[sample] != search_) {
      if (side.near.size() == near_capacity) {
        overflow_ = true;
        return;
      }
      side.placed_at[sample] = search_;
      side.place[sample] = static_cast<int>(side.near.size());
      side.near.push_back(
          {sample, grid.u.parameters[i], grid.v.parameters[j], 0.0, 0.0, point, Vector3::UnitY(), infinity});
    }
    // Until settle(), the distance to the other's triangles.
    NearPoint& near = side.near[side.place[sample]];
    if (on.distance >= near.gap_m) continue;
    near.gap_m = on.distance;
    near.other_u = between(of_patch.u.parameters, patch.i, patch.i + patch_step, on.u);
    near.other_v = between(of_patch.v.parameters, patch.j, patch.j + patch_step, on.v);
  }
}

// Each near sample against the other surface's point nearest to it; those that are not near after all go.
void SurfaceProximity::settle(Side& side, const SurfaceLevels& other, double outside, double margin) {
  std::size_t kept = 0;
  for (NearPoint near : side.near) {
    const NearestPoint nearest = nearest_point(other.pieces(), near.point_m, near.other_u, near.other_v);
    near.other_u = nearest.u;
    near.other_v = nearest.v;
    near.normal = outside * unit_normal(other.surface(), nearest.u, nearest.v);
    near.gap_m = (near.point_m - nearest.at.position_m).dot(near.normal);
    if (near.gap_m > margin) {
      side.placed_at[near.sample] = 0;
      continue;
    }
    least_gap_m_ = std::min(least_gap_m_, near.gap_m);
    side.place[near.sample] = static_cast<int>(kept);
    side.near[kept++] = near;
  }
  side.near.resize(kept);
}

bool SurfaceProximity::is_local_deepest(const Side& side, const NearPoint& near) const {
  const Grid& grid = side.levels.nested().grid;
  const int row = near.sample / grid.columns(), column = near.sample % grid.columns();
  for (int i = std::max(0, row - 1); i <= std::min(row + 1, grid.rows() - 1); ++i) {
    for (int j = std::max(0, column - 1); j <= std::min(column + 1, grid.columns() - 1); ++j) {
      const int sample = i * grid.columns() + j;
      if (sample == near.sample || side.placed_at[sample] != search_) continue;
      const double gap = side.near[side.place[sample]].gap_m;
      if (gap < near.gap_m || (gap == near.gap_m && sample < near.sample)) return false;
    }
  }
  return true;
}

// Between its samples a surface may be nearer than at any: from the nearest ones, on both surfaces
// themselves. deepest_pair() climbs from before the other surface too, where a gap is a depth below zero.
void SurfaceProximity::add_between_samples(Side& side, const SurfaceLevels& other, double outside) {
  const std::size_t samples = side.near.size();
  for (std::size_t s = 0; s < samples; ++s) {
    const NearPoint& near = side.near[s];
    if (!is_local_deepest(side, near)) continue;
    if (side.near.size() == near_capacity) {
      overflow_ = true;
      return;
    }
    const DeepestPair deepest = deepest_pair(side.levels.pieces(), other.pieces(),
                                             {near.u, near.v, near.other_u, near.other_v}, outside, infinity);
    const PairParameters& at = deepest.pair.at;
    side.near.push_back({-1, at.u, at.v, at.s, at.t, deepest.pair.first_m, deepest.normal, -deepest.depth_m});
    least_gap_m_ = std::min(least_gap_m_, -deepest.depth_m);
  }
}

}  // namespace spoonbill
