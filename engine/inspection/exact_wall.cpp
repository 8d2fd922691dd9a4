#include "engine/inspection/exact_wall.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr double rounding_m = 1e-8;

}  // namespace

ExactWalls::ExactWalls(const std::vector<const Surface*>& surfaces, double error_m)
    : reach_m_(2.0 * error_m + rounding_m) {
  SPOONBILL_ASSERT(error_m >= 0.0);
  SPOONBILL_ASSERT_DEBUG(
      std::none_of(surfaces.begin(), surfaces.end(), [](const Surface* one) { return one == nullptr; }));
  faces_.reserve(surfaces.size());
  for (const Surface* surface : surfaces) {
    faces_.push_back({surface, bounding_box(surface->net), ThicknessSearch(*surface)});
  }
}

// Through the surface, of those whose nets reach there, out of which the line comes nearest to `expected`.
std::optional<ExactWalls::FoundExit> ExactWalls::exit_near(const Vector3& from, const Vector3& expected,
                                                           const Vector3& direction) const {
  std::optional<FoundExit> best;
  const double distance_m = (expected - from).norm();
  for (const Face& face : faces_) {
    if (!face.net.is_near({expected, expected}, reach_m_)) continue;
    const auto exit = face.search.exit(from, direction);
    if (!exit) continue;
    const double off_m = std::abs(exit->distance_m - distance_m);
    if (!best || off_m < std::abs(best->exit.distance_m - distance_m)) best = FoundExit{face.surface, *exit};
  }
  return best;
}

std::optional<WallThickness> ExactWalls::at(const WallThickness& of_mesh) const {
  if (!(of_mesh.thickness_m > 0.0)) return std::nullopt;
  const Vector3 middle = 0.5 * (of_mesh.position_m + of_mesh.opposite_m);
  const Vector3 outward = (of_mesh.position_m - of_mesh.opposite_m).stableNormalized();
  const auto start = exit_near(middle, of_mesh.position_m, outward);
  if (!start) return std::nullopt;
  const Vector3 inward = -unit_normal(*start->surface, start->exit.u, start->exit.v);
  if (!(inward.squaredNorm() > 0.5)) return std::nullopt;
  WallThickness wall;
  wall.position_m = middle + start->exit.distance_m * outward;
  const auto end = exit_near(wall.position_m, of_mesh.opposite_m, inward);
  if (!end) return std::nullopt;
  wall.thickness_m = end->exit.distance_m;
  wall.opposite_m = wall.position_m + wall.thickness_m * inward;
  // By no more at either end than that.
  if (std::abs(wall.thickness_m - of_mesh.thickness_m) > 2.0 * reach_m_) return std::nullopt;
  return wall;
}

}  // namespace spoonbill
