#include "engine/trial/bowl_change.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

constexpr double fading_fraction = 0.2;  // of the bowl's length, behind the rim

}  // namespace

void change_bowl(const Bowl& bowl, const BowlChange& change, Surface& surface) {
  if (change == BowlChange()) return;
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) {
      const Vector3 point = surface.net.point(i, j);
      const Vector3 offset = point - bowl.centre_m;
      const double behind_m = -bowl.front.dot(offset) - 0.5 * bowl.length_m;
      const double share = std::clamp(1.0 - behind_m / (fading_fraction * bowl.length_m), 0.0, 1.0);
      const double weight = share * share * (3.0 - 2.0 * share);
      const double side_m = bowl.left().dot(offset), depth_m = -bowl.normal.dot(offset);
      Vector3 moved = weight * (change.width - 1.0) * side_m * bowl.left();
      if (depth_m > 0.0) {
        const double wanted_m =
            change.depth * bowl.depth_m * std::pow(depth_m / bowl.depth_m, change.curvature);
        moved -= weight * (wanted_m - depth_m) * bowl.normal;
      }
      surface.net.set_point(i, j, point + moved);
    }
  }
}

}  // namespace spoonbill
