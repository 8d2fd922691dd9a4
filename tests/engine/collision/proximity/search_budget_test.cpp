// Tests that contact searches stay within their budgets of evaluations where surfaces are crumpled or fit
// snugly, and that they report a budget that is used up. Work is counted, never timed.
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <vector>

#include "engine/collision/proximity/mesh_proximity.h"
#include "engine/collision/proximity/self_proximity.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/surface_collider.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/random.h"

namespace spoonbill {
namespace {

constexpr double crumpled_m = 0.005;
// Upper limit of the evaluations of one search. After its budget is used up, each remaining near point costs
// one more evaluation. The second multiple of near_point_limit is a reserve for the step in progress.
constexpr int most_evaluations = proximity_evaluation_limit + 2 * static_cast<int>(near_point_limit);

// Returns a tube whose control points are at random in a small box.
Surface crumpled_tube(std::uint64_t seed, int around, int along) {
  Random random(seed);
  Surface tube = ellipsoid_tube(around, along);
  for (int i = 0; i < tube.net.rows; ++i) {
    for (int j = 0; j < tube.net.columns; ++j) {
      tube.net.set_point(i, j, random.in_box(Vector3::Constant(crumpled_m)));
    }
  }
  return tube;
}

NestedGrid grid_of(const Surface& surface) {
  return make_nested_grid(surface.u, surface.v, 1).value();
}

TEST(SearchBudget, OfTwoCrumpledSurfacesIsKept) {
  const Surface one = crumpled_tube(1, 40, 40), other = crumpled_tube(2, 40, 40);
  const NestedGrid one_grid = grid_of(one), other_grid = grid_of(other);
  SurfaceProximity proximity(one_grid, other_grid);
  proximity.find(one, other, crumpled_m);
  EXPECT_TRUE(proximity.overflow());
  for (const int evaluations : {proximity.first_evaluations(), proximity.second_evaluations()}) {
    EXPECT_GE(evaluations, proximity_evaluation_limit) << "the scene is to use up the budget";
    EXPECT_LE(evaluations, most_evaluations);
  }
  EXPECT_LE(proximity.first_points().size(), near_point_limit);
  EXPECT_LE(proximity.second_points().size(), near_point_limit);
}

TEST(SearchBudget, OfACrumpledSurfaceAgainstItselfIsKept) {
  const Surface rest = ellipsoid_tube(40, 40), now = crumpled_tube(3, 40, 40);
  const NestedGrid nested = make_nested_grid(rest.u, rest.v, 2).value();
  SelfProximity proximity(nested, rest, 0.0005);
  proximity.find(now, crumpled_m);
  EXPECT_TRUE(proximity.overflow());
  EXPECT_GE(proximity.evaluations(), proximity_evaluation_limit) << "the scene is to use up the budget";
  EXPECT_LE(proximity.evaluations(), most_evaluations);
  EXPECT_LE(proximity.points().size(), near_point_limit);
}

// The mesh is outside the body but within the bounding boxes of the body's coarse elements. Every vertex is
// therefore compared with the surface, and none is near enough to count.
TEST(SearchBudget, OfAMeshAroundASurfaceIsKept) {
  const Surface surface = ellipsoid_tube(8, 8);
  const NestedGrid nested = grid_of(surface);
  TriangleMesh around = ball_mesh(200, 300, 1.0);
  for (Vector3& vertex : around.vertices_m) vertex = vertex.cwiseProduct(1.2 * Vector3(0.02, 0.01, 0.05));
  std::vector<int> patches(around.vertices_m.size());
  std::iota(patches.begin(), patches.end(), 0);
  MeshProximity proximity(nested, patches);
  proximity.find(surface, DeformingMesh(around), 0.0);
  EXPECT_TRUE(proximity.overflow());
  EXPECT_GE(proximity.evaluations(), proximity_evaluation_limit) << "the scene is to use up the budget";
  // After the budget is used up, each vertex that is still to be compared costs at most two evaluations: one
  // for itself, and one for the deepest vertex of its patch.
  EXPECT_LE(proximity.evaluations(), proximity_evaluation_limit + 2 * static_cast<int>(patches.size()));
  EXPECT_LE(proximity.surface_samples().size(), near_point_limit);
  EXPECT_LE(proximity.mesh_vertices().size(), near_point_limit);
}

// A half-space below a plane. is_convex() returns false, although the half-space is convex.
class UnknownFloor : public SignedDistance {
 public:
  DistanceSample at(const Vector3& point_m) const override { return {point_m.y() + 0.001, Vector3::UnitY()}; }
  bool is_convex() const override { return false; }
  Box bounds() const override { return {Vector3::Constant(-1.0), Vector3::Constant(1.0)}; }
};

// All points of the sheet are equally near to the tool.
TEST(SearchBudget, OfAToolAlongASheetIsKept) {
  const Surface sheet = quadric_sheet(0.05, 0.0, 0.0, 12);
  const NestedGrid nested = grid_of(sheet);
  SurfaceCollider collider(nested);
  const UnknownFloor floor;
  const CollisionResult result = collider.collide(sheet, ToolShape::solid(floor, {}), 0.01, false);
  EXPECT_TRUE(result.overflow);
  EXPECT_EQ(result.cuts, surface_cut_limit) << "the scene is to use up the budget";
  EXPECT_TRUE(result.found);
  EXPECT_NEAR(result.nearest.depth_m, -0.001, 1e-9) << "the best answer so far";
}

// A search whose budget is used up ends with the best point so far.
TEST(SearchBudget, OfANearestPointIsKeptWithTheBestPointSoFar) {
  const Surface surface = crumpled_tube(6, 24, 24);
  const NestedGrid nested = grid_of(surface);
  SurfaceLevels levels(nested);
  levels.begin(surface);
  const Vector3 point(2.0 * crumpled_m, 0.0, 0.0);
  const double u = surface.u.domain_start(), v = 0.5 * (surface.v.domain_start() + surface.v.domain_end());
  double last_m = std::numeric_limits<double>::infinity();
  for (const int allowed : {1, 2, 4, 8, 16, 1000}) {
    PolishBudget budget{allowed};
    const NearestPoint nearest = nearest_point(levels.pieces(), point, u, v, &budget);
    const double distance_m = (nearest.at.position_m - point).norm();
    EXPECT_GE(budget.evaluations_left, -1) << allowed;
    EXPECT_LE(distance_m, last_m) << allowed;
    last_m = distance_m;
  }
}

}  // namespace
}  // namespace spoonbill
