#include "engine/collision/surfaces/surface_pair_collider.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/surfaces/pair_search.h"

namespace spoonbill {
namespace {

constexpr std::size_t pair_contact_capacity = 64;
// Tolerance of the nearest distance, as a fraction of the smaller surface's size or of the distance,
// whichever is larger.
constexpr double nearest_tolerance = 1e-4;
// Number of starting points from which Newton's method looks for a touch before the whole region is searched.
constexpr std::size_t region_seeds = 8;
constexpr std::size_t wall_seeds = 8;
// Largest number of pairs of cells from which the centre of a region is computed.
constexpr std::size_t centre_pairs = 64;
// Number of directions from the region's centre in which starting points are placed.
constexpr std::size_t seed_directions = 2;

// Returns the length of the control net along a unit direction, in metres.
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
  contacts_.reserve(pair_contact_capacity);
  seeds_.reserve(pair_contact_capacity);
  last_seeds_.reserve(pair_contact_capacity);
}

PairResult SurfacePairCollider::collide(const Surface& first, const Surface& second, const PairQuery& query) {
  SPOONBILL_ASSERT(query.reach_m >= 0.0);
  PairResult result;
  contacts_.clear();
  std::swap(seeds_, last_seeds_);
  seeds_.clear();
  ++query_;
  if (first_.begin(first, query.first_samples)) cells_.invalidate_first();
  if (second_.begin(second, query.second_samples)) cells_.invalidate_second();
  search_.begin();
  // Surfaces that touched in the last call usually still touch, so the hull test is skipped.
  if (touched_last_ || !hulls_are_apart(first.net, second.net)) {
    find_contacts(query);
    result.overflow = cells_.overflow();
  }
  result.touching = touched_last_ = !contacts_.empty();
  if (!result.touching) find_nearest(query, result);
  result.overflow = result.overflow || search_.overflow();
  result.samples_evaluated = first_.samples_evaluated() + second_.samples_evaluated();
  return result;
}

void SurfacePairCollider::find_contacts(const PairQuery& query) {
  Pairs& pairs = cells_.find_within(0.5 * touch_tolerance_m);
  for (const Region& region : regions_.group(pairs)) {
    const RegionCells cells = region_cells(first_, second_, pairs, region);
    const auto [first, second] = region_ranges(cells);
    PairContact contact;
    contact.first = first;
    contact.second = second;
    const Seed* const last = last_seed(contact);
    if (!touches(cells, last)) continue;
    contact.pair = search_.best();
    seeds_.push_back(resolve_contact(cells, query, last, contact));
    set_tangents(first_.pieces(), contact);
    contacts_.push_back(contact);
  }
}

// Returns the starting points that the last collide() stored for this region, or null. Several regions may
// have overlapping ranges, so the points of the contact with the same number are tried first: contacts
// usually keep their order.
const SurfacePairCollider::Seed* SurfacePairCollider::last_seed(const PairContact& contact) const {
  for (std::size_t k = 0; k < last_seeds_.size(); ++k) {
    const Seed& seed = last_seeds_[(contacts_.size() + k) % last_seeds_.size()];
    const PairParameters& at = seed.touch;
    if (contact.first.contains(at.u, at.v) && contact.second.contains(at.s, at.t)) return &seed;
  }
  return nullptr;
}

// Returns true if the surfaces touch in the region. First tries the last touch and a few candidates, which
// usually suffice, and then searches all pairs.
bool SurfacePairCollider::touches(const RegionCells& cells, const Seed* last) {
  search_.forget_best();
  if (last != nullptr) search_.offer(last->touch);
  if (search_.best_distance_m() <= touch_tolerance_m) return true;
  const std::size_t count = cells.pairs.size(), seeds = cells.at_most(region_seeds);
  for (std::size_t k = 0; k < seeds; ++k) {
    // Starts halfway through the list of pairs, where the surfaces are likely to be deepest.
    search_.offer(cells.pair_centre(cells.pairs[(count / 2 + k * count / seeds) % count]));
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  for (const CellPair& pair : cells.pairs) {
    search_.search(pair.first, pair.second, infinity, touch_tolerance_m);
    if (search_.best_distance_m() <= touch_tolerance_m) return true;
  }
  return false;
}

// Computes the depth of a region; `contact` contains the point where the surfaces touch. Returns the points
// from which the next collide() starts in this region.
SurfacePairCollider::Seed SurfacePairCollider::resolve_contact(const RegionCells& cells,
                                                               const PairQuery& query, const Seed* last,
                                                               PairContact& contact) const {
  Seed found{contact.pair.at, {}};
  contact.normal = unit_normal(second_.surface(), found.touch.s, found.touch.t);
  // An open surface has no inside, so both sides are tried, and the shorter exit determines the depth. The
  // search begins with the side on which the centre of the region is.
  Seeds seeds = find_seeds(cells, last);
  const double first_side = query.second_closed || seeds.centre_depth > 0.0 ? 1.0 : -1.0;
  double shortest = infinity;
  for (const double outside : {first_side, -first_side}) {
    if (outside < 0.0 && query.second_closed) continue;
    PairContact candidate = contact;
    const int side = outside > 0.0 ? 0 : 1;
    PairParameters& from = seeds.at[side];
    deepen_contact(candidate, from, outside, query.first_closed, shortest);
    const bool was_deep = last != nullptr && last->deep[side];
    if (!(candidate.depth_m > 0.0) && was_deep) {
      from = last->deepest[side];
      deepen_contact(candidate, from, outside, query.first_closed, shortest);
    }
    if (!(candidate.depth_m > 0.0) && (last == nullptr || was_deep || shortest == infinity)) {
      from = find_deepest_seed(cells, search_.best().at, outside);
      deepen_contact(candidate, from, outside, query.first_closed, shortest);
    }
    found.deep[side] = candidate.depth_m > 0.0;
    found.deepest[side] = from;
    if (!(candidate.depth_m > 0.0 && candidate.depth_m < shortest)) continue;
    shortest = candidate.depth_m;
    contact = candidate;
  }
  const bool bodies = query.first_closed && query.second_closed;
  if (shortest == infinity && bodies) find_inner_touch(cells, contact);
  return found;
}

RegionCentre SurfacePairCollider::find_centre(const RegionCells& cells) const {
  RegionCentre centre(first_.surface(), second_.surface());
  const std::size_t count = cells.pairs.size(), stride = (count + centre_pairs - 1) / centre_pairs;
  for (std::size_t k = 0; k < count; k += stride) centre.add(cells.pair_centre(cells.pairs[k]));
  return centre;
}

// Returns a starting point for each side of the second surface: of several candidates, the deepest and the
// one farthest in front. The candidates are the centre of the region, the deepest points of the last call,
// and points in the directions from the centre to a few pairs at which the surfaces cross, at half and at
// twice the distance of the pair. If the last call stored points for this region, only one of the points in
// these directions is evaluated per call.
SurfacePairCollider::Seeds SurfacePairCollider::find_seeds(const RegionCells& cells, const Seed* last) const {
  const RegionCentre centre = find_centre(cells);
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
  seeds.centre_depth = offer(centre.mean());
  for (int side = 0; side < 2; ++side) {
    if (last != nullptr && last->deep[side]) offer(last->deepest[side]);
  }
  for (std::size_t k = 0; k < seed_directions; ++k) {
    const PairParameters crossing = cells.pair_centre(k, seed_directions);
    for (std::size_t beyond = 0; beyond < 2; ++beyond) {
      if (last != nullptr && (2 * k + beyond) != query_ % (2 * seed_directions)) continue;
      offer(centre.towards(crossing, beyond == 0 ? 0.5 : 2.0));
    }
  }
  return seeds;
}

// Computes the depth if one body is inside the other and touches it from within. The outward normals then
// agree where the surfaces touch. Of a few candidates, uses the one with the shortest exit.
void SurfacePairCollider::find_inner_touch(const RegionCells& cells, PairContact& contact) const {
  const Surface& first = first_.surface();
  const Surface& second = second_.surface();
  const std::size_t seeds = cells.at_most(wall_seeds);
  double shortest = infinity;
  for (std::size_t k = 0; k <= seeds; ++k) {
    const PairParameters from = k == seeds ? search_.best().at : cells.pair_centre(k, seeds);
    const SurfacePair pair = nearest_pair(first_.pieces(), second_.pieces(), from);
    if (pair.distance_m() > touch_tolerance_m) continue;
    const Vector3 normal = unit_normal(second, pair.at.s, pair.at.t);
    if (!(normal.dot(unit_normal(first, pair.at.u, pair.at.v)) > 0.0)) continue;
    const double first_length = length_along(first.net, normal),
                 second_length = length_along(second.net, normal);
    if (!(std::min(first_length, second_length) < shortest)) continue;
    shortest = std::min(first_length, second_length);
    contact.pair = pair;
    contact.normal = first_length <= second_length ? normal : Vector3(-normal);
    contact.depth_m = shortest;
  }
}

// Updates the contact if each surface is deeper behind the other than contact.depth_m. A displacement by the
// smaller of both depths separates the surfaces. Depths beyond `shortest` need not be exact. `from` receives
// the parameters of the first surface's deepest point.
void SurfacePairCollider::deepen_contact(PairContact& contact, PairParameters& from, double outside,
                                         bool first_closed, double shortest) const {
  const PiecewiseSurface first = first_.pieces(), second = second_.pieces();
  const DeepestPair first_deepest = deepest_pair(first, second, from, outside, shortest);
  from = first_deepest.pair.at;
  if (!(first_deepest.depth_m > contact.depth_m)) return;
  // If the surfaces penetrate each other, their outer sides face each other.
  const PairParameters& deep = first_deepest.pair.at;
  const double outside_first =
      facing_side(first_deepest.normal, unit_normal(first_.surface(), deep.u, deep.v));
  if (first_closed && outside_first < 0.0) return;
  const DeepestPair second_deepest =
      deepest_pair(second, first, {deep.s, deep.t, deep.u, deep.v}, outside_first, shortest);
  if (!(second_deepest.depth_m > contact.depth_m)) return;
  if (first_deepest.depth_m <= second_deepest.depth_m) {
    contact.pair = first_deepest.pair;
    contact.normal = first_deepest.normal;
    contact.depth_m = first_deepest.depth_m;
  } else {
    const SurfacePair& pair = second_deepest.pair;
    contact.pair = {{pair.at.s, pair.at.t, pair.at.u, pair.at.v}, pair.second_m, pair.first_m};
    contact.normal = -second_deepest.normal;
    contact.depth_m = second_deepest.depth_m;
  }
}

// Returns true if one surface is closed and its box contains the box of the other. Otherwise no body can be
// inside the other.
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

// Searches all pairs of elements within reach for the nearest pair of points. Returns the largest tolerance
// that was used.
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
  search_.offer(RegionCells{&first_, &second_, {}}.pair_centre(cells_.find_likely_near_elements()));
  if (nearest_known_) search_.offer(nearest_);
  // If the first guess is much too far, its tolerance is large, and nearer points may have been skipped. The
  // search is then repeated from the pair that was found.
  while (search_all(reach) > 2.0 * tolerance()) continue;
  nearest_ = search_.best().at;
  nearest_known_ = true;
  if (nested && is_contained(query)) {
    contacts_.push_back(make_containment_contact());
    set_tangents(first_.pieces(), contacts_.back());
    result.touching = result.contained = true;
  } else if (search_.best_distance_m() <= query.reach_m) {
    result.nearest = search_.best();
    result.distance_m = search_.best_distance_m();
  }
}

// Returns true if one body is inside the other, for surfaces that do not meet. The inner body's nearest point
// is then behind the outer surface.
bool SurfacePairCollider::is_contained(const PairQuery& query) const {
  const SurfacePair& best = search_.best();
  const Vector3 apart = best.first_m - best.second_m;
  const bool first_inside =
      query.second_closed && apart.dot(unit_normal(second_.surface(), best.at.s, best.at.t)) < 0.0;
  const bool second_inside =
      query.first_closed && apart.dot(unit_normal(first_.surface(), best.at.u, best.at.v)) > 0.0;
  return first_inside || second_inside;
}

// Makes the contact of a body inside another. The inner body leaves through the nearest wall, so the depth is
// the distance to the wall plus the length of the inner body along the normal.
PairContact SurfacePairCollider::make_containment_contact() const {
  const Surface& first = first_.surface();
  const Surface& second = second_.surface();
  PairContact contact;
  contact.pair = search_.best();
  const Vector3 between = contact.pair.second_m - contact.pair.first_m, direction = between.normalized();
  contact.normal = direction;
  contact.depth_m =
      between.norm() + std::min(length_along(first.net, direction), length_along(second.net, direction));
  contact.first = {first.u.domain_start(), first.u.domain_end(), first.v.domain_start(),
                   first.v.domain_end()};
  contact.second = {second.u.domain_start(), second.u.domain_end(), second.v.domain_start(),
                    second.v.domain_end()};
  return contact;
}

}  // namespace spoonbill
