#include "engine/collision/proximity/surface_proximity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

namespace {

// Returns the weights a and b with which corner + a edge_a + b edge_b is the point of the triangle nearest to
// `point`. Unlike nearest_on_triangle(), accepts triangles without area, which cells have at poles.
std::array<double, 2> nearest_edge_weights(const Vector3& point, const Vector3& corner, const Vector3& edge_a,
                                           const Vector3& edge_b) {
  const Vector3 offset = point - corner;
  const double aa = edge_a.squaredNorm(), ab = edge_a.dot(edge_b), bb = edge_b.squaredNorm();
  const double pa = offset.dot(edge_a), pb = offset.dot(edge_b);
  const double determinant = aa * bb - ab * ab;
  const double s = determinant > 0.0 ? (bb * pa - ab * pb) / determinant : -1.0;
  const double t = determinant > 0.0 ? (aa * pb - ab * pa) / determinant : -1.0;
  if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return {s, t};
  const auto fraction = [](double along, double square) {
    return square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  };
  const double on_a = fraction(pa, aa), on_b = fraction(pb, bb);
  const Vector3 across = edge_b - edge_a;
  const double on_c = fraction((offset - edge_a).dot(across), across.squaredNorm());
  const std::array<std::array<double, 2>, 3> candidates = {{{on_a, 0.0}, {0.0, on_b}, {1.0 - on_c, on_c}}};
  return *std::min_element(candidates.begin(), candidates.end(), [&](const auto& one, const auto& other) {
    return (offset - one[0] * edge_a - one[1] * edge_b).squaredNorm() <
           (offset - other[0] * edge_a - other[1] * edge_b).squaredNorm();
  });
}

}  // namespace

NearestOnCell nearest_on_cell(const Vector3& point, const PatchCorners& at) {
  const auto [a, b] = nearest_edge_weights(point, at[0], at[2] - at[0], at[1] - at[0]);
  const NearestOnCell low{a, b, (point - at[0] - a * (at[2] - at[0]) - b * (at[1] - at[0])).norm()};
  const auto [c, d] = nearest_edge_weights(point, at[3], at[1] - at[3], at[2] - at[3]);
  const NearestOnCell high{1.0 - c, 1.0 - d,
                           (point - at[3] - c * (at[1] - at[3]) - d * (at[2] - at[3])).norm()};
  return low.distance <= high.distance ? low : high;
}

NearPoints::NearPoints(const NestedGrid& nested, SkippedSamples skipped)
    : levels_(nested), skipped_(std::move(skipped)) {
  const auto samples = static_cast<std::size_t>(nested.grid.rows() * nested.grid.columns());
  SPOONBILL_ASSERT(skipped_.empty() || skipped_.size() == samples);
  index_.assign(samples, 0);
  indexed_at_.assign(samples, 0);
  near_.reserve(near_point_limit);
  candidates_.reserve(near_point_limit);
  followed_.reserve(near_point_limit);
}

bool NearPoints::begin(const Surface& surface) {
  ++generation_;
  budget_ = {proximity_evaluation_limit, proximity_least_gain_m};
  least_gap_m_ = infinity;
  overflow_ = false;
  near_.clear();
  followed_.clear();
  return levels_.begin(surface);
}

void NearPoints::add_sample(const NearPoint& near) {
  indexed_at_[near.sample] = generation_;
  index_[near.sample] = static_cast<int>(near_.size());
  near_.push_back(near);
}

void NearPoints::follow(const SurfaceLevels& other) {
  SPOONBILL_ASSERT(near_.empty());
  const Grid& grid = levels_.nested().grid;
  for (const Candidate& candidate : candidates_) {
    if (budget_.is_spent()) return;
    add_sample({candidate.sample, grid.u.parameters[candidate.sample / grid.columns()],
                grid.v.parameters[candidate.sample % grid.columns()], candidate.other_u, candidate.other_v,
                levels_.sample(candidate.sample)});
    followed_.push_back({find_nearest(other, near_.back()), true});
  }
}

double NearPoints::find_nearest(const SurfaceLevels& other, NearPoint& near) {
  const NearestPoint nearest =
      nearest_point(other.pieces(), near.point_m, near.other_u, near.other_v, &budget_);
  near.other_u = nearest.u;
  near.other_v = nearest.v;
  near.other_m = nearest.at.position_m;
  near.normal = unit_normal(other.pieces(), nearest.at, nearest.u, nearest.v);
  const Vector3 difference = near.point_m - near.other_m;
  near.gap_m = difference.norm();
  return difference.dot(near.normal);
}

void NearPoints::offer_corners(const LevelCell& cell, SurfaceLevels& other, const LevelCell& patch,
                               double margin_m) {
  const int step = levels_.step(cell.level);
  const int rows = levels_.nested().grid.rows(), columns = levels_.nested().grid.columns();
  std::array<LevelCell, 4> offered;
  std::size_t count = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int i = cell.i + (corner >> 1) * step, j = cell.j + (corner & 1) * step;
    // Another cell near the patch has this corner as its first one.
    if ((i > cell.i && i < rows - 1) || (j > cell.j && j < columns - 1)) continue;
    if (!is_skipping_ || !is_skipped(skipped_, i * columns + j)) offered[count++] = {i, j, cell.level};
  }
  if (count == 0) return;
  const PatchCorners corners = other.corners(patch);
  Box box;
  for (const Vector3& corner : corners) box.include(corner);
  const double reach_m = margin_m + other.bulge(patch);
  for (std::size_t c = 0; c < count; ++c) {
    const auto [i, j, level] = offered[c];
    const int sample = i * columns + j;
    const double least_m = std::min(reach_m, offered_distance_m(sample));
    if (!(box.squared_distance(levels_.sample(sample)) < least_m * least_m)) continue;
    offer(i, j, other, patch, corners);
  }
}

void NearPoints::offer(int i, int j, const SurfaceLevels& other, const LevelCell& patch,
                       const PatchCorners& corners) {
  SPOONBILL_ASSERT_DEBUG(i >= 0 && i < levels_.nested().grid.rows() && j >= 0 &&
                         j < levels_.nested().grid.columns());
  const Grid& grid = levels_.nested().grid;
  const int sample = i * grid.columns() + j;
  const Vector3 point = levels_.sample(sample);
  const NearestOnCell on = nearest_on_cell(point, corners);
  if (on.distance >= offered_distance_m(sample)) return;
  if (indexed_at_[sample] != generation_) {
    if (near_.size() == near_point_limit) {
      overflow_ = true;
      return;
    }
    add_sample({sample, grid.u.parameters[i], grid.v.parameters[j], 0.0, 0.0, point});
  }
  const auto between = [](const std::vector<double>& parameters, int at, int to, double fraction) {
    return parameters[at] + fraction * (parameters[to] - parameters[at]);
  };
  const Grid& patch_grid = other.nested().grid;
  const int step = other.step(patch.level), index = index_[sample];
  NearPoint& near = near_[index];
  near.gap_m = on.distance;
  near.other_u = between(patch_grid.u.parameters, patch.i, patch.i + step, on.u);
  near.other_v = between(patch_grid.v.parameters, patch.j, patch.j + step, on.v);
  if (is_followed(index)) followed_[index].is_nearest = false;
}

double NearPoints::offered_distance_m(int sample) const {
  SPOONBILL_ASSERT_DEBUG(sample >= 0 &&
                         sample < levels_.nested().grid.rows() * levels_.nested().grid.columns());
  if (indexed_at_[sample] != generation_) return infinity;
  const int index = index_[sample];
  // A cell deviates from the exact surface, and would otherwise replace a point on it that is as near.
  const double least_gain_m = is_followed(index) && followed_[index].is_nearest ? touch_tolerance_m : 0.0;
  return std::max(near_[index].gap_m - least_gain_m, 0.0);
}

namespace {

// Largest depth at which a sample is still followed, as a multiple of the reach. A sample that is far behind
// a wall may be in front of another one.
constexpr double deepest_followed = 2.0;

}  // namespace

void NearPoints::compute_nearest(const SurfaceLevels& other, double outside, double margin_m,
                                 double reach_m) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  SPOONBILL_ASSERT(margin_m >= 0.0 && reach_m >= margin_m);
  candidates_.clear();
  for (std::size_t n = 0; n < near_.size(); ++n) {
    NearPoint& near = near_[n];
    const bool is_known = n < followed_.size() && followed_[n].is_nearest;
    near.gap_m = outside * (is_known ? followed_[n].height_m : find_nearest(other, near));
    near.normal *= outside;
    // A sample beside the rim of a shell may be far from it at a small gap.
    const double most_m = near.gap_m < 0.0 ? deepest_followed * reach_m : reach_m;
    if ((near.point_m - near.other_m).norm() <= most_m) {
      candidates_.push_back({near.sample, near.other_u, near.other_v});
    }
  }
  keep_if([&](const NearPoint& near) { return !(near.gap_m > margin_m); });
}

bool NearPoints::is_local_deepest(const NearPoint& near) const {
  bool is_deepest = true;
  visit_around(near.sample, [&](int sample) {
    if (sample == near.sample || indexed_at_[sample] != generation_) return;
    const double gap = near_[index_[sample]].gap_m;
    if (gap < near.gap_m || (gap == near.gap_m && sample < near.sample)) is_deepest = false;
  });
  return is_deepest;
}

double NearPoints::smallest_gap_around(double u, double v) const {
  const Grid& grid = levels_.nested().grid;
  const int row = grid.u.find_cell(u), column = grid.v.find_cell(v);
  double smallest = infinity;
  for (int corner = 0; corner < 4; ++corner) {
    const int sample = (row + (corner >> 1)) * grid.columns() + column + (corner & 1);
    if (indexed_at_[sample] == generation_) smallest = std::min(smallest, near_[index_[sample]].gap_m);
  }
  return smallest;
}

double NearPoints::find_spacing_m(int sample) {
  const Vector3 here = levels_.sample(sample);
  double square = 0.0;
  visit_around(sample,
               [&](int around) { square = std::max(square, (levels_.sample(around) - here).squaredNorm()); });
  return std::sqrt(square);
}

// Starts a search on the exact surfaces from each sample that is deeper than its neighbours. deepest_pair()
// can also start at points in front of the other surface, where the depth is negative. A search that ends
// beyond the neighbours has found another place, such as a pair of points far from each other whose
// connection is normal to both surfaces.
void NearPoints::add_between_samples(const NearPoints& other, double outside) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  const std::size_t samples = near_.size();
  for (std::size_t s = 0; s < samples; ++s) {
    const NearPoint& near = near_[s];
    if (!is_local_deepest(near)) continue;
    if (budget_.is_spent()) return;
    if (near_.size() == near_point_limit) {
      overflow_ = true;
      return;
    }
    const DeepestPair deepest =
        deepest_pair(levels_.pieces(), other.levels().pieces(), {near.u, near.v, near.other_u, near.other_v},
                     outside, infinity, &budget_);
    if ((deepest.pair.first_m - near.point_m).norm() > find_spacing_m(near.sample)) continue;
    const PairParameters& at = deepest.pair.at;
    const double gap_m = -deepest.depth_m;
    const double around_m =
        std::min({near.gap_m, smallest_gap_around(at.u, at.v), other.smallest_gap_around(at.s, at.t)});
    near_.push_back({-1, at.u, at.v, at.s, at.t, deepest.pair.first_m, deepest.pair.second_m, deepest.normal,
                     gap_m, around_m - gap_m, near_[s].sample});
    least_gap_m_ = std::min(least_gap_m_, -deepest.depth_m);
  }
}

namespace {

// Samples are followed only if the surfaces move so slowly that cells need not be searched in this number of
// calls. Otherwise the larger reach of the search would cost more than it saves. On the denser grid of a
// surface with samples to skip, a search costs more.
constexpr int least_followed = 16, least_followed_if_dense = 6;

int control_points(const NestedGrid& nested) {
  return nested.grid.u.knots.control_point_count() * nested.grid.v.knots.control_point_count();
}

}  // namespace

SurfaceProximity::SurfaceProximity(const NestedGrid& first, const NestedGrid& second,
                                   SkippedSamples first_skipped, SkippedSamples second_skipped)
    : first_(first, std::move(first_skipped)),
      second_(second, std::move(second_skipped)),
      least_followed_(first_.has_skipped() || second_.has_skipped() ? least_followed_if_dense
                                                                    : least_followed),
      cells_(first_.levels(), second_.levels()),
      first_motion_(control_points(first)),
      second_motion_(control_points(second)) {}

void SurfaceProximity::find(const Surface& first, const Surface& second, double margin_m,
                            double second_outside, const Pose& frame) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  SPOONBILL_ASSERT(std::abs(second_outside) == 1.0);
  if (first_.begin(first)) cells_.invalidate_first();
  if (second_.begin(second)) cells_.invalidate_second();
  const double moved_m = first_motion_.since_m(first.net, frame) + second_motion_.since_m(second.net, frame);
  const bool is_searched = margin_m + moved_m <= searched_m_;
  ++finds_;
  bool is_fresh = false;
  if (!is_searched) {
    // Surfaces that have jumped may now be near in other places.
    is_fresh = !(moved_m <= searched_m_);
    if (is_fresh) forget();
    const bool is_slow = least_followed_ * moved_m <= finds_ * margin_m;
    searched_m_ = is_slow && !is_crowded_ ? 2.0 * margin_m : margin_m;
    finds_ = 0;
    first_motion_.remember(first.net, frame);
    second_motion_.remember(second.net, frame);
  }
  first_.follow(second_.levels());
  second_.follow(first_.levels());
  if (!is_searched) search_cells(searched_m_, is_fresh);
  // Candidates remain so until the next search of cells, because they may come near again.
  const double reach_m = is_searched ? infinity : searched_m_;
  first_.compute_nearest(second_.levels(), second_outside, margin_m, reach_m);
  second_.compute_nearest(first_.levels(), 1.0, margin_m, reach_m);
  first_.add_between_samples(second_, second_outside);
  second_.add_between_samples(first_, 1.0);
  if (!overflow()) return;
  is_crowded_ = true;
  searched_m_ = -1.0;  // candidates may be missing
}

void SurfaceProximity::set_skipping(bool first, bool second) {
  if (first == first_.is_skipping() && second == second_.is_skipping()) return;
  first_.set_skipping(first);
  second_.set_skipping(second);
  forget();
}

void SurfaceProximity::forget() {
  first_.forget();
  second_.forget();
  first_motion_.forget();
  second_motion_.forget();
  searched_m_ = -1.0;
}

void SurfaceProximity::search_cells(double reach_m, bool is_fresh) {
  ++cell_searches_;
  missing_cells_ = false;
  cells_.update();
  const ElementTree &one = cells_.first_tree(), &other = cells_.second_tree();
  if (one.box(one.root()).gap(other.box(other.root())) > reach_m) return;
  // Bodies that begin in each other have samples that are deeper than the reach.
  const double corner_m = is_fresh ? infinity : reach_m;
  for (const CellPair& pair : cells_.find_within(reach_m)) {
    first_.offer_corners(pair.first, second_.levels(), pair.second, corner_m);
    second_.offer_corners(pair.second, first_.levels(), pair.first, corner_m);
  }
  missing_cells_ = cells_.overflow();
}

double SurfaceProximity::least_gap_m() const {
  return std::min(first_.least_gap_m(), second_.least_gap_m());
}

}  // namespace spoonbill
