#include "engine/collision/surfaces/surface_self_collider.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/collision/levels/patch_distance.h"

namespace spoonbill {
namespace {

constexpr std::size_t contact_capacity = 64;
// Of more, a coarser level tells as much.
constexpr std::size_t fine_pairs = 1 << 17;
// Candidates of a region from which Newton's method looks for a touch before all of it is searched.
constexpr std::size_t region_seeds = 8;
constexpr double infinity = std::numeric_limits<double>::infinity();

int cell_count(const GridDirection& direction) {
  return static_cast<int>(direction.parameters.size()) - 1;
}

int cell_of(const GridDirection& direction, double parameter) {
  const std::vector<double>& all = direction.parameters;
  const auto next = std::upper_bound(all.begin(), all.end(), parameter) - all.begin();
  return std::clamp(static_cast<int>(next) - 1, 0, cell_count(direction) - 1);
}

bool are_same(const LevelCell& a, const LevelCell& b) {
  return a.i == b.i && a.j == b.j;
}

}  // namespace

SurfaceSelfCollider::SurfaceSelfCollider(const NestedGrid& nested)
    : levels_(nested),
      tree_(nested.grid.u.knots, nested.grid.v.knots),
      folds_(levels_),
      not_joined_(*this),
      search_(levels_, levels_, &not_joined_),
      regions_(levels_, levels_) {
  pairs_.reserve(cell_pair_capacity);
  // Each step down leaves two pairs of nodes behind, or fifteen of cells.
  nodes_.reserve(256);
  path_.reserve(static_cast<std::size_t>(16 * (2 + nested.levels)));
  contacts_.reserve(contact_capacity);
}

SelfResult SurfaceSelfCollider::collide(const Surface& surface, const SelfQuery& query) {
  contacts_.clear();
  query_ = &query;
  stopped_ = false;
  levels_.begin(surface);
  folds_.begin();
  tree_.update(levels_);
  u_ = joints_of(true);
  v_ = joints_of(false);
  search_.begin();
  int level = levels_.nested().levels;
  take_pairs(level);
  // Coarser, cells that are joined are larger, and what they do with each other is not told.
  const bool coarser = overflow_;
  while (overflow_ && level > 0 && !stopped_) take_pairs(--level);
  const std::vector<Region>& regions = regions_.group(pairs_);
  for (const Region& region : regions) {
    const RegionCells cells = cells_of(levels_, levels_, pairs_, region);
    if (stopped_) break;
    if (is_mirror_of_earlier(region) || !touches(cells)) continue;
    contacts_.push_back(contact_of(cells, query));
  }
  query_ = nullptr;
  return {!contacts_.empty(), coarser || search_.overflow(), stopped_};
}

// Not for every pair: to look for a signal is a call of the system.
bool SurfaceSelfCollider::goes_on(double fraction) {
  constexpr std::uint64_t between_looks = 64;
  if (!stopped_ && asked_++ % between_looks == 0) stopped_ = !query_->progress.report(fraction);
  return !stopped_;
}

// By the samples of the two edges.
SurfaceSelfCollider::Joints SurfaceSelfCollider::joints_of(bool in_u) {
  const Grid& grid = levels_.nested().grid;
  const GridDirection& direction = in_u ? grid.u : grid.v;
  if (direction.knots.is_periodic()) return {true, false, false};
  const int last = cell_count(direction), count = in_u ? grid.columns() : grid.rows();
  const auto sample = [&](int across, int along) {
    return levels_.sample(in_u ? across * grid.columns() + along : along * grid.columns() + across);
  };
  Joints joints{true, true, true};
  for (int k = 0; k < count; ++k) {
    const Vector3 low = sample(0, k), high = sample(last, k);
    joints.seam &= (low - high).norm() <= touch_tolerance_m;
    joints.low_pole &= (low - sample(0, 0)).norm() <= touch_tolerance_m;
    joints.high_pole &= (high - sample(last, 0)).norm() <= touch_tolerance_m;
  }
  return joints;
}

bool SurfaceSelfCollider::are_joined(const LevelCell& a, const LevelCell& b) const {
  const Grid& grid = levels_.nested().grid;
  const int step = levels_.step(a.level);
  const auto beside = [&](int one, int other, int cells, bool seam) {
    const int apart = std::abs(one - other);
    return apart <= step || (seam && cells - apart <= step);
  };
  const auto in_one_pole = [&](int one, int other, int cells, const Joints& joints) {
    return (joints.low_pole && one == 0 && other == 0) ||
           (joints.high_pole && one == cells - step && other == cells - step);
  };
  const int cells_u = cell_count(grid.u), cells_v = cell_count(grid.v);
  return (beside(a.i, b.i, cells_u, u_.seam) && beside(a.j, b.j, cells_v, v_.seam)) ||
         in_one_pole(a.i, b.i, cells_u, u_) || in_one_pole(a.j, b.j, cells_v, v_);
}

LevelCell SurfaceSelfCollider::cell_at(double u, double v) const {
  const NestedGrid& nested = levels_.nested();
  return {cell_of(nested.grid.u, u), cell_of(nested.grid.v, v), nested.levels};
}

bool SurfaceSelfCollider::NotJoined::counts(const PairParameters& at) const {
  return !of_->are_joined(of_->cell_at(at.u, at.v), of_->cell_at(at.s, at.t));
}

// All pairs of cells of the level that could meet, each both ways round.
void SurfaceSelfCollider::take_pairs(int level) {
  pairs_.clear();
  overflow_ = false;
  nodes_.clear();
  nodes_.push_back({tree_.root(), tree_.root()});
  const int step = levels_.step(0);
  while (!nodes_.empty() && !overflow_ && goes_on(0.0)) {
    const auto [a, b] = nodes_.back();
    nodes_.pop_back();
    const ElementTree::Node &one = tree_.node(a), &other = tree_.node(b);
    if (!tree_.box(a).is_near(tree_.box(b), touch_tolerance_m)) continue;
    if (one.is_leaf() && other.is_leaf()) {
      descend({{one.first_u * step, one.first_v * step, 0}, {other.first_u * step, other.first_v * step, 0}},
              level);
    } else if (a == b) {
      for (const auto& halves : {std::array{one.left, one.left}, std::array{one.right, one.right},
                                 std::array{one.left, one.right}}) {
        nodes_.push_back(halves);
      }
    } else if (other.is_leaf() || (!one.is_leaf() && tree_.size(a) >= tree_.size(b))) {
      for (const int half : {one.left, one.right}) nodes_.push_back({half, b});
    } else {
      for (const int half : {other.left, other.right}) nodes_.push_back({a, half});
    }
  }
}

void SurfaceSelfCollider::descend(const CellPair& elements, int level) {
  path_.clear();
  path_.push_back(elements);
  while (!path_.empty() && !overflow_) {
    const CellPair pair = path_.back();
    path_.pop_back();
    if (!can_meet(pair, level)) continue;
    if (pair.first.level == level) {
      emit(pair, level);
    } else {
      split(pair);
    }
  }
}

bool SurfaceSelfCollider::can_meet(const CellPair& pair, int level) {
  const auto& [a, b, region] = pair;
  if (are_joined(a, b)) return a.level < level && joined_can_meet(pair);
  const PatchCorners of_a = levels_.corners(a), of_b = levels_.corners(b);
  const double bulge_a = levels_.bulge(a), bulge_b = levels_.bulge(b);
  return patch_distance(of_a, bulge_a, of_b, bulge_b) <= touch_tolerance_m &&
         patch_distance_aside(of_a, bulge_a, of_b, bulge_b) <= touch_tolerance_m;
}

// Elsewhere than where they are joined.
bool SurfaceSelfCollider::joined_can_meet(const CellPair& pair) {
  const auto& [a, b, region] = pair;
  const Grid& grid = levels_.nested().grid;
  const int step = levels_.step(a.level), in_u = std::abs(a.i - b.i), in_v = std::abs(a.j - b.j);
  const bool beside_u = in_u <= step || cell_count(grid.u) - in_u <= step;
  const bool beside_v = in_v <= step || cell_count(grid.v) - in_v <= step;
  // In a pole alone they make no rectangle.
  if (!beside_u || !beside_v) return true;
  if (are_same(a, b)) return !folds_.never_meets_itself(std::array{a});
  if (in_u == 0 || in_v == 0) return !folds_.never_meets_itself(std::array{a, b});
  return !folds_.never_meets_itself(
      std::array{a, b, LevelCell{a.i, b.j, a.level}, LevelCell{b.i, a.j, a.level}});
}

void SurfaceSelfCollider::emit(const CellPair& pair, int level) {
  overflow_ = pairs_.size() + 2 > (level == 0 ? cell_pair_capacity : fine_pairs);
  if (overflow_) return;
  pairs_.push_back({pair.first, pair.second});
  pairs_.push_back({pair.second, pair.first});
}

void SurfaceSelfCollider::split(const CellPair& pair) {
  const auto& [a, b, region] = pair;
  const int half = levels_.step(a.level + 1), finer = a.level + 1;
  const bool same = are_same(a, b);
  for (int k = 0; k < 4; ++k) {
    for (int m = same ? k : 0; m < 4; ++m) {
      path_.push_back({{a.i + (k >> 1) * half, a.j + (k & 1) * half, finer},
                       {b.i + (m >> 1) * half, b.j + (m & 1) * half, finer}});
    }
  }
}

// Whether its pairs are those of a region before, the other way round.
bool SurfaceSelfCollider::is_mirror_of_earlier(const Region& region) const {
  const CellPair& sought = pairs_[region.begin];
  const auto end = pairs_.begin() + static_cast<std::ptrdiff_t>(region.begin);
  return std::any_of(pairs_.begin(), end, [&](const CellPair& pair) {
    return are_same(pair.first, sought.second) && are_same(pair.second, sought.first);
  });
}

// First from a few places, which mostly finds a touch at once; then everywhere, to be sure that there is
// none.
bool SurfaceSelfCollider::touches(const RegionCells& cells) {
  search_.forget_best();
  const std::size_t seeds = cells.at_most(region_seeds);
  for (std::size_t k = 0; k < seeds; ++k) {
    search_.offer(cells.middle_of(k, seeds));
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  for (const CellPair& pair : cells.pairs) {
    const auto searched = static_cast<double>(&pair - pairs_.data());
    if (!goes_on(searched / static_cast<double>(pairs_.size()))) return false;
    search_.search(pair.first, pair.second, infinity, touch_tolerance_m);
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  return false;
}

PairContact SurfaceSelfCollider::contact_of(const RegionCells& cells, const SelfQuery& query) const {
  PairContact contact;
  const auto [first, second] = ranges_of(cells);
  contact.first = first;
  contact.second = second;
  contact.pair = search_.best();
  contact.normal = unit_normal(levels_.surface(), contact.pair.at.s, contact.pair.at.t);
  double shortest = infinity;
  settle(contact, deepest_place(cells, search_.best().at, 1.0), 1.0, query, shortest);
  if (!query.closed) {
    settle(contact, deepest_place(cells, search_.best().at, -1.0), -1.0, query, shortest);
  }
  take_tangents(levels_.pieces(), contact);
  return contact;
}

// How deep either part is behind the other: the less of both moves them apart. Kept where the way out is
// shorter than the shortest known.
void SurfaceSelfCollider::settle(PairContact& contact, const PairParameters& from, double outside,
                                 const SelfQuery& query, double& shortest) const {
  const PiecewiseSurface pieces = levels_.pieces();
  const DeepestPair of_first = deepest_pair(pieces, pieces, from, outside, infinity);
  const PairParameters& deep = of_first.pair.at;
  if (!(of_first.depth_m > 0.0) || !not_joined_.counts(deep)) return;
  // The parts face each other where they are deep.
  const double outside_first = side_facing(of_first.normal, unit_normal(levels_.surface(), deep.u, deep.v));
  if (query.closed && outside_first < 0.0) return;
  const DeepestPair of_second =
      deepest_pair(pieces, pieces, {deep.s, deep.t, deep.u, deep.v}, outside_first, infinity);
  const SurfacePair& other = of_second.pair;
  if (!(of_second.depth_m > 0.0) || !not_joined_.counts(other.at)) return;
  const double depth = std::min(of_first.depth_m, of_second.depth_m);
  if (!(depth < shortest)) return;
  shortest = contact.depth_m = depth;
  if (of_first.depth_m <= of_second.depth_m) {
    contact.pair = of_first.pair;
    contact.normal = of_first.normal;
  } else {
    contact.pair = {{other.at.s, other.at.t, other.at.u, other.at.v}, other.second_m, other.first_m};
    contact.normal = -of_second.normal;
  }
}

}  // namespace spoonbill
