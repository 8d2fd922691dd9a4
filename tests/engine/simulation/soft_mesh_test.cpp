// Tests soft tools made of triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/collision/meshes/mesh_distance.h"
#include "engine/simulation/tool_contact.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/impact.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

// Largest allowed penetration of a surface and a mesh, in cells of the coarser of their two lattices. Most of
// it is what the control net of the surface does not reproduce; a mesh follows its lattice exactly.
constexpr double mesh_depth_limit_cells = 0.04;

SoftTool flesh(int nodes, double grip_m = 0.001) {
  return {silicone(), {nodes, {}}, {Vector3(0, grip_m, 0), -Vector3::UnitY()}};
}

Tool soft_tool(const TriangleMesh& mesh, const SoftTool& soft) {
  Tool tool;
  tool.kind = ToolKind::solid;
  tool.body = std::make_shared<ToolBody>(ToolBody{MeshSolid{cleaned(mesh)}, soft});
  return tool;
}

TriangleMesh ball() {
  return ball_mesh(10, 16, 0.006);
}

Scene held_soft_handle(const Tool& tool) {
  Scene scene = small_handle();
  scene.bodies[0].material = silicone();
  scene.tool = tool;
  scene.planes.push_back({Vector3(0.015, 0, 0), Vector3::UnitX()});
  return scene;
}

struct SampledSurface {
  std::vector<Vector3> points_m, normals;
};

// Returns samples of the surface near the box.
SampledSurface sampled(const Surface& surface, const Box& box) {
  constexpr int around = 120, along = 240;
  const auto at = [](const KnotVector& knots, int index, int count) {
    return knots.domain_start() + (knots.domain_end() - knots.domain_start()) * index / count;
  };
  SampledSurface samples;
  for (int i = 0; i < around; ++i) {
    for (int j = 1; j < along; ++j) {
      const double u = at(surface.u, i, around), v = at(surface.v, j, along);
      const Vector3 point = evaluate(surface, u, v).position_m;
      if (signed_distance(box, point) > 1e-3) continue;
      samples.points_m.push_back(point);
      samples.normals.push_back(unit_normal(surface, u, v));
    }
  }
  return samples;
}

// Returns the depth of a point behind the tangent plane of the nearest sample, negative in front of it. Dense
// samples make it accurate to some micrometres. A point far from all samples has no depth.
double depth_behind(const SampledSurface& samples, const Vector3& point) {
  std::size_t nearest = 0;
  double least = 1e30;
  for (std::size_t s = 0; s < samples.points_m.size(); ++s) {
    const double squared = (samples.points_m[s] - point).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    nearest = s;
  }
  return least < 1e-6 ? samples.normals[nearest].dot(samples.points_m[nearest] - point) : 0.0;
}

// Returns the larger of two depths: that of the surface in the mesh, from samples of the surface, and that of
// the mesh in the surface, from the corners, side midpoints and centres of the triangles.
double depth_between(const Surface& surface, const std::vector<Vector3>& vertices,
                     const std::vector<TriangleCorners>& triangles) {
  const MeshDistance mesh(cleaned({vertices, triangles}));
  const SampledSurface samples = sampled(surface, mesh.bounds());
  if (samples.points_m.empty()) return 0.0;
  double deepest = 0.0;
  for (const Vector3& point : samples.points_m) deepest = std::max(deepest, -mesh.at(point).distance_m);
  for (const auto& [i, j, k] : triangles) {
    const Vector3 &a = vertices[i], &b = vertices[j], &c = vertices[k];
    for (const Vector3& point :
         {a, Vector3(0.5 * (a + b)), Vector3(0.5 * (b + c)), Vector3((a + b + c) / 3.0)}) {
      deepest = std::max(deepest, depth_behind(samples, point));
    }
  }
  return deepest;
}

double depth_of(const Simulation& simulation) {
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  const MeshSnapshot& mesh = snapshot.bodies.back().mesh;
  std::vector<Vector3> vertices;
  for (std::size_t v = 0; v < mesh.x.size(); ++v) vertices.emplace_back(mesh.x[v], mesh.y[v], mesh.z[v]);
  return depth_between(simulation.surface(), vertices, *mesh.triangles);
}

double depth_of(const Impact& impact) {
  const MeshMapping& mesh = *impact.body(1).mesh();
  return depth_between(impact.body(0).mapping().current(), mesh.current().vertices_m(), *mesh.triangles());
}

double coarser_cell(const SpringLattice& first, const SpringLattice& second) {
  return static_cast<double>(std::max(first.cell_size_m(), second.cell_size_m()));
}

// Returns the impact of a mesh on a pebble of 40 x 20 x 100 mm.
Impact ball_on_pebble(const TriangleMesh& mesh) {
  const Body pebble{"pebble", ellipsoid_tube(12, 12), silicone(), {700, {}}};
  return {make_body_state(pebble, {}, InstructionSet::baseline).value(),
          make_soft_mesh({cleaned(mesh)}, flesh(500), InstructionSet::baseline).value()};
}

TEST(SoftMesh, ThatCollidesKeepsTheMomentum) {
  Impact impact = ball_on_pebble(ball_mesh(12, 18, 0.011, {0.006, 0.0228, 0.012}));
  impact.throw_at(1, {0.01, -0.06, 0.005});
  double sum_of_sizes = 0.0, deepest = 0.0;
  const Vector3 before = impact.momentum_of(1, &sum_of_sizes);
  int touching = 0;
  for (int tick = 0; tick < 400; ++tick) {
    touching += impact.tick() ? 1 : 0;
    if (tick % 20 == 0) deepest = std::max(deepest, depth_of(impact));
  }
  EXPECT_GT(touching, 20);
  EXPECT_FALSE(impact.tick()) << "they have parted";
  const Vector3 change = impact.momentum_of(0) + impact.momentum_of(1) - before;
  EXPECT_LT(change.norm(), 1e-5 * sum_of_sizes);
  EXPECT_LT(impact.momentum_of(0).y(), 0.25 * before.y()) << "the one that was hit took some of it over";
  const double cell = coarser_cell(impact.body(0).lattice, impact.body(1).lattice);
  EXPECT_LT(deepest, mesh_depth_limit_cells * cell) << deepest / cell;
}

// The cube is turned so that it arrives with an edge first.
TEST(SoftMesh, ComesToRestOnItsEdge) {
  TriangleMesh cube = box_of_triangles(Vector3::Constant(-0.008), Vector3::Constant(0.008));
  const Quaternion turn(Eigen::AngleAxisd(0.78, Vector3::UnitX()));
  for (Vector3& vertex : cube.vertices_m) vertex = turn * vertex + Vector3(0.003, 0.0235, 0.0);
  Impact impact = ball_on_pebble(cube);
  impact.throw_at(1, {0.0, -0.04, 0.0});
  double deepest = 0.0;
  int touching = 0;
  for (int tick = 0; tick < 300; ++tick) {
    touching += impact.tick() ? 1 : 0;
    if (tick % 20 == 0) deepest = std::max(deepest, depth_of(impact));
  }
  EXPECT_GT(touching, 20);
  const double cell = coarser_cell(impact.body(0).lattice, impact.body(1).lattice);
  EXPECT_LT(deepest, mesh_depth_limit_cells * cell) << deepest / cell;
}

TEST(SoftMesh, GivesWayAndReturns) {
  Simulation simulation = simulate(held_soft_handle(soft_tool(ball(), flesh(300))));
  const double before = lowest(simulation.surface());
  constexpr double start = 0.0095;
  simulation.advance(above(0.018, start));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  ASSERT_EQ(snapshot.bodies.size(), 2u);
  const BodySnapshot rest = snapshot.bodies[1];
  ASSERT_TRUE(rest.is_mesh());
  EXPECT_EQ(rest.lattice.x.size(), static_cast<std::size_t>(simulation.lattice(1).mesh().node_count()));
  EXPECT_EQ(rest.material.name, "silicone");
  // Returns the largest distance of a vertex from its position on a rigid tool.
  const auto bent = [&](double hand_m) {
    simulation.write_snapshot(snapshot);
    const MeshSnapshot& now = snapshot.bodies[1].mesh;
    float most = 0.0f;
    for (std::size_t v = 0; v < now.x.size(); ++v) {
      const Eigen::Vector3f moved(now.x[v] - rest.mesh.x[v],
                                  now.y[v] - rest.mesh.y[v] - static_cast<float>(hand_m - start),
                                  now.z[v] - rest.mesh.z[v]);
      most = std::max(most, moved.norm());
    }
    return most;
  };
  Reaction reaction;
  double deepest = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    reaction = simulation.advance(above(0.018, start - 3.5e-3 * tick / 400));
    EXPECT_EQ(reaction.flags & tick_flag_contact_overflow, 0u);
    if (tick % 40 == 0) deepest = std::max(deepest, depth_of(simulation));
  }
  EXPECT_TRUE(reaction.touching);
  EXPECT_GT(reaction.force_n.y(), 0.0);
  EXPECT_LT(lowest(simulation.surface()), before - 0.2e-3) << "the handle gives way";
  EXPECT_GT(bent(start - 3.5e-3), 0.3e-3f) << "and so does the tool";
  const double cell = coarser_cell(simulation.lattice(0), simulation.lattice(1));
  EXPECT_LT(deepest, mesh_depth_limit_cells * cell) << deepest / cell;
  for (int tick = 0; tick < 1500; ++tick) simulation.advance(above(0.018, 0.02));
  EXPECT_LT(bent(0.02), 0.05e-3f) << "elastic";
}

// Returns the largest distance of a soft ball's vertices from those of a rigid ball at `pose`.
double distance_from_rigid_ball(const Simulation& simulation, const Pose& pose) {
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  const MeshSnapshot& mesh = snapshot.bodies.back().mesh;
  const CleanMesh made = cleaned(ball());
  double farthest = 0.0;
  // The vertices of the given mesh come first. The vertices that were added at the midpoints of edges follow.
  for (std::size_t v = 0; v < made.mesh.vertices_m.size(); ++v) {
    const Vector3 rigid = pose.position_m + pose.orientation * made.mesh.vertices_m[v];
    farthest = std::max(farthest, (Vector3(mesh.x[v], mesh.y[v], mesh.z[v]) - rigid).norm());
  }
  return farthest;
}

TEST(SoftMesh, AppearsInTheHandsPose) {
  Simulation simulation = simulate(held_soft_handle(soft_tool(ball(), flesh(300))));
  const Pose pose{Vector3(0.03, 0.04, 0.01),
                  Quaternion(Eigen::AngleAxisd(0.6, Vector3(1, 2, -1).normalized()))};
  simulation.advance({pose, false, 0.0});
  EXPECT_LT(distance_from_rigid_ball(simulation, pose), 1e-7);
}

// The ball is shaken at 5 m/s^2 and turned back and forth at up to 6 rad/s. The tolerance is the rounding of
// positions in single precision, added over the ticks.
TEST(SoftMesh, FollowsTheHandAsARigidOneDoes) {
  for (const double coupling_n_per_m : {0.0, 1000.0}) {
    Simulation simulation = simulate(held_soft_handle(soft_tool(ball(), flesh(300))));
    const Vector3 axis = Vector3(1, 2, -1).normalized();
    Pose pose{Vector3(0.03, 0.04, 0.01), Quaternion::Identity()};
    for (int tick = 0; tick < 600; ++tick) {
      const double phase = 30.0 * 1e-3 * tick;
      pose.position_m.x() = 0.03 + 5.0 / (30.0 * 30.0) * std::sin(phase);
      pose.orientation = Eigen::AngleAxisd(0.2 * std::sin(phase), axis);
      simulation.advance({pose, false, coupling_n_per_m});
      if (tick % 20 != 0) continue;
      Snapshot snapshot;
      simulation.write_snapshot(snapshot);
      EXPECT_LT(distance_from_rigid_ball(simulation, snapshot.tool.proxy), 1e-6) << tick;
    }
  }
}

// The body holds the tool away from the hand. A change of the tool must not push it into the body.
TEST(SoftMesh, StaysWhereItIsWhenTheToolChanges) {
  Simulation simulation = simulate(held_soft_handle(soft_tool(ball(), flesh(300))));
  const auto hold_at = [&](double height_m) {
    simulation.advance({{Vector3(0.018, height_m, 0.0), Quaternion::Identity()}, false, 100.0});
    Snapshot snapshot;
    simulation.write_snapshot(snapshot);
    return snapshot.tool.proxy.position_m.y();
  };
  double held_m = 0.0;
  for (int tick = 0; tick < 400; ++tick) held_m = hold_at(0.0095 - 1.5e-5 * std::min(tick, 200));
  ASSERT_GT(held_m, 0.0072);
  Tool tool = simulation.scene().tool;
  tool.substeps += 1;
  ASSERT_TRUE(simulation.apply(SetTool{tool}).ok());
  EXPECT_NEAR(hold_at(0.0065), held_m, 1e-4);
}

TEST(SoftMesh, IsExchangedHashedAndLeftOutOfUndo) {
  Simulation simulation = simulate(held_soft_handle(Tool{}));
  const Tool tool = soft_tool(ball(), flesh(300));
  ASSERT_TRUE(simulation.apply(SetTool{tool}).ok());
  for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.05, 0.0095 - 1e-5 * tick));
  EXPECT_EQ(simulation.shape().lattices.size(), 1u);
  Simulation again = simulate(held_soft_handle(Tool{}));
  ASSERT_TRUE(again.apply(SetTool{tool}).ok());
  for (int tick = 0; tick < 200; ++tick) again.advance(above(0.05, 0.0095 - 1e-5 * tick));
  EXPECT_EQ(again.state_hash(), simulation.state_hash());
  SpringLattice& lattice = const_cast<SpringLattice&>(again.lattice(1));
  lattice.set_velocity(0, lattice.velocity(0) + Vector3(1e-3, 0, 0));
  EXPECT_NE(again.state_hash(), simulation.state_hash()) << "the tool's lattice is part of the state";
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  EXPECT_TRUE(snapshot.bodies[1].is_mesh());
  ASSERT_TRUE(simulation.apply(SetTool{Tool{}}).ok());
  simulation.advance(above(0.05, 0.02));
  simulation.write_snapshot(snapshot);
  EXPECT_EQ(snapshot.bodies.size(), 1u);
}

// The baseline and the best instruction set must give the same bits.
TEST(SoftMesh, IsTheSameOnEveryInstructionSet) {
  const Scene scene = held_soft_handle(soft_tool(ball(), flesh(300)));
  Simulation plain = simulate(scene), best = simulate(scene, best_instruction_set());
  for (int tick = 0; tick < 150; ++tick) {
    plain.advance(above(0.05, 0.0095 - 2e-5 * tick));
    best.advance(above(0.05, 0.0095 - 2e-5 * tick));
  }
  EXPECT_EQ(plain.state_hash(), best.state_hash());
}

TEST(SoftMesh, AllocatesNothingInATick) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  Simulation simulation = simulate(held_soft_handle(soft_tool(ball(), flesh(300))));
  Snapshot snapshot;
  simulation.advance(above(0.05, 0.0095));
  simulation.write_snapshot(snapshot);
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.05, 0.0095 - 1.5e-5 * tick));
  simulation.write_snapshot(snapshot);
  EXPECT_EQ(allocation_count(), before);
}

TEST(SoftMesh, IsRefusedWhereItCannotBe) {
  const auto refusal = [](const Tool& tool) {
    const auto made = Simulation::make(held_soft_handle(tool), InstructionSet::baseline);
    return made.ok() ? Error(ErrorCode::internal, "") : made.error();
  };
  const auto expect = [&](const Tool& tool, ErrorCode code, const char* field) {
    const Error error = refusal(tool);
    EXPECT_EQ(error.code, code) << error.message;
    EXPECT_EQ(error.field, field) << error.message;
    EXPECT_EQ(error.message.substr(0, 6), "tool: ");
  };
  expect(soft_tool(without(ball(), 0, 120), flesh(300)), ErrorCode::inconsistent, "mesh");
  expect(soft_tool(ball_mesh(100, 110, 0.006), flesh(300)), ErrorCode::too_many, "mesh");
  expect(soft_tool(joined(ball(), ball_mesh(10, 16, 0.006, {0.004, 0.001, 0.002})), flesh(300)),
         ErrorCode::self_intersecting, "mesh");
  expect(soft_tool(ball(), flesh(300, 0.02)), ErrorCode::too_few, "grip");
  // This corner of the box around a ball contains no part of the ball.
  SoftTool corner = flesh(1000);
  corner.grip = {Vector3::Constant(0.0055), -Vector3::Ones().normalized()};
  expect(soft_tool(ball(), corner), ErrorCode::too_few, "grip");
  expect(soft_tool(ball(), flesh(40000)), ErrorCode::too_many, "mesh");
  Tool pulling = soft_tool(ball(), flesh(300));
  pulling.action = ToolAction::pull;
  expect(pulling, ErrorCode::unsupported, "action");
}

}  // namespace
}  // namespace spoonbill
