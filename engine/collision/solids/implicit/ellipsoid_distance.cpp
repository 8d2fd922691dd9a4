#include "engine/collision/solids/implicit/ellipsoid_distance.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {

EllipsoidDistance::EllipsoidDistance(const EllipsoidShape& shape) : axes_(shape.semi_axes_m) {
  const double least = axes_.minCoeff(&shortest_);
  for (int k = 0; k < 3; ++k) {
    ratio_[k] = (axes_[k] / least) * (axes_[k] / least);
    excess_[k] = ((axes_[k] - least) / least) * ((axes_[k] + least) / least);
  }
}

// One over the norm of c_i / (w + excess_i) is concave and grows with w, so that Newton's method from below
// its root never passes it (More and Sorensen 1983).
double EllipsoidDistance::solve(const Vector3& scaled, double low) const {
  double w = low;
  for (int step = 0; step < 60; ++step) {
    double sum = 0.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (!(scaled[k] > 0.0)) continue;
      const double below = w + excess_[k], term = (scaled[k] / below) * (scaled[k] / below);
      sum += term;
      slope += term / below;
    }
    const double next = w + (sum / slope) * (std::sqrt(sum) - 1.0);
    if (!(next > w)) break;
    const double gain = next - w;
    w = next;
    if (gain < 1e-16 * w) break;
  }
  return w;
}

// Where the point lies in the plane of the two longer axes so far inside that the nearest point is above or
// below it.
DistanceSample EllipsoidDistance::in_middle(const Vector3& point_m) const {
  Vector3 nearest = Vector3::Zero();
  double left = 1.0;
  for (int k = 0; k < 3; ++k) {
    if (!(excess_[k] > 0.0)) continue;
    nearest[k] = point_m[k] * (ratio_[k] / excess_[k]);
    left -= (nearest[k] / axes_[k]) * (nearest[k] / axes_[k]);
  }
  nearest[shortest_] = axes_[shortest_] * std::sqrt(std::max(left, 0.0));
  const Vector3 normal = nearest.cwiseQuotient(axes_).cwiseQuotient(axes_).normalized();
  return {-(nearest - point_m).norm(), normal};
}

DistanceSample EllipsoidDistance::at(const Vector3& point_m) const {
  const Vector3 scaled = ratio_.cwiseProduct(point_m.cwiseAbs().cwiseQuotient(axes_));
  const double low = std::max((scaled - excess_).maxCoeff(), 0.0);
  if (!(low > 0.0)) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (excess_[k] > 0.0) sum += (scaled[k] / excess_[k]) * (scaled[k] / excess_[k]);
    }
    if (sum <= 1.0) return in_middle(point_m);
  }
  const double w = solve(scaled, low);
  Vector3 normal;
  for (int k = 0; k < 3; ++k) {
    const double below = w + excess_[k];
    normal[k] = below > 0.0 ? point_m[k] / below : 0.0;
  }
  const double length = normal.norm();
  return {(w - 1.0) * length, normal / length};
}

}  // namespace spoonbill
