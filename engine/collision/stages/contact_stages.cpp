#include "engine/collision/stages/contact_stages.h"

#include "engine/base/assert.h"
#include "engine/collision/stages/hull_facets.h"

namespace spoonbill {

void add_hull(const ControlNet& net, ContactStages& stages) {
  SPOONBILL_ASSERT(net.z.size() == net.size());
  std::vector<Vector3> points;
  for (std::size_t k = 0; k < net.size(); ++k) points.emplace_back(net.x[k], net.y[k], net.z[k]);
  for (const auto& [a, b] : hull_facets(points).edges) {
    keep(StageLine{points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]}, stages.hulls,
         stages);
  }
}

// The middle of a bilinear patch leaves the diagonal of its triangles by a quarter of how far the corners are
// from a parallelogram, and no other point leaves them farther.
double triangle_slack(SurfaceLevels& levels, const LevelCell& cell) {
  const PatchCorners at = levels.corners(cell);
  return levels.bulge(cell) + 0.25 * (at[0] + at[3] - at[1] - at[2]).norm();
}

std::array<Triangle, 2> triangles_of(const PatchCorners& at) {
  return {{{at[0], at[2], at[1]}, {at[3], at[1], at[2]}}};
}

}  // namespace spoonbill
