#include "engine/collision/surfaces/pair_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>

#include "engine/base/assert.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

namespace {

constexpr int max_separation_steps = 32;
// Largest rounding error of a gap between hulls, as a fraction of the coordinates.
constexpr double rounding = 1e-12;

Vector3 farthest(const ControlNet& net, const Vector3& direction) {
  double most = -std::numeric_limits<double>::infinity();
  std::size_t at = 0;
  for (std::size_t k = 0; k < net.size(); ++k) {
    const double along = direction.x() * net.x[k] + direction.y() * net.y[k] + direction.z() * net.z[k];
    if (!(along > most)) continue;
    most = along;
    at = k;
  }
  return {net.x[at], net.y[at], net.z[at]};
}

// Up to four points of the Minkowski difference of the two hulls. They are reduced to the points that span
// the face nearest to the origin.
struct Simplex {
  std::array<Vector3, 4> points;
  int count = 0;
};

// Finds the point nearest to the origin on the affine hull of some points of the simplex, given as the bits
// of `set`. Returns false if the found point is outside the convex hull of these points.
bool nearest_within(const Simplex& simplex, unsigned set, Vector3& nearest) {
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3> edges(3, 0);
  int first = -1;
  for (int k = 0; k < simplex.count; ++k) {
    if ((set >> k & 1U) == 0U) continue;
    if (first < 0) {
      first = k;
      continue;
    }
    edges.conservativeResize(Eigen::NoChange, edges.cols() + 1);
    edges.rightCols<1>() = simplex.points[k] - simplex.points[first];
  }
  nearest = simplex.points[first];
  if (edges.cols() == 0) return true;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
  const Square products = edges.transpose() * edges;
  const Column wanted = -(edges.transpose() * simplex.points[first]);
  const Eigen::PartialPivLU<Square> factors(products);
  const Column weights = factors.solve(wanted);
  nearest += edges * weights;
  return weights.allFinite() && weights.minCoeff() >= 0.0 && weights.sum() <= 1.0;
}

// Returns the point of the simplex nearest to the origin, and reduces the simplex to the face that contains
// this point.
Vector3 shrink_to_nearest(Simplex& simplex) {
  Vector3 best = simplex.points[0];
  unsigned best_set = 1;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < 1U << simplex.count; ++set) {
    Vector3 nearest;
    if (!nearest_within(simplex, set, nearest) || !(nearest.squaredNorm() < least)) continue;
    least = nearest.squaredNorm();
    best = nearest;
    best_set = set;
  }
  Simplex smaller;
  for (int k = 0; k < simplex.count; ++k) {
    if ((best_set >> k & 1U) != 0U) smaller.points[smaller.count++] = simplex.points[k];
  }
  simplex = smaller;
  return best;
}

}  // namespace

bool hulls_are_apart(const ControlNet& first, const ControlNet& second) {
  SPOONBILL_ASSERT(first.size() > 0 && second.size() > 0);
  Simplex simplex;
  Vector3 nearest(first.x[0] - second.x[0], first.y[0] - second.y[0], first.z[0] - second.z[0]);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < max_separation_steps; ++step) {
    const Vector3 a = farthest(first, -nearest), b = farthest(second, nearest);
    // A value above the noise proves that a plane perpendicular to `nearest` separates the hulls.
    const double noise = rounding * nearest.norm() * (a.norm() + b.norm());
    if (nearest.dot(a - b) > noise) return true;
    simplex.points[simplex.count++] = a - b;
    nearest = shrink_to_nearest(simplex);
    if (simplex.count == 4 || !(nearest.squaredNorm() < before)) return false;
    before = nearest.squaredNorm();
  }
  return false;
}

namespace {

constexpr std::size_t pair_capacity = 1024;
constexpr int max_depth = 40;
// Largest number of patches that are split in one query. Splitting so many takes a few seconds. Surfaces that
// fit snugly or are crumpled would otherwise be cut everywhere into patches as small as the tolerance.
constexpr int split_capacity = 1 << 20;

}  // namespace

PairSearch::PairSearch(SurfaceLevels& first, SurfaceLevels& second, const PairJudge* judge)
    : first_(&first), second_(&second), judge_(judge) {
  SPOONBILL_ASSERT(&first != &second || judge != nullptr);
  pairs_.reserve(pair_capacity);
}

void PairSearch::begin() {
  forget_best();
  splits_left_ = split_capacity;
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

PairSearch::Patch PairSearch::make_patch(SurfaceLevels& levels, const LevelCell& cell) {
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
  pairs_.push_back({make_patch(*first_, a), make_patch(*second_, b), 0});
  while (!pairs_.empty() && best_distance_m_ > enough_m) {
    const Pair pair = pairs_.back();
    pairs_.pop_back();
    const double near_enough = std::max(best_distance_m_ - tolerance_m, enough_m);
    const auto are_apart = [&](const auto& distance) {
      return distance(pair.a.corners, pair.a.bulge, pair.b.corners, pair.b.bulge) >= near_enough;
    };
    // The second test is worthwhile only for one surface against itself, where most cells are side by side.
    if (are_apart(patch_distance) || (judge_ != nullptr && are_apart(patch_distance_in_plane))) continue;
    const Vector3 offset = patch_centre(pair.b.corners) - patch_centre(pair.a.corners);
    if (offset.norm() < best_distance_m_) {
      offer({0.5 * (pair.a.u0 + pair.a.u1), 0.5 * (pair.a.v0 + pair.a.v1), 0.5 * (pair.b.u0 + pair.b.u1),
             0.5 * (pair.b.v0 + pair.b.v1)});
    }
    if (pair.depth == max_depth || pairs_.size() + 4 > pair_capacity || splits_left_ <= 0) {
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
  // The bulge grows with the square of a patch's sides, and the sides of each quarter are half as long.
  const double bulge = 0.25 * patch.bulge;
  return {Patch{patch.u0, u, patch.v0, v, {p00, low_u, low_v, centre}, bulge},
          Patch{patch.u0, u, v, patch.v1, {low_u, p01, centre, high_v}, bulge},
          Patch{u, patch.u1, patch.v0, v, {low_v, centre, p10, high_u}, bulge},
          Patch{u, patch.u1, v, patch.v1, {centre, high_v, high_u, p11}, bulge}};
}

void PairSearch::split(const Pair& pair) {
  --splits_left_;
  const int depth = pair.depth + 1;
  if (pair.a.size() >= pair.b.size()) {
    for (const Patch& part : cut(first_->pieces(), pair.a)) pairs_.push_back({part, pair.b, depth});
  } else {
    for (const Patch& part : cut(second_->pieces(), pair.b)) pairs_.push_back({pair.a, part, depth});
  }
}

}  // namespace spoonbill
