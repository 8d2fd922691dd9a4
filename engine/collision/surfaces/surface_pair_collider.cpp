#include "engine/collision/surfaces/surface_pair_collider.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/surfaces/convex_hull.h"

namespace spoonbill {
namespace {

constexpr std::size_t contact_capacity = 64;
// Of the smaller surface's size or of the distance: that no other points are nearer is proven to this.
constexpr double nearest_tolerance = 1e-4;
// Candidates of a region from which Newton's method looks for a touch before all of it is searched.
constexpr std::size_t region_seeds = 8;
constexpr std::size_t wall_seeds = 8;
// Candidates of a region that its middle is taken from.
constexpr std::size_t middle_pairs = 64;
// From its middle outwards.
constexpr std::size_t seed_ways = 2;

constexpr double infinity = std::numeric_limits<double>::infinity();

// How long the control net is along a direction.
double length_along(const ControlNet& net, const Vector3& direction) {
  double least = infinity, most = -infinity;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const double along = direction.dot(net.point(i, j));
      least = std::min(least, along);
      most = std::max(most, along);
    }
  }
  return most - least;
}

}  // namespace

SurfacePairCollider::SurfacePairCollider(const NestedGrid& first, const NestedGrid& second)
    : first_(first),
      second_(second),
      cells_(first_, second_),
      regions_(first_, second_),
      search_(first_, second_) {
  contacts_.reserve(contact_capacity);
  seeds_.reserve(contact_capacity);
  last_seeds_.reserve(contact_capacity);
}

PairResult SurfacePairCollider::collide(const Surface& first, const Surface& second, const PairQuery& query) {
  SPOONBILL_ASSERT(query.reach_m >= 0.0);
  PairResult result;
  contacts_.clear();
  std::swap(seeds_, last_seeds_);
  seeds_.clear();
  ++query_;
  if (first_.begin(first, query.first_samples)) cells_.begin_first();
  if (second_.begin(second, query.second_samples)) cells_.begin_second();
  search_.begin();
  // Where they touched, they mostly do so still, and the hulls would be asked in vain.
  if (touched_ || !hulls_are_apart(first.net, second.net)) {
    take_contacts(query);
    result.overflow = cells_.overflow();
  }
  result.touching = touched_ = !contacts_.empty();
  if (!result.touching) find_nearest(query, result);
  result.overflow = result.overflow || search_.overflow();
  result.samples_evaluated = first_.samples_evaluated() + second_.samples_evaluated();
  return result;
}

void SurfacePairCollider::take_contacts(const PairQuery& query) {
  Pairs& pairs = cells_.within(0.5 * touch_tolerance_m);
  for (const Region& region : regions_.group(pairs)) {
    const RegionCells cells = cells_of(first_, second_, pairs, region);
    const auto [first, second] = ranges_of(cells);
    PairContact contact;
    contact.first = first;
    contact.second = second;
    const Seed* const last = last_seed(contact);
    if (!touches(cells, last)) continue;
    contact.pair = search_.best();
    seeds_.push_back(settle(cells, query, last, contact));
    take_tangents(first_.pieces(), contact);
    contacts_.push_back(contact);
  }
}

// Of the last collide(), where it touched within the region; null where it did not. Ranges of regions may
// overlap, and mostly they come in the same order.
const SurfacePairCollider::Seed* SurfacePairCollider::last_seed(const PairContact& contact) const {
  for (std::size_t k = 0; k < last_seeds_.size(); ++k) {
    const Seed& seed = last_seeds_[(contacts_.size() + k) % last_seeds_.size()];
    const PairParameters& at = seed.touch;
    if (contact.first.holds(at.u, at.v) && contact.second.holds(at.s, at.t)) return &seed;
  }
  return nullptr;
}

// First where they last touched and from a few places, which mostly finds a touch at once; then everywhere,
// to be sure that there is none.
bool SurfacePairCollider::touches(const RegionCells& cells, const Seed* last) {
  search_.forget_best();
  if (last != nullptr) search_.offer(last->touch);
  if (search_.best_distance_m() <= touch_tolerance_m) return true;
  const std::size_t count = cells.pairs.size(), seeds = cells.at_most(region_seeds);
  for (std::size_t k = 0; k < seeds; ++k) {
    // From the middle outwards, where a region is most likely to be deep.
    search_.offer(cells.middle_of(cells.pairs[(count / 2 + k * count / seeds) % count]));
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  for (const CellPair& pair : cells.pairs) {
    search_.search(pair.first, pair.second, infinity, touch_tolerance_m);
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  return false;
}

// The pair of the contact is a touch of the region. Returns what the next collide() may begin from.
SurfacePairCollider::Seed SurfacePairCollider::settle(const RegionCells& cells, const PairQuery& query,
                                                      const Seed* last, PairContact& contact) const {
  Seed found{contact.pair.at, {}};
  contact.normal = unit_normal(second_.surface(), found.touch.s, found.touch.t);
  // An open surface has no inside: of both its sides, the one with the shorter way out counts, which is
  // looked for first where the middle of the region lies.
  Seeds seeds = seeds_of(cells, last);
  const double first_side = query.second_closed || seeds.middle_depth > 0.0 ? 1.0 : -1.0;
  double shortest = infinity;
  for (const double outside : {first_side, -first_side}) {
    if (outside < 0.0 && query.second_closed) continue;
    PairContact way = contact;
    const int side = outside > 0.0 ? 0 : 1;
    PairParameters& from = seeds.at[side];
    settle_from(way, from, outside, query.first_closed, shortest);
    const bool was_deep = last != nullptr && last->deep[side];
    if (!(way.depth_m > 0.0) && was_deep) {
      from = last->deepest[side];
      settle_from(way, from, outside, query.first_closed, shortest);
    }
    if (!(way.depth_m > 0.0) && (last == nullptr || was_deep || shortest == infinity)) {
      from = deepest_place(cells, search_.best().at, outside);
      settle_from(way, from, outside, query.first_closed, shortest);
    }
    found.deep[side] = way.depth_m > 0.0;
    found.deepest[side] = from;
    if (!(way.depth_m > 0.0 && way.depth_m < shortest)) continue;
    shortest = way.depth_m;
    contact = way;
  }
  const bool bodies = query.first_closed && query.second_closed;
  if (shortest == infinity && bodies) take_inner_touch(cells, contact);
  return found;
}

RegionMiddle SurfacePairCollider::middle_of(const RegionCells& cells) const {
  RegionMiddle middle(first_.surface(), second_.surface());
  const std::size_t count = cells.pairs.size(), stride = (count + middle_pairs - 1) / middle_pairs;
  for (std::size_t k = 0; k < count; k += stride) middle.add(cells.middle_of(cells.pairs[k]));
  return middle;
}

// Of the middle of the region and a few places between it and the pairs, which lie where the surfaces cross,
// and as far beyond: those where the first surface is deepest behind the second and farthest before it. Where
// it was deepest last is mostly the place; the others then take turns.
SurfacePairCollider::Seeds SurfacePairCollider::seeds_of(const RegionCells& cells, const Seed* last) const {
  const RegionMiddle middle = middle_of(cells);
  Seeds seeds;
  const auto offer = [&](const PairParameters& at) {
    const double depth = depth_behind(first_.pieces(), second_.pieces(), at, 1.0);
    for (int side = 0; side < 2; ++side) {
      const double here = side == 0 ? depth : -depth;
      if (!(here > seeds.depth[side])) continue;
      seeds.depth[side] = here;
      seeds.at[side] = at;
    }
    return depth;
  };
  seeds.middle_depth = offer(middle.mean());
  for (int side = 0; side < 2; ++side) {
    if (last != nullptr && last->deep[side]) offer(last->deepest[side]);
  }
  for (std::size_t k = 0; k < seed_ways; ++k) {
    const PairParameters way = cells.middle_of(k, seed_ways);
    for (std::size_t beyond = 0; beyond < 2; ++beyond) {
      if (last != nullptr && (2 * k + beyond) != query_ % (2 * seed_ways)) continue;
      offer(middle.towards(way, beyond == 0 ? 0.5 : 2.0));
    }
  }
  return seeds;
}

// Where bodies touch with their outsides on the same side, one is inside the other there. Of a few such
// places the one whose common wall gives the shortest way out counts.
void SurfacePairCollider::take_inner_touch(const RegionCells& cells, PairContact& contact) const {
  const Surface& first = first_.surface();
  const Surface& second = second_.surface();
  const std::size_t seeds = cells.at_most(wall_seeds);
  double shortest = infinity;
  for (std::size_t k = 0; k <= seeds; ++k) {
    const PairParameters from = k == seeds ? search_.best().at : cells.middle_of(k, seeds);
    const SurfacePair pair = nearest_pair(first_.pieces(), second_.pieces(), from);
    if (pair.distance_m() > touch_tolerance_m) continue;
    const Vector3 normal = unit_normal(second, pair.at.s, pair.at.t);
    if (!(normal.dot(unit_normal(first, pair.at.u, pair.at.v)) > 0.0)) continue;
    const double of_first = length_along(first.net, normal), of_second = length_along(second.net, normal);
    if (!(std::min(of_first, of_second) < shortest)) continue;
    shortest = std::min(of_first, of_second);
    contact.pair = pair;
    contact.normal = of_first <= of_second ? normal : Vector3(-normal);
    contact.depth_m = shortest;
  }
}

// How deep either surface is behind the other: the less of both moves them apart. Kept where it is deeper
// than what is known; without care for how much beyond `shortest`. `from` becomes where the first is deepest.
void SurfacePairCollider::settle_from(PairContact& contact, PairParameters& from, double outside,
                                      bool first_closed, double shortest) const {
  const PiecewiseSurface first = first_.pieces(), second = second_.pieces();
  const DeepestPair of_first = deepest_pair(first, second, from, outside, shortest);
  from = of_first.pair.at;
  if (!(of_first.depth_m > contact.depth_m)) return;
  // The surfaces face each other where they are deep.
  const PairParameters& deep = of_first.pair.at;
  const double outside_first = side_facing(of_first.normal, unit_normal(first_.surface(), deep.u, deep.v));
  if (first_closed && outside_first < 0.0) return;
  const DeepestPair of_second =
      deepest_pair(second, first, {deep.s, deep.t, deep.u, deep.v}, outside_first, shortest);
  if (!(of_second.depth_m > contact.depth_m)) return;
  if (of_first.depth_m <= of_second.depth_m) {
    contact.pair = of_first.pair;
    contact.normal = of_first.normal;
    contact.depth_m = of_first.depth_m;
  } else {
    const SurfacePair& pair = of_second.pair;
    contact.pair = {{pair.at.s, pair.at.t, pair.at.u, pair.at.v}, pair.second_m, pair.first_m};
    contact.normal = -of_second.normal;
    contact.depth_m = of_second.depth_m;
  }
}

// One body is inside the other only where its box is.
bool SurfacePairCollider::may_contain(const PairQuery& query) const {
  const Box& first = cells_.first_tree().box(cells_.first_tree().root());
  const Box& second = cells_.second_tree().box(cells_.second_tree().root());
  return (query.second_closed && second.holds(first)) || (query.first_closed && first.holds(second));
}

double SurfacePairCollider::tolerance() const {
  const ElementTree& first = cells_.first_tree();
  const ElementTree& second = cells_.second_tree();
  const double size = std::min(first.box(first.root()).size(), second.box(second.root()).size());
  const double best = search_.best_distance_m();
  return nearest_tolerance * (std::isfinite(best) ? std::max(size, best) : size);
}

// Returns the largest tolerance that was used.
double SurfacePairCollider::search_all(double reach) {
  double largest = 0.0;
  cells_.visit_elements([&] { return std::min(reach, search_.best_distance_m() - tolerance()); },
                        [&](const CellPair& pair) {
                          const double used = tolerance();
                          largest = std::max(largest, used);
                          search_.search(pair.first, pair.second, used, touch_tolerance_m);
                        });
  return largest;
}

void SurfacePairCollider::find_nearest(const PairQuery& query, PairResult& result) {
  cells_.update();
  const bool nested = may_contain(query);
  const double reach = nested ? infinity : query.reach_m;
  const Box& first = cells_.first_tree().box(cells_.first_tree().root());
  const Box& second = cells_.second_tree().box(cells_.second_tree().root());
  if (reach <= 0.0 || first.gap(second) > reach) return;
  search_.forget_best();
  search_.offer(RegionCells{&first_, &second_, {}}.middle_of(cells_.likely_near()));
  if (nearest_known_) search_.offer(nearest_);
  // Beside a first guess far too long, nearer points were let go: once more, beside the one found.
  while (search_all(reach) > 2.0 * tolerance()) continue;
  nearest_ = search_.best().at;
  nearest_known_ = true;
  if (nested && is_contained(query)) {
    contacts_.push_back(containment());
    take_tangents(first_.pieces(), contacts_.back());
    result.touching = result.contained = true;
  } else if (search_.best_distance_m() <= query.reach_m) {
    result.nearest = search_.best();
    result.distance_m = search_.best_distance_m();
  }
}

// Of bodies whose surfaces do not meet, the nearest points tell: the point of the one inside lies behind the
// other's surface.
bool SurfacePairCollider::is_contained(const PairQuery& query) const {
  const SurfacePair& best = search_.best();
  const Vector3 apart = best.first_m - best.second_m;
  const bool first_inside =
      query.second_closed && apart.dot(unit_normal(second_.surface(), best.at.s, best.at.t)) < 0.0;
  const bool second_inside =
      query.first_closed && apart.dot(unit_normal(first_.surface(), best.at.u, best.at.v)) > 0.0;
  return first_inside || second_inside;
}

// Through the nearest wall: by the distance to it and by how long the inner one is along that way.
PairContact SurfacePairCollider::containment() const {
  const Surface& first = first_.surface();
  const Surface& second = second_.surface();
  PairContact contact;
  contact.pair = search_.best();
  const Vector3 between = contact.pair.second_m - contact.pair.first_m, way = between.normalized();
  contact.normal = way;
  contact.depth_m = between.norm() + std::min(length_along(first.net, way), length_along(second.net, way));
  contact.first = {first.u.domain_start(), first.u.domain_end(), first.v.domain_start(),
                   first.v.domain_end()};
  contact.second = {second.u.domain_start(), second.u.domain_end(), second.v.domain_start(),
                    second.v.domain_end()};
  return contact;
}

}  // namespace spoonbill
