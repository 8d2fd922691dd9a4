#include "engine/collision/surfaces/pair_search.h"

#include <algorithm>
#include <limits>

#include "engine/base/assert.h"
#include "engine/collision/levels/patch_distance.h"

namespace spoonbill {
namespace {

constexpr std::size_t pair_capacity = 1024;
constexpr int deepest_cut = 40;

Vector3 centre_of(const PatchCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

}  // namespace

PairSearch::PairSearch(SurfaceLevels& first, SurfaceLevels& second, const PairJudge* judge)
    : first_(&first), second_(&second), judge_(judge) {
  SPOONBILL_ASSERT(&first != &second || judge != nullptr);
  pairs_.reserve(pair_capacity);
}

void PairSearch::begin() {
  forget_best();
  overflow_ = false;
}

void PairSearch::forget_best() {
  best_distance_m_ = std::numeric_limits<double>::infinity();
}

void PairSearch::offer(const PairParameters& from) {
  const PiecewiseSurface first = first_->pieces(), second = second_->pieces();
  SurfacePair polished = nearest_pair(first, second, from);
  if (judge_ != nullptr && !judge_->counts(polished.at)) {
    polished = {from, position(first, from.u, from.v), position(second, from.s, from.t)};
  }
  const double distance = polished.distance_m();
  if (!(distance < best_distance_m_)) return;
  best_ = polished;
  best_distance_m_ = distance;
}

PairSearch::Patch PairSearch::patch_of(SurfaceLevels& levels, const LevelCell& cell) {
  const Grid& grid = levels.nested().grid;
  const int step = levels.step(cell.level);
  return {grid.u.parameters[cell.i], grid.u.parameters[cell.i + step],
          grid.v.parameters[cell.j], grid.v.parameters[cell.j + step],
          levels.corners(cell),      levels.bulge(cell)};
}

double PairSearch::Patch::size() const {
  return std::max((corners[3] - corners[0]).norm(), (corners[2] - corners[1]).norm()) + bulge;
}

void PairSearch::search(const LevelCell& a, const LevelCell& b, double tolerance_m, double enough_m) {
  SPOONBILL_ASSERT_DEBUG(tolerance_m > 0.0);
  pairs_.clear();
  pairs_.push_back({patch_of(*first_, a), patch_of(*second_, b), 0});
  while (!pairs_.empty() && best_distance_m_ > enough_m) {
    const Pair pair = pairs_.back();
    pairs_.pop_back();
    const double near_enough = std::max(best_distance_m_ - tolerance_m, enough_m);
    const auto are_apart = [&](const auto& distance) {
      return distance(pair.a.corners, pair.a.bulge, pair.b.corners, pair.b.bulge) >= near_enough;
    };
    // Of one surface, cells beside each other are the rule.
    if (are_apart(patch_distance) || (judge_ != nullptr && are_apart(patch_distance_aside))) continue;
    const Vector3 apart = centre_of(pair.b.corners) - centre_of(pair.a.corners);
    if (apart.norm() < best_distance_m_) {
      offer({0.5 * (pair.a.u0 + pair.a.u1), 0.5 * (pair.a.v0 + pair.a.v1), 0.5 * (pair.b.u0 + pair.b.u1),
             0.5 * (pair.b.v0 + pair.b.v1)});
    }
    if (pair.depth == deepest_cut || pairs_.size() + 4 > pair_capacity) {
      overflow_ = true;
      continue;
    }
    split(pair);
  }
}

std::array<PairSearch::Patch, 4> PairSearch::cut(const PiecewiseSurface& surface, const Patch& patch) {
  const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
  const Vector3 centre = position(surface, u, v), low_u = position(surface, patch.u0, v),
                high_u = position(surface, patch.u1, v), low_v = position(surface, u, patch.v0),
                high_v = position(surface, u, patch.v1);
  const auto& [p00, p01, p10, p11] = patch.corners;
  // Both sides are halved, and it goes by their squares.
  const double bulge = 0.25 * patch.bulge;
  return {Patch{patch.u0, u, patch.v0, v, {p00, low_u, low_v, centre}, bulge},
          Patch{patch.u0, u, v, patch.v1, {low_u, p01, centre, high_v}, bulge},
          Patch{u, patch.u1, patch.v0, v, {low_v, centre, p10, high_u}, bulge},
          Patch{u, patch.u1, v, patch.v1, {centre, high_v, high_u, p11}, bulge}};
}

void PairSearch::split(const Pair& pair) {
  const int depth = pair.depth + 1;
  if (pair.a.size() >= pair.b.size()) {
    for (const Patch& part : cut(first_->pieces(), pair.a)) pairs_.push_back({part, pair.b, depth});
  } else {
    for (const Patch& part : cut(second_->pieces(), pair.b)) pairs_.push_back({pair.a, part, depth});
  }
}

}  // namespace spoonbill
