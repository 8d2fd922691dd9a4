#include "engine/collision/surfaces/convex_hull.h"

#include <Eigen/LU>
#include <array>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr int most_steps = 32;
// Of the coordinates: what rounding may leave of a gap that is none.
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

// Up to four points of the difference of the hulls, of which only those are kept that span the part nearest
// to the origin.
struct Simplex {
  std::array<Vector3, 4> points;
  int count = 0;
};

// The point nearest to the origin on the plane, line or point through the points of the set; false where it
// lies outside of them.
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
  const Column shares = factors.solve(wanted);
  nearest += edges * shares;
  return shares.allFinite() && shares.minCoeff() >= 0.0 && shares.sum() <= 1.0;
}

// The point of the simplex nearest to the origin; the simplex becomes the part that it lies on.
Vector3 take_nearest(Simplex& simplex) {
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
  Simplex kept;
  for (int k = 0; k < simplex.count; ++k) {
    if ((best_set >> k & 1U) != 0U) kept.points[kept.count++] = simplex.points[k];
  }
  simplex = kept;
  return best;
}

}  // namespace

bool hulls_are_apart(const ControlNet& first, const ControlNet& second) {
  SPOONBILL_ASSERT(first.size() > 0 && second.size() > 0);
  Simplex simplex;
  Vector3 nearest(first.x[0] - second.x[0], first.y[0] - second.y[0], first.z[0] - second.z[0]);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < most_steps; ++step) {
    const Vector3 a = farthest(first, -nearest), b = farthest(second, nearest);
    // The first hull lies on the far side of a plane across `nearest`, the second on the near side.
    const double noise = rounding * nearest.norm() * (a.norm() + b.norm());
    if (nearest.dot(a - b) > noise) return true;
    simplex.points[simplex.count++] = a - b;
    nearest = take_nearest(simplex);
    if (simplex.count == 4 || !(nearest.squaredNorm() < before)) return false;
    before = nearest.squaredNorm();
  }
  return false;
}

}  // namespace spoonbill
