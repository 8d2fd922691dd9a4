#include "engine/simulation/snapshot_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/tool.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// Returns the snapshot of a sphere of 6 mm radius that presses the handle, whose upper side is at 2.7 mm.
Snapshot pressed(Scene scene = small_handle()) {
  scene.planes.push_back({Vector3(0.015, 0, 0), Vector3::UnitX()});
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 200; ++tick) (void)simulation.advance(above(0.04, 0.009 - 1e-5 * tick));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  return snapshot;
}

double hull_height(const ContactStages& stages) {
  double highest = -1.0;
  for (const StageLine& line : stages.hulls) highest = std::max({highest, line.start_m.y(), line.end_m.y()});
  return highest;
}

TEST(SnapshotStages, ShowTheContactOfTheTool) {
  const Snapshot snapshot = pressed();
  ASSERT_FALSE(snapshot.contacts.empty());
  SnapshotStages finder;
  const ContactStages stages = finder.find(snapshot);
  EXPECT_EQ(stages.surfaces, 1);
  EXPECT_FALSE(stages.triangles.empty());
  ASSERT_FALSE(stages.contacts.empty());
  double apart = 1e30;
  for (const StageContact& contact : stages.contacts) {
    const double gap = (contact.at.point_m - snapshot.tool.proxy.position_m).norm() - snapshot.tool.radius_m;
    EXPECT_LE(gap, stage_margin_m);
    apart = std::min(apart, (contact.at.point_m - snapshot.contacts[0].point_m).norm());
  }
  // The snapshot's contact was found before the tick moved the surface and the tool.
  EXPECT_LT(apart, 1e-3);
  const auto& y = snapshot.bodies[0].surface.y;
  EXPECT_NEAR(hull_height(stages), *std::max_element(y.begin(), y.end()), 1e-9);
}

// A mesh has no control points and no hull.
TEST(SnapshotStages, LeaveOutAMeshThatGivesWay) {
  Snapshot snapshot = pressed();
  SnapshotStages finder;
  const ContactStages alone = finder.find(snapshot);
  BodySnapshot mesh;
  mesh.mesh.triangles = std::make_shared<const std::vector<TriangleCorners>>();
  ASSERT_TRUE(mesh.is_mesh());
  snapshot.bodies.push_back(mesh);
  const ContactStages stages = finder.find(snapshot);
  EXPECT_EQ(stages.surfaces, alone.surfaces);
  EXPECT_EQ(stages.spheres.size(), alone.spheres.size());
}

TEST(SnapshotStages, AreTheSameWhateverWasFoundBefore) {
  const Snapshot snapshot = pressed();
  Snapshot other = snapshot;
  other.tool.proxy.position_m.x() += 0.005;
  SnapshotStages used, fresh;
  (void)used.find(other);
  const ContactStages again = used.find(snapshot), first = fresh.find(snapshot);
  ASSERT_EQ(again.spheres.size(), first.spheres.size());
  for (std::size_t k = 0; k < first.spheres.size(); ++k) {
    EXPECT_EQ(again.spheres[k].kept, first.spheres[k].kept);
    EXPECT_EQ(again.spheres[k].cover.centre, first.spheres[k].cover.centre);
  }
  ASSERT_EQ(again.contacts.size(), first.contacts.size());
  for (std::size_t k = 0; k < first.contacts.size(); ++k) {
    EXPECT_EQ(again.contacts[k].at.point_m, first.contacts[k].at.point_m);
  }
}

TEST(SnapshotStages, FollowTheToolAndItsImage) {
  Snapshot snapshot = pressed();
  SnapshotStages finder;
  snapshot.symmetric = true;
  snapshot.mirrored_proxy = snapshot.tool.proxy;
  EXPECT_EQ(finder.find(snapshot).surfaces, 2);
  snapshot.symmetric = false;

  Surface finger = ellipsoid_tube(12, 12);
  for (std::vector<double>* values : {&finger.net.x, &finger.net.y, &finger.net.z}) {
    for (double& value : *values) value *= 0.25;
  }
  snapshot.tool.kind = ToolKind::solid;
  snapshot.tool.body = std::make_shared<ToolBody>(ToolBody{SurfaceSolid{finger}, std::nullopt});
  // The shortest half axis of the tool is 2.5 mm, so that the tool is half a millimetre deep.
  snapshot.tool.proxy.position_m.y() -= 0.006 - 0.002;
  const ContactStages of_surface = finder.find(snapshot);
  EXPECT_EQ(of_surface.surfaces, 2);
  EXPECT_GE(of_surface.contacts.size(), 2u);
  EXPECT_FALSE(of_surface.triangles.empty());

  snapshot.tool.body =
      std::make_shared<ToolBody>(ToolBody{ImplicitShape(BoxShape{{0.003, 0.0025, 0.002}}), std::nullopt});
  const ContactStages of_box = finder.find(snapshot);
  EXPECT_EQ(of_box.surfaces, 1);
  EXPECT_FALSE(of_box.contacts.empty());
}

TEST(SnapshotStages, LeaveOutWhatIsBroken) {
  Snapshot snapshot = pressed();
  SnapshotStages finder;
  snapshot.bodies[0].surface.x[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(finder.find(snapshot).surfaces, 0);
  snapshot.bodies[0].surface.x.pop_back();
  EXPECT_TRUE(finder.find(snapshot).hulls.empty());
  snapshot = pressed();
  snapshot.tool.proxy.position_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(finder.find(snapshot).surfaces, 0);
  EXPECT_EQ(finder.find(Snapshot()).surfaces, 0);
}

}  // namespace
}  // namespace spoonbill
