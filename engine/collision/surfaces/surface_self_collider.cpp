#include "engine/collision/surfaces/surface_self_collider.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

namespace {

constexpr double all_directions = std::numbers::pi;
constexpr double right_angle = 0.5 * std::numbers::pi;

// Returns the half angle of the cone that contains all vectors within `radius` of a given vector. This
// vector, of length `length`, is the axis of the cone.
double half_angle(double length, double radius) {
  return radius < length ? std::asin(radius / length) : all_directions;
}

double angle_between(const Vector3& one, const Vector3& other) {
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

}  // namespace

PatchFolds::Direction PatchFolds::unroll(const KnotVector& knots) {
  Direction direction;
  const std::vector<double>& u = knots.extended_knots();
  const int p = direction.degree = knots.degree();
  const int count = static_cast<int>(u.size()) - p - 1;
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    direction.span.push_back(knots.find_span(0.5 * (breaks[b] + breaks[b + 1])));
  }
  for (int i = 0; i < count; ++i) {
    direction.control.push_back(knots.control_index(i, p));
    const double length = i + 1 < count ? u[i + p + 1] - u[i + 1] : 0.0;
    direction.scale.push_back(length > 0.0 ? p / length : 0.0);
  }
  return direction;
}

PatchFolds::PatchFolds(SurfaceLevels& levels)
    : levels_(&levels), u_(unroll(levels.nested().grid.u.knots)), v_(unroll(levels.nested().grid.v.knots)) {
  mixed_.resize(u_.span.size() * v_.span.size());
  steps_.resize(u_.control.size() * v_.control.size());
  cones_.resize(static_cast<std::size_t>(levels.total_cell_count()));
  computed_at_.assign(cones_.size(), 0);
}

void PatchFolds::begin() {
  ++generation_;
  levels_->bounds().update(levels_->surface().net);
  update_mixed_bounds();
}

// Computes bounds of the norm of S_uv. S_uv is a B-spline surface of one degree less in both directions, and
// its control points bound its norm.
void PatchFolds::update_mixed_bounds() {
  const ControlNet& net = levels_->surface().net;
  const int rows = static_cast<int>(u_.control.size()), columns = static_cast<int>(v_.control.size());
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int here = u_.control[i], next = u_.control[i + 1];
      const Vector3 low = net.point(next, v_.control[j]) - net.point(here, v_.control[j]);
      const Vector3 high = net.point(next, v_.control[j + 1]) - net.point(here, v_.control[j + 1]);
      steps_[i * columns + j] = u_.scale[i] * v_.scale[j] * (high - low).norm();
    }
  }
  for (std::size_t eu = 0; eu < u_.span.size(); ++eu) {
    for (std::size_t ev = 0; ev < v_.span.size(); ++ev) {
      double most = 0.0;
      for (int i = u_.span[eu] - u_.degree; i < u_.span[eu]; ++i) {
        for (int j = v_.span[ev] - v_.degree; j < v_.span[ev]; ++j) {
          most = std::max(most, steps_[i * columns + j]);
        }
      }
      mixed_[eu * v_.span.size() + ev] = most;
    }
  }
}

// Computes cones that contain the cell's tangents along u and along v. Their axes are the tangents at the
// cell's centre. Their angles follow from bounds of the second derivatives, which limit how far the tangents
// change.
PatchFolds::Cones PatchFolds::compute_cones(const LevelCell& cell) {
  const Grid& grid = levels_->nested().grid;
  const int step = levels_->step(cell.level), shift = levels_->nested().levels;
  const int eu = cell.i >> shift, ev = cell.j >> shift;
  const double u0 = grid.u.parameters[cell.i], u1 = grid.u.parameters[cell.i + step];
  const double v0 = grid.v.parameters[cell.j], v1 = grid.v.parameters[cell.j + step];
  const double half_u = 0.5 * (u1 - u0), half_v = 0.5 * (v1 - v0);
  const SurfacePoint centre = evaluate(levels_->pieces(), u0 + half_u, v0 + half_v);
  const SurfaceBounds& bounds = levels_->bounds();
  const double mixed = mixed_[static_cast<std::size_t>(eu) * v_.span.size() + static_cast<std::size_t>(ev)];
  // A bulge is one eighth of the second derivative times the square of the side, so eight times a bulge for
  // sides of 1 is the second derivative.
  const double radius_u = 8.0 * bounds.bulge(eu, ev, 1.0, 0.0) * half_u + mixed * half_v;
  const double radius_v = 8.0 * bounds.bulge(eu, ev, 0.0, 1.0) * half_v + mixed * half_u;
  const double length_u = centre.du.norm(), length_v = centre.dv.norm();
  return {{centre.du / std::max(length_u, 1e-300), half_angle(length_u, radius_u)},
          {centre.dv / std::max(length_v, 1e-300), half_angle(length_v, radius_v)}};
}

const PatchFolds::Cones& PatchFolds::cones_at(const LevelCell& cell) {
  const int index = levels_->cell_index(cell);
  if (computed_at_[index] != generation_) {
    computed_at_[index] = generation_;
    cones_[index] = compute_cones(cell);
  }
  return cones_[index];
}

bool PatchFolds::never_meets_itself(std::span<const LevelCell> cells) {
  SPOONBILL_ASSERT(!cells.empty());
  SPOONBILL_ASSERT_DEBUG(std::all_of(
      cells.begin(), cells.end(), [&](const LevelCell& cell) { return cell.level == cells.front().level; }));
  Cones sum;
  for (const LevelCell& cell : cells) {
    const Cones& cones = cones_at(cell);
    sum.along_u.axis += cones.along_u.axis;
    sum.along_v.axis += cones.along_v.axis;
  }
  for (const LevelCell& cell : cells) {
    const Cones& cones = cones_at(cell);
    sum.along_u.angle = std::max(sum.along_u.angle,
                                 angle_between(sum.along_u.axis, cones.along_u.axis) + cones.along_u.angle);
    sum.along_v.angle = std::max(sum.along_v.angle,
                                 angle_between(sum.along_v.axis, cones.along_v.axis) + cones.along_v.angle);
  }
  if (!(sum.along_u.angle < right_angle && sum.along_v.angle < right_angle)) return false;
  const double between = angle_between(sum.along_u.axis, sum.along_v.axis);
  return std::min(between, std::numbers::pi - between) > sum.along_u.angle + sum.along_v.angle;
}

namespace {

constexpr std::size_t self_contact_capacity = 64;
// Largest number of pairs at any level except the coarsest. If there are more, a coarser level is used.
constexpr std::size_t self_pair_capacity = 1 << 17;
// Number of starting points from which Newton's method looks for a touch before the whole region is searched.
constexpr std::size_t self_region_seeds = 8;

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
  // Each step of a descent removes one entry from a stack. It adds at most three entries to nodes_, or
  // sixteen to pending_.
  nodes_.reserve(256);
  pending_.reserve(static_cast<std::size_t>(16 * (2 + nested.levels)));
  contacts_.reserve(self_contact_capacity);
}

SelfResult SurfaceSelfCollider::collide(const Surface& surface, const SelfQuery& query) {
  contacts_.clear();
  query_ = &query;
  stopped_ = false;
  levels_.begin(surface);
  folds_.begin();
  tree_.update(levels_);
  u_ = find_joints(true);
  v_ = find_joints(false);
  search_.begin();
  int level = levels_.nested().levels;
  collect_pairs(level);
  // At a coarser level, joined cells are larger, and contacts between parts of joined cells are missed.
  const bool coarser = overflow_;
  while (overflow_ && level > 0 && !stopped_) collect_pairs(--level);
  const std::vector<Region>& regions = regions_.group(pairs_);
  for (const Region& region : regions) {
    const RegionCells cells = region_cells(levels_, levels_, pairs_, region);
    if (stopped_) break;
    if (is_mirror_of_earlier(region) || !touches(cells)) continue;
    contacts_.push_back(make_contact(cells, query));
  }
  query_ = nullptr;
  return {!contacts_.empty(), coarser || search_.overflow(), stopped_};
}

// Reports progress only in every 64th call, because the callback may make a system call.
bool SurfaceSelfCollider::should_continue(double fraction) {
  constexpr std::uint64_t calls_between_reports = 64;
  if (!stopped_ && calls_++ % calls_between_reports == 0) stopped_ = !query_->progress.report(fraction);
  return !stopped_;
}

// Compares the samples at both ends of a direction to find out how they are joined.
SurfaceSelfCollider::Joints SurfaceSelfCollider::find_joints(bool in_u) {
  const Grid& grid = levels_.nested().grid;
  const GridDirection& direction = in_u ? grid.u : grid.v;
  if (direction.knots.is_periodic()) return {true, false, false};
  const int last = direction.cell_count(), count = in_u ? grid.columns() : grid.rows();
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
  const int cells_u = grid.u.cell_count(), cells_v = grid.v.cell_count();
  return (beside(a.i, b.i, cells_u, u_.seam) && beside(a.j, b.j, cells_v, v_.seam)) ||
         in_one_pole(a.i, b.i, cells_u, u_) || in_one_pole(a.j, b.j, cells_v, v_);
}

LevelCell SurfaceSelfCollider::cell_at(double u, double v) const {
  const NestedGrid& nested = levels_.nested();
  return {nested.grid.u.find_cell(u), nested.grid.v.find_cell(v), nested.levels};
}

bool SurfaceSelfCollider::NotJoinedJudge::counts(const PairParameters& at) const {
  return !collider_->are_joined(collider_->cell_at(at.u, at.v), collider_->cell_at(at.s, at.t));
}

// Collects all pairs of cells of the level that may meet. Each pair is stored in both orders.
void SurfaceSelfCollider::collect_pairs(int level) {
  pairs_.clear();
  overflow_ = false;
  nodes_.clear();
  nodes_.push_back({tree_.root(), tree_.root()});
  const int step = levels_.step(0);
  while (!nodes_.empty() && !overflow_ && should_continue(0.0)) {
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
  pending_.clear();
  pending_.push_back(elements);
  while (!pending_.empty() && !overflow_) {
    const CellPair pair = pending_.back();
    pending_.pop_back();
    if (!can_meet(pair, level)) continue;
    if (pair.first.level == level) {
      add_pair(pair, level);
    } else {
      split(pair);
    }
  }
}

bool SurfaceSelfCollider::can_meet(const CellPair& pair, int level) {
  const auto& [a, b, region] = pair;
  if (are_joined(a, b)) return a.level < level && joined_can_meet(pair);
  const PatchCorners corners_a = levels_.corners(a), corners_b = levels_.corners(b);
  const double bulge_a = levels_.bulge(a), bulge_b = levels_.bulge(b);
  return patch_distance(corners_a, bulge_a, corners_b, bulge_b) <= touch_tolerance_m &&
         patch_distance_in_plane(corners_a, bulge_a, corners_b, bulge_b) <= touch_tolerance_m;
}

// Returns true if two joined cells may meet anywhere except where they are joined.
bool SurfaceSelfCollider::joined_can_meet(const CellPair& pair) {
  const auto& [a, b, region] = pair;
  const Grid& grid = levels_.nested().grid;
  const int step = levels_.step(a.level), in_u = std::abs(a.i - b.i), in_v = std::abs(a.j - b.j);
  const bool beside_u = in_u <= step || grid.u.cell_count() - in_u <= step;
  const bool beside_v = in_v <= step || grid.v.cell_count() - in_v <= step;
  // Cells that are joined only at a pole do not form a rectangle.
  if (!beside_u || !beside_v) return true;
  if (are_same(a, b)) return !folds_.never_meets_itself(std::array{a});
  if (in_u == 0 || in_v == 0) return !folds_.never_meets_itself(std::array{a, b});
  return !folds_.never_meets_itself(
      std::array{a, b, LevelCell{a.i, b.j, a.level}, LevelCell{b.i, a.j, a.level}});
}

void SurfaceSelfCollider::add_pair(const CellPair& pair, int level) {
  overflow_ = pairs_.size() + 2 > (level == 0 ? cell_pair_capacity : self_pair_capacity);
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
      pending_.push_back({{a.i + (k >> 1) * half, a.j + (k & 1) * half, finer},
                          {b.i + (m >> 1) * half, b.j + (m & 1) * half, finer}});
    }
  }
}

// Returns true if the region repeats an earlier one with the two cells of each pair exchanged.
bool SurfaceSelfCollider::is_mirror_of_earlier(const Region& region) const {
  const CellPair& sought = pairs_[region.begin];
  const auto end = pairs_.begin() + static_cast<std::ptrdiff_t>(region.begin);
  return std::any_of(pairs_.begin(), end, [&](const CellPair& pair) {
    return are_same(pair.first, sought.second) && are_same(pair.second, sought.first);
  });
}

// Returns true if the surface touches itself in the region. First tries a few candidates, which usually
// suffice, and then searches all pairs.
bool SurfaceSelfCollider::touches(const RegionCells& cells) {
  search_.forget_best();
  const std::size_t seeds = cells.at_most(self_region_seeds);
  for (std::size_t k = 0; k < seeds; ++k) {
    search_.offer(cells.pair_centre(k, seeds));
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  for (const CellPair& pair : cells.pairs) {
    const auto searched = static_cast<double>(&pair - pairs_.data());
    if (!should_continue(searched / static_cast<double>(pairs_.size()))) return false;
    search_.search(pair.first, pair.second, infinity, touch_tolerance_m);
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  return false;
}

PairContact SurfaceSelfCollider::make_contact(const RegionCells& cells, const SelfQuery& query) const {
  PairContact contact;
  const auto [first, second] = region_ranges(cells);
  contact.first = first;
  contact.second = second;
  contact.pair = search_.best();
  contact.normal = unit_normal(levels_.surface(), contact.pair.at.s, contact.pair.at.t);
  double shortest = infinity;
  deepen_contact(contact, find_deepest_seed(cells, search_.best().at, 1.0), 1.0, query, shortest);
  if (!query.closed) {
    deepen_contact(contact, find_deepest_seed(cells, search_.best().at, -1.0), -1.0, query, shortest);
  }
  set_tangents(levels_.pieces(), contact);
  return contact;
}

// Updates the contact if the two parts of the surface are behind each other and the smaller of their depths
// is less than `shortest`.
void SurfaceSelfCollider::deepen_contact(PairContact& contact, const PairParameters& from, double outside,
                                         const SelfQuery& query, double& shortest) const {
  const PiecewiseSurface pieces = levels_.pieces();
  const DeepestPair first_deepest = deepest_pair(pieces, pieces, from, outside, infinity);
  const PairParameters& deep = first_deepest.pair.at;
  if (!(first_deepest.depth_m > 0.0) || !not_joined_.counts(deep)) return;
  // If the two parts penetrate each other, their outer sides face each other.
  const double outside_first =
      facing_side(first_deepest.normal, unit_normal(levels_.surface(), deep.u, deep.v));
  if (query.closed && outside_first < 0.0) return;
  const DeepestPair second_deepest =
      deepest_pair(pieces, pieces, {deep.s, deep.t, deep.u, deep.v}, outside_first, infinity);
  const SurfacePair& other = second_deepest.pair;
  if (!(second_deepest.depth_m > 0.0) || !not_joined_.counts(other.at)) return;
  const double depth = std::min(first_deepest.depth_m, second_deepest.depth_m);
  if (!(depth < shortest)) return;
  shortest = contact.depth_m = depth;
  if (first_deepest.depth_m <= second_deepest.depth_m) {
    contact.pair = first_deepest.pair;
    contact.normal = first_deepest.normal;
  } else {
    contact.pair = {{other.at.s, other.at.t, other.at.u, other.at.v}, other.second_m, other.first_m};
    contact.normal = -second_deepest.normal;
  }
}

}  // namespace spoonbill
