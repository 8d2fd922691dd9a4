#include "engine/simulation/body_pair_contact.h"

#include <algorithm>
#include <limits>

#include "engine/collision/pair_polish.h"

namespace spoonbill {
namespace {

// How near a sample must be to become a constraint, in lattice cells of the coarser body: about what a tick
// can move it.
constexpr double margin_cells = 0.25;
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

BodyPairContact::Side::Side(const NestedGrid& nested) : levels(nested) {
  const auto samples = static_cast<std::size_t>(nested.grid.rows() * nested.grid.columns());
  place.assign(samples, 0);
  placed_at.assign(samples, 0);
  near.reserve(near_capacity);
}

BodyPairContact::BodyPairContact(const BodyMapping& first, const BodyMapping& second)
    : first_(std::make_unique<Side>(first.nested())),
      second_(std::make_unique<Side>(second.nested())),
      cells_(std::make_unique<CellPairs>(first_->levels, second_->levels)) {}

bool BodyPairContact::add_contacts(const NumberedBody& first, const NumberedBody& second,
                                   BodyContacts& contacts) {
  least_gap_m_ = infinity;
  begin(*first.state, *second.state);
  const double margin = margin_cells * static_cast<double>(std::max(first.state->lattice.cell_size_m(),
                                                                    second.state->lattice.cell_size_m()));
  const ElementTree &one = cells_->first_tree(), &other = cells_->second_tree();
  if (one.box(one.root()).gap(other.box(other.root())) > margin) return true;
  bool complete = true;
  for (const CellPair& pair : cells_->within(margin)) {
    complete &= offer_corners(*first_, pair.first, *second_, pair.second);
    complete &= offer_corners(*second_, pair.second, *first_, pair.first);
  }
  for (const Direction& direction :
       {Direction{first, second, *first_, *second_}, Direction{second, first, *second_, *first_}}) {
    complete &= add_samples(direction, margin, contacts);
    complete &= add_deepest(direction, margin, contacts);
  }
  return complete && !cells_->overflow();
}

void BodyPairContact::begin(const BodyState& first, const BodyState& second) {
  ++search_;
  first_->near.clear();
  second_->near.clear();
  first_->levels.begin(first.mapping.current());
  second_->levels.begin(second.mapping.current());
  cells_->begin_first();
  cells_->begin_second();
}

// The corners of a cell against a cell of the other surface.
bool BodyPairContact::offer_corners(Side& side, const LevelCell& cell, Side& other, const LevelCell& patch) {
  const Grid& grid = side.levels.nested().grid;
  const Grid& of_patch = other.levels.nested().grid;
  const PatchCorners corners = other.levels.corners(patch);
  const int step = side.levels.step(cell.level), patch_step = other.levels.step(patch.level);
  const auto between = [](const std::vector<double>& parameters, int at, int to, double share) {
    return parameters[at] + share * (parameters[to] - parameters[at]);
  };
  for (int corner = 0; corner < 4; ++corner) {
    const int sample = (cell.i + (corner >> 1) * step) * grid.columns() + cell.j + (corner & 1) * step;
    const OnCell on = nearest_on_cell(side.levels.sample(sample), corners);
    if (side.placed_at[sample] != search_) {
      if (side.near.size() == near_capacity) return false;
      side.placed_at[sample] = search_;
      side.place[sample] = static_cast<int>(side.near.size());
      side.near.push_back({sample, 0.0, 0.0, infinity, infinity});
    }
    Near& near = side.near[side.place[sample]];
    if (on.distance >= near.distance) continue;
    near.distance = on.distance;
    near.u = between(of_patch.u.parameters, patch.i, patch.i + patch_step, on.u);
    near.v = between(of_patch.v.parameters, patch.j, patch.j + patch_step, on.v);
  }
  return true;
}

// Each near sample against the other surface's point nearest to it.
bool BodyPairContact::add_samples(const Direction& direction, double margin, BodyContacts& contacts) {
  bool complete = true;
  const Surface& surface = direction.to.state->mapping.current();
  for (Near& near : direction.side.near) {
    const Vector3& point = direction.side.levels.sample(near.sample);
    const NearestPoint nearest = nearest_point(surface, point, near.u, near.v);
    near.u = nearest.u;
    near.v = nearest.v;
    const Vector3 normal = unit_normal(surface, near.u, near.v);
    near.gap = (point - nearest.point_m).dot(normal);
    least_gap_m_ = std::min(least_gap_m_, near.gap);
    if (near.gap > margin) continue;
    complete &= contacts.add(
        {direction.from.number, &direction.from.state->lattice,
         direction.from.state->mapping.sample(near.sample)},
        {direction.to.number, &direction.to.state->lattice, direction.to.state->mapping.at(near.u, near.v)},
        normal, near.gap);
  }
  return complete;
}

bool BodyPairContact::is_local_deepest(const Side& side, const Near& near) const {
  const Grid& grid = side.levels.nested().grid;
  const int row = near.sample / grid.columns(), column = near.sample % grid.columns();
  for (int i = std::max(0, row - 1); i <= std::min(row + 1, grid.rows() - 1); ++i) {
    for (int j = std::max(0, column - 1); j <= std::min(column + 1, grid.columns() - 1); ++j) {
      const int sample = i * grid.columns() + j;
      if (sample == near.sample || side.placed_at[sample] != search_) continue;
      const double gap = side.near[side.place[sample]].gap;
      if (gap < near.gap || (gap == near.gap && sample < near.sample)) return false;
    }
  }
  return true;
}

// Between its samples a surface may be nearer than at any: from the nearest ones on both surfaces themselves.
bool BodyPairContact::add_deepest(const Direction& direction, double margin, BodyContacts& contacts) {
  bool complete = true;
  const Surface& first = direction.from.state->mapping.current();
  const Surface& second = direction.to.state->mapping.current();
  const Grid& grid = direction.side.levels.nested().grid;
  for (const Near& near : direction.side.near) {
    if (near.gap > margin || !is_local_deepest(direction.side, near)) continue;
    const PairParameters from{grid.u.parameters[near.sample / grid.columns()],
                              grid.v.parameters[near.sample % grid.columns()], near.u, near.v};
    // deepest_pair() climbs from before the other surface too: a gap is a depth below zero.
    const DeepestPair deepest = deepest_pair(first, second, from, 1.0);
    least_gap_m_ = std::min(least_gap_m_, -deepest.depth_m);
    const PairParameters& at = deepest.pair.at;
    complete &= contacts.add(
        {direction.from.number, &direction.from.state->lattice, direction.from.state->mapping.at(at.u, at.v)},
        {direction.to.number, &direction.to.state->lattice, direction.to.state->mapping.at(at.s, at.t)},
        deepest.normal, -deepest.depth_m);
  }
  return complete;
}

}  // namespace spoonbill
