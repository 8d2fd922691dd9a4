// Compares the contact stages of a tool and a surface with dense samples of the surface.
#include "engine/collision/stages/tool_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/collision/solids/implicit_shapes.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

struct StagesCase {
  Surface surface;
  NestedGrid nested;
  std::shared_ptr<const SignedDistance> solid;
  ToolShape tool;
  double margin_m = 0.0;
  ContactStages stages;
};

// Returns a case with a sphere or a box that touches the surface or comes within the margin of it.
StagesCase touching_case(Random& random) {
  const Surface surface = random_surface(random);
  StagesCase made{
      surface, make_nested_grid(surface.u, surface.v, finest_stage_level).value(), nullptr, {}, 0.0, {}};
  const Vector3 at = position(made.surface, random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
  const Vector3 aside(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
  made.margin_m = random.integer(0, 1) == 0 ? 0.0 : 0.01;
  if (random.integer(0, 1) == 0) {
    made.tool = ToolShape::sphere(at + aside, aside.norm() + random.uniform(0.0, 0.05));
  } else {
    made.solid = make_signed_distance(BoxShape{Vector3::Constant(0.18)});
    made.tool = ToolShape::solid(*made.solid, {at + aside, Quaternion::Identity()});
    made.tool.turn =
        Eigen::AngleAxisd(random.uniform(0.0, 3.0), Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  }
  ToolStages finder = ToolStages::make(made.surface.u, made.surface.v).value();
  finder.add(made.surface, made.tool, made.margin_m, false, made.stages);
  return made;
}

int step_of(const LevelCell& cell) {
  return 1 << (finest_stage_level - cell.level);
}

template <class Visit>
void visit_points(const StagesCase& made, const LevelCell& cell, int side, const Visit& visit) {
  const auto& u = made.nested.grid.u.parameters;
  const auto& v = made.nested.grid.v.parameters;
  const int step = step_of(cell);
  for (int k = 0; k < side * side; ++k) {
    const double s = static_cast<double>(k / side) / (side - 1),
                 t = static_cast<double>(k % side) / (side - 1);
    visit(position(made.surface, u[cell.i] + s * (u[cell.i + step] - u[cell.i]),
                   v[cell.j] + t * (v[cell.j + step] - v[cell.j])));
  }
}

bool holds(const StagesCase& made, const LevelCell& cell, const SurfaceContact& contact) {
  const auto& u = made.nested.grid.u.parameters;
  const auto& v = made.nested.grid.v.parameters;
  const int step = step_of(cell);
  return contact.u >= u[cell.i] && contact.u <= u[cell.i + step] && contact.v >= v[cell.j] &&
         contact.v <= v[cell.j + step];
}

class ToolStagesOfRandomSurfaces : public ::testing::Test {
 protected:
  template <class Check>
  static void for_cases(const Check& check) {
    Random random(311);
    const int cases = random_cases(25, 400);
    for (int k = 0; k < cases; ++k) {
      SCOPED_TRACE(k);
      check(touching_case(random));
    }
  }
};

TEST_F(ToolStagesOfRandomSurfaces, SpheresHoldTheirPatches) {
  for_cases([](const StagesCase& made) {
    ASSERT_FALSE(made.stages.spheres.empty());
    for (const StageSphere& sphere : made.stages.spheres) {
      double farthest = 0.0;
      visit_points(made, sphere.cell, 5, [&](const Vector3& point) {
        farthest = std::max(farthest, (point - sphere.cover.centre).norm());
      });
      EXPECT_LE(farthest, sphere.cover.radius * (1.0 + 1e-12));
    }
  });
}

// A cell that was dropped has no point within the margin of the tool.
TEST_F(ToolStagesOfRandomSurfaces, WhatIsDroppedDoesNotMeetTheTool) {
  int dropped = 0;
  for_cases([&](const StagesCase& made) {
    std::vector<StageSphere> coarsest;
    for (const StageSphere& sphere : made.stages.spheres) {
      if (sphere.cell.level == 0) coarsest.push_back(sphere);
      if (sphere.kept) continue;
      ++dropped;
      visit_points(made, sphere.cell, 5,
                   [&](const Vector3& point) { EXPECT_GT(made.tool.distance(point), made.margin_m); });
    }
    EXPECT_EQ(coarsest.size(), static_cast<std::size_t>(made.stages.elements_within));
    const Grid& grid = made.nested.grid;
    const int stride = step_of({0, 0, 0});
    for (int i = 0; i + 1 < grid.rows(); i += stride) {
      for (int j = 0; j + 1 < grid.columns(); j += stride) {
        if (std::any_of(coarsest.begin(), coarsest.end(),
                        [&](const StageSphere& s) { return s.cell.i == i && s.cell.j == j; })) {
          continue;
        }
        visit_points(made, {i, j, 0}, 5,
                     [&](const Vector3& point) { EXPECT_GT(made.tool.distance(point), made.margin_m); });
      }
    }
  });
  EXPECT_GT(dropped, 1000);
}

TEST_F(ToolStagesOfRandomSurfaces, WhatIsKeptIsRefined) {
  for_cases([](const StagesCase& made) {
    int kept[finest_stage_level + 1] = {}, visited[finest_stage_level + 1] = {};
    for (const StageSphere& sphere : made.stages.spheres) {
      ++visited[sphere.cell.level];
      kept[sphere.cell.level] += sphere.kept ? 1 : 0;
    }
    for (int level = 0; level < finest_stage_level; ++level) EXPECT_EQ(visited[level + 1], 4 * kept[level]);
    EXPECT_EQ(made.stages.triangles_tested, 2 * kept[finest_stage_level]);
  });
}

TEST_F(ToolStagesOfRandomSurfaces, ContactsLieInTrianglesAndKeptSpheresOfEachLevel) {
  for_cases([](const StagesCase& made) {
    ASSERT_FALSE(made.stages.contacts.empty());
    for (const StageContact& contact : made.stages.contacts) {
      const auto& triangles = made.stages.triangles;
      EXPECT_TRUE(std::any_of(triangles.begin(), triangles.end(), [&](const StageTriangle& triangle) {
        return holds(made, triangle.cell, contact.at);
      }));
      for (int level = 0; level <= finest_stage_level; ++level) {
        EXPECT_TRUE(std::any_of(made.stages.spheres.begin(), made.stages.spheres.end(),
                                [&](const StageSphere& sphere) {
                                  const double away = (contact.at.point_m - sphere.cover.centre).norm();
                                  return sphere.kept && sphere.cell.level == level &&
                                         holds(made, sphere.cell, contact.at) &&
                                         away <= sphere.cover.radius * (1.0 + 1e-12);
                                }))
            << level;
      }
      EXPECT_NEAR(contact.at.normal.dot(contact.at.tangent_u), 0.0, 1e-12);
      EXPECT_NEAR(contact.at.normal.dot(contact.at.tangent_v), 0.0, 1e-12);
    }
  });
}

// Each cell with a point within the margin of the tool has a triangle. The distance of a triangle from the
// tool is at most the margin, plus the largest distance of the triangle from the surface, plus 1/16 of the
// longest side, because the code tests balls around parts of the triangle.
TEST_F(ToolStagesOfRandomSurfaces, TrianglesAreThoseThatMeetTheTool) {
  for_cases([](const StagesCase& made) {
    const auto& triangles = made.stages.triangles;
    for (const StageSphere& sphere : made.stages.spheres) {
      if (sphere.cell.level < finest_stage_level || !sphere.kept) continue;
      double nearest = 1e30;
      visit_points(made, sphere.cell, 5,
                   [&](const Vector3& point) { nearest = std::min(nearest, made.tool.distance(point)); });
      if (nearest > made.margin_m) continue;
      EXPECT_TRUE(std::any_of(triangles.begin(), triangles.end(), [&](const StageTriangle& triangle) {
        return triangle.cell.i == sphere.cell.i && triangle.cell.j == sphere.cell.j;
      }));
    }
    SurfaceLevels levels(made.nested);
    levels.begin(made.surface);
    for (const StageTriangle& triangle : triangles) {
      const auto& [a, b, c] = triangle.corners;
      double nearest = 1e30;
      for (int k = 0; k <= 32; ++k) {
        for (int l = 0; l + k <= 32; ++l) {
          nearest = std::min(nearest, made.tool.distance(a + (b - a) * (k / 32.0) + (c - a) * (l / 32.0)));
        }
      }
      const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
      EXPECT_LE(nearest, made.margin_m + triangle_slack(levels, triangle.cell) + longest / 16.0);
    }
  });
}

TEST(ToolStages, OfATrianglePairFarFromItsBilinearPatchHaveItsSlack) {
  // The surface is z = x y over the unit square. Its centre is a quarter below the diagonal from the corner
  // at z = 0 to the corner at z = 1.
  const KnotVector knots = KnotVector::clamped_uniform(1, 2).value();
  ControlNet net(2, 2);
  for (int k = 0; k < 4; ++k) net.set_point(k / 2, k % 2, {1.0 * (k / 2), 1.0 * (k % 2), k == 3 ? 1.0 : 0.0});
  const Surface surface = make_surface(knots, knots, net).value();
  const NestedGrid nested = make_nested_grid(knots, knots, 0).value();
  SurfaceLevels levels(nested);
  levels.begin(surface);
  EXPECT_NEAR(triangle_slack(levels, {0, 0, 0}) - levels.bulge({0, 0, 0}), 0.25, 1e-15);
}

TEST(ToolStages, ShowNoContactWhereThereIsNone) {
  Random random(5);
  const Surface surface = random_surface(random);
  ToolStages finder = ToolStages::make(surface.u, surface.v).value();
  ContactStages stages;
  finder.add(surface, ToolShape::sphere({0.0, 0.0, 30.0}, 0.1), 1e-4, false, stages);
  EXPECT_TRUE(stages.contacts.empty());
  EXPECT_TRUE(stages.triangles.empty());
  EXPECT_EQ(stages.surfaces, 1);
}

}  // namespace
}  // namespace spoonbill
