#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/refusal.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/impact.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

// Returns a pebble of 40 x 20 x 100 mm with its flat side up.
Body pebble(const Vector3& centre, int nodes) {
  return {"pebble", ellipsoid_tube(12, 12, centre), silicone(), {nodes, {}}};
}

BodyState state_of(const Body& body) {
  return make_body_state(body, {}, InstructionSet::baseline).value();
}

double depth_between_bodies(const Impact& impact) {
  return depth_between(impact.body(0).mapping().current(), impact.body(1).mapping().current());
}

// The pebbles meet with their flat sides and off centre, so that they also begin to turn.
TEST(Bodies, ThatCollideKeepTheirMomentum) {
  Impact impact(state_of(pebble({0, 0, 0}, 400)), state_of(pebble({0.012, 0.0235, 0.02}, 700)));
  impact.throw_at(1, {0.01, -0.06, 0.005});
  double sum_of_sizes = 0.0, deepest = 0.0;
  const Vector3 before = impact.momentum_of(1, &sum_of_sizes);
  int touching = 0;
  for (int tick = 0; tick < 400; ++tick) {
    touching += impact.tick() ? 1 : 0;
    if (tick % 5 == 0) deepest = std::max(deepest, depth_between_bodies(impact));
  }
  EXPECT_GT(touching, 50);
  EXPECT_FALSE(impact.tick()) << "they have parted";
  const Vector3 change = impact.momentum_of(0) + impact.momentum_of(1) - before;
  EXPECT_LT(change.norm(), 1e-5 * sum_of_sizes);
  EXPECT_LT(impact.momentum_of(0).y(), 0.25 * before.y()) << "the one that was hit took some of it over";
  // The control nets follow a dent one cell wide only in part; the limit is the penetration that may remain.
  const double cell = static_cast<double>(impact.body(0).lattice.cell_size_m());
  EXPECT_LT(deepest, body_depth_limit_cells * cell);
}

TEST(Bodies, ThatBeginInEachOtherPart) {
  Impact impact(state_of(pebble({0, 0, 0}, 400)), state_of(pebble({0.0, 0.0215, 0.0}, 400)));
  EXPECT_GT(depth_between_bodies(impact), 0.5e-3) << "they begin in each other";
  for (int tick = 0; tick < 100; ++tick) impact.tick();
  EXPECT_LT(depth_between_bodies(impact), 0.1e-3);
  EXPECT_LT(impact.momentum_of(0).y(), 0.0);
  EXPECT_GT(impact.momentum_of(1).y(), 0.0);
}

// Returns two handles, one above the other. A plane fixes the end of both. The tool's action on the upper
// handle reaches the lower one.
Scene stacked_handles() {
  Scene scene = small_handle();
  Body upper = scene.bodies[0];
  upper.name = "upper";
  for (double& y : upper.surface.net.y) y += 0.006;
  scene.bodies.push_back(std::move(upper));
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  return scene;
}

// Expects the contact to be on its body: the contact's frame is the frame of the surface, and its point is
// the weighted mean of the positions of its nodes.
void expect_is_on_its_body(const Simulation& simulation, const ContactSnapshot& contact) {
  const SpringLattice& lattice = simulation.lattice(contact.body);
  double sum = 0.0;
  Vector3 carried = Vector3::Zero();
  for (int k = 0; k < contact.nodes.count; ++k) {
    sum += static_cast<double>(contact.nodes.weight[k]);
    carried += static_cast<double>(contact.nodes.weight[k]) * lattice.position(contact.nodes.node[k]);
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
  // The tick has moved the nodes since the contact was found, and the surface follows the lattice only as far
  // as its control points permit.
  EXPECT_LT((carried - contact.point_m).norm(), 0.1 * static_cast<double>(lattice.cell_size_m()));
  const SurfacePoint at = evaluate(simulation.surface(contact.body), contact.u, contact.v);
  EXPECT_LT((at.position_m - contact.point_m).norm(), 0.1 * static_cast<double>(lattice.cell_size_m()));
  EXPECT_GT(contact.tangent_u.dot(at.du.normalized()), 0.99);
  EXPECT_NEAR(contact.normal.dot(contact.tangent_u), 0.0, 1e-12);
  EXPECT_LT((contact.tangent_v - contact.normal.cross(contact.tangent_u)).norm(), 1e-12);
}

TEST(Bodies, TellWhereTheyAreTouchedAndByWhichNodes) {
  Simulation simulation = simulate(stacked_handles());
  const double top = 0.006 + 0.0025 + 0.006;
  for (int tick = 0; tick < 400; ++tick) simulation.advance(above(0.055, top - 1e-5 * tick));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  int of_body[2] = {0, 0};
  for (const ContactSnapshot& contact : snapshot.contacts) {
    ASSERT_TRUE(contact.body == 0 || contact.body == 1);
    ++of_body[contact.body];
    expect_is_on_its_body(simulation, contact);
  }
  EXPECT_GE(of_body[0], 1) << "the upper handle lies on it";
  EXPECT_GE(of_body[1], 2) << "it lies on the lower one, and the tool is on it";
}

TEST(Bodies, PassAPushOn) {
  Simulation simulation = simulate(stacked_handles());
  const double before = lowest(simulation.surface(0));
  const double top = 0.006 + 0.0025 + 0.006;
  bool touching = false;
  for (int tick = 0; tick < 400; ++tick) {
    touching |= simulation.advance(above(0.055, top - 1e-5 * tick)).touching;
  }
  EXPECT_TRUE(touching);
  EXPECT_LT(lowest(simulation.surface(0)), before - 0.5e-3);
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  ASSERT_EQ(snapshot.bodies.size(), 2u);
  for (const BodySnapshot& body : snapshot.bodies) {
    EXPECT_GT(std::count(body.lattice.touched.begin(), body.lattice.touched.end(), std::uint8_t{1}), 0);
  }
}

TEST(Bodies, AreSavedUndoneAndHashedTogether) {
  Simulation simulation = simulate(stacked_handles());
  const ShapeState before = simulation.shape();
  const std::uint64_t hash = simulate(stacked_handles()).state_hash();
  EXPECT_EQ(simulation.state_hash(), hash);
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(0.055, 0.0145 - 1e-5 * tick));
  ASSERT_NE(simulation.shape().lattices[0], before.lattices[0]);
  ASSERT_NE(simulation.shape().lattices[1], before.lattices[1]);
  Scene saved = simulation.scene();
  simulation.write_scene(saved);
  EXPECT_EQ(saved.bodies[1].surface.net.y, simulation.surface(1).net.y);
  ASSERT_TRUE(simulation.restore(before).ok());
  EXPECT_EQ(simulation.shape(), before);
}

TEST(Bodies, EachTakesItsOwnMaterial) {
  Simulation simulation = simulate(stacked_handles());
  ASSERT_TRUE(simulation.apply(SetMaterial{silicone(), 1}).ok());
  EXPECT_EQ(simulation.scene().bodies[0].material.name, "clay");
  EXPECT_EQ(simulation.scene().bodies[1].material.name, "silicone");
  const Status refused = simulation.apply(SetMaterial{silicone(), 2});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(Refusal(refused), Refusal(ErrorCode::out_of_range, "body"));
}

TEST(Bodies, AreAtMostEight) {
  Scene scene = small_handle();
  scene.bodies.resize(9, scene.bodies[0]);
  const auto refused = Simulation::make(scene, InstructionSet::baseline);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(Refusal(refused), Refusal(ErrorCode::too_many, "bodies"));
}

TEST(Bodies, OnEachOtherAllocateNothingInATick) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  Simulation simulation = simulate(stacked_handles());
  simulation.advance(above(0.055, 0.0145));
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.055, 0.0145 - 2e-5 * tick));
  EXPECT_EQ(allocation_count(), before);
}

// Points beside fixed nodes have nearly no weight on free nodes. Where both bodies are held, a push that
// moves such points apart moves their free nodes much farther.
TEST(Bodies, ThatAreHeldAndOverlapStayInTheScene) {
  for (const double offset_m : {0.0100, 0.0101, 0.0103, 0.0106}) {
    SCOPED_TRACE(offset_m);
    Scene scene = small_handle();
    scene.planes = {{Vector3(0.012, 0, 0), Vector3::UnitX()}};
    Body other = scene.bodies[0];
    other.name = "other";
    for (double& z : other.surface.net.z) z += offset_m;
    scene.bodies.push_back(std::move(other));
    Simulation simulation = simulate(scene);
    for (int t = 0; t < 200; ++t) {
      ASSERT_EQ(simulation.advance(far_away).flags & tick_flag_body_limited, 0U) << t;
      ASSERT_TRUE(simulation.contact_force_n(0).allFinite() && simulation.contact_force_n(1).allFinite());
    }
  }
}

}  // namespace
}  // namespace spoonbill
