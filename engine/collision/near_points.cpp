#include "engine/collision/near_points.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/collision/pair_polish.h"

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
  return placed_at_[sample] == begun_ ? near_[place_[sample]].gap_m : infinity;
}

void NearPoints::settle(const SurfaceLevels& other, double outside, double margin_m) {
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
