// Tests fixed and rigid bodies that a triangle mesh bounds: their mass, and their contact with soft bodies,
// with rigid ones and with the ground.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/inspection/mass_properties.h"
#include "engine/material/rigid/rigid_mass.h"
#include "engine/scene/place_body.h"
#include "engine/trial/trial.h"
#include "engine/trial/trial_report.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/rigid_samples.h"

namespace spoonbill {
namespace {

// Appends the twelve triangles of a box, which point inward for a cavity.
void append_box(const Vector3& size_m, const Vector3& centre_m, bool is_cavity, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 at((corner & 1) - 0.5, (corner >> 1 & 1) - 0.5, (corner >> 2 & 1) - 0.5);
    mesh.vertices_m.push_back(centre_m + at.cwiseProduct(size_m));
  }
  const std::array<std::array<std::uint32_t, 4>, 6> faces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& face : faces) {
    for (const auto& [b, c] : {std::pair{1u, 2u}, std::pair{2u, 3u}}) {
      TriangleCorners corners{first + face[0], first + face[b], first + face[c]};
      if (is_cavity) std::swap(corners[1], corners[2]);
      mesh.triangles.push_back(corners);
    }
  }
}

std::shared_ptr<const CleanMesh> box_mesh(const Vector3& size_m) {
  TriangleMesh mesh;
  append_box(size_m, Vector3::Zero(), false, mesh);
  return std::make_shared<const CleanMesh>(clean_mesh(mesh, "box").value());
}

Body mesh_box(const char* name, BodyKind kind, const Vector3& size_m, const Vector3& centre_m,
              double friction) {
  Body body;
  body.name = name;
  body.kind = kind;
  body.material = bundled_material("abs");
  body.material.friction = friction;
  body.mesh = box_mesh(size_m);
  move_body({centre_m, Quaternion::Identity()}, body);
  return body;
}

Body mesh_plate(double friction) {
  return mesh_box("plate", BodyKind::fixed, {0.16, 0.004, 0.06}, {0.0, -0.002, 0.0}, friction);
}

Body mesh_block(const Vector3& centre_m, double friction) {
  return mesh_box("block", BodyKind::rigid, {0.03, 0.008, 0.02}, centre_m, friction);
}

Body surface_block(BodyKind kind, const Vector3& centre_m, double friction) {
  Body body = stock_body("rounded block", BoxSize{{0.03, 0.008, 0.02}, 0.0005}, centre_m,
                         mesh_plate(friction).material, 300);
  body.kind = kind;
  return body;
}

// A box of the sides a, b and c has the inertia m (b^2 + c^2) / 12 about the axis along a. A box with a
// cavity is the difference of two.
TEST(MeshBody, HasTheMassOfABoxWithACavity) {
  const Vector3 outer(0.03, 0.02, 0.01), inner(0.012, 0.01, 0.004), centre(0.1, -0.2, 0.3);
  TriangleMesh mesh;
  append_box(outer, centre, false, mesh);
  append_box(inner, centre, true, mesh);
  Body body = mesh_block({0.0, 0.0, 0.0}, 0.3);
  body.mesh = std::make_shared<const CleanMesh>(clean_mesh(mesh, "box").value());
  body.mesh_pose = {};
  const double density = body.material.density_kg_per_m3;
  const double outer_kg = density * outer.prod(), inner_kg = density * inner.prod();
  const auto mass = compute_rigid_mass(body);
  ASSERT_TRUE(mass);
  EXPECT_NEAR(mass->mass_kg, outer_kg - inner_kg, 1e-12 * outer_kg);
  EXPECT_LT((mass->centre_m - centre).norm(), 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    const auto square = [&](const Vector3& size) { return size.squaredNorm() - size[axis] * size[axis]; };
    const double expected = (outer_kg * square(outer) - inner_kg * square(inner)) / 12.0;
    EXPECT_NEAR(mass->inertia_kg_m2(axis, axis), expected, 1e-9 * expected);
  }
  EXPECT_NEAR(compute_body_mass(body)->volume_m3, outer.prod() - inner.prod(), 1e-12 * outer.prod());
}

TEST(MeshBody, SlidesAndSticksOnTheGround) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene;
  scene.bodies = {mesh_block({0.0, 0.00401, 0.0}, 0.3)};
  scene.ground = Ground{Vector3::Zero(), Vector3::UnitY(), 0.3};
  check_friction(scene, 0.3);
}

// The block or the plate has a mesh, or both.
TEST(MeshBody, SlidesAndSticksOnAPlate) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  const Vector3 centre_m(-0.04, 0.00401, 0.0);
  Body plate = stock_body("plate", PlateSize{0.16, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0},
                          mesh_plate(0.3).material, 300);
  plate.kind = BodyKind::fixed;
  const std::vector<std::vector<Body>> pairs = {
      {mesh_block(centre_m, 0.3), mesh_plate(0.3)},
      {mesh_block(centre_m, 0.3), plate},
      {surface_block(BodyKind::rigid, centre_m, 0.3), mesh_plate(0.3)}};
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    SCOPED_TRACE(pair);
    Scene scene;
    scene.bodies = pairs[pair];
    check_friction(scene, 0.3);
  }
}

// Two blocks of different kinds stand on a plate of a mesh.
TEST(MeshBody, StandsInAStack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene;
  scene.bodies = {mesh_block({0.0, 0.00401, 0.0}, 0.5), mesh_plate(0.5),
                  surface_block(BodyKind::rigid, {0.002, 0.01203, 0.001}, 0.5)};
  Simulation simulation = make_trial_of(scene);
  check_stands_still(simulation, 2);
  const double lower_n = simulation.rigid_dynamics(0)->mass().mass_kg * standard_gravity_m_per_s2;
  const double upper_n = simulation.rigid_dynamics(2)->mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.contact_force_n(2).y(), upper_n, 0.02 * upper_n);
  EXPECT_NEAR(simulation.contact_force_n(1).y(), -(lower_n + upper_n), 0.02 * (lower_n + upper_n));
  // The underside of the upper block, without its rounded edges, lies on the lower one.
  EXPECT_GT(simulation.contact_area_m2(2), 0.0);
  EXPECT_GT(simulation.contact_area_m2(1), 0.0);
}

// Jelly is laid on a plate of a mesh and tilts with it.
TEST(MeshBody, CarriesJelly) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Material soft = made_elastic(bundled_material("gelatin-20-1"));
  soft.friction = 0.5;
  Scene scene;
  scene.bodies = {stock_body("jelly", BoxSize{{0.03, 0.012, 0.02}, 0.002}, {0.0, 0.0065, 0.0}, soft, 300),
                  mesh_plate(0.5)};
  scene.trial = TrialPlan{"jelly", 0.01, "plate", Vector3::Zero(), Vector3::UnitZ(), 10.0, 30.0};
  Simulation simulation = make_simulation(make_trial_scene(scene, 10.0).value());
  Trial trial(simulation.scene(), {0.4, 2.0});
  while (trial.phase() != TrialPhase::done) {
    while (const auto command = trial.next_command()) ASSERT_TRUE(simulation.apply(*command).ok());
    const Reaction reaction = simulation.advance(trial_input());
    const Status held = trial.follow(simulation, reaction.flags);
    ASSERT_TRUE(held.ok()) << held.error().message;
  }
  const TrialReport report = report_on(trial, simulation);
  const double weight_n = standard_gravity_m_per_s2 * simulation.lattice(0).mass_kg();
  EXPECT_NEAR(report.bodies[0].contact_force_n.y(), weight_n, 0.01 * weight_n);
  EXPECT_LT(report.bodies[0].contact_force_n.head<1>().norm(), 0.01 * weight_n);
  EXPECT_LT(report.bodies[0].centre_of_mass_m.norm(), 0.012);  // it has not slid off
  EXPECT_EQ(report.inverted_cells, 0);
  EXPECT_LT(trial.largest_speed_m_per_s(), 1e-3);
  // The plate hangs from what turns it: it bears its own weight and the jelly's.
  const Body& plate = simulation.scene().bodies[1];
  const double plate_n = standard_gravity_m_per_s2 * compute_body_mass(plate)->mass_kg();
  EXPECT_NEAR(report.bodies[1].support_force_n.y(), plate_n + weight_n, 0.01 * weight_n);
  EXPECT_LT(trial.largest_penetration_m(), 0.1 * static_cast<double>(simulation.lattice(0).cell_size_m()));
  // The underside, from which the edges curve away.
  EXPECT_GT(simulation.contact_area_m2(0), 0.5 * 0.026 * 0.016);
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  EXPECT_FALSE(snapshot.bodies[0].is_mesh());
  EXPECT_TRUE(snapshot.bodies[1].is_mesh());
}

// A body is saved where it is, and its file reads back to the same mesh.
TEST(MeshBody, IsSavedWhereItIs) {
  Scene scene;
  scene.bodies = {mesh_plate(0.3), mesh_block({0.0, 0.03, 0.0}, 0.3)};
  Simulation simulation = make_trial_of(scene);
  ASSERT_TRUE(simulation.apply(TurnBody{0, Vector3::Zero(), Vector3::UnitZ(), 20.0, 90.0}).ok());
  run_trial_ticks(simulation, 60);
  Document document{"meshes", {}, Json::object()};
  simulation.write_scene(document.scene);
  const Pose fallen = *simulation.rigid_pose(1);
  EXPECT_LT(fallen.position_m.y(), -1e-3);
  for (int b = 0; b < 2; ++b) {
    const Box written = find_bounds(document.scene.bodies[static_cast<std::size_t>(b)]);
    EXPECT_LT((written.low - simulation.bounds(b).low).norm(), 1e-7) << b;
    EXPECT_LT((written.high - simulation.bounds(b).high).norm(), 1e-7) << b;
  }
  const Json json = document_to_json(document);
  const auto read = document_from_json(json, "saved");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(document_to_json(read.value()), json);
  EXPECT_EQ(read->scene.bodies[0].mesh->mesh.triangles, document.scene.bodies[0].mesh->mesh.triangles);
}

TEST(MeshBody, KeepsItsPlaceWhenItsShapeIsKept) {
  Scene scene;
  scene.bodies = {mesh_plate(0.3), mesh_block({0.0, 0.00401, 0.0}, 0.3)};
  Simulation simulation = make_trial_of(scene);
  ASSERT_TRUE(simulation.apply(TurnBody{0, Vector3::Zero(), Vector3::UnitZ(), 5.0, 90.0}).ok());
  run_trial_ticks(simulation, 400);
  const Box before = simulation.bounds(0);
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(10.0, 0.0, 0.0), Vector3(-1.0, 0.0, 0.0)}}).ok());
  run_trial_ticks(simulation, 50);
  EXPECT_LT((simulation.bounds(0).low - before.low).norm(), 1e-7);
  EXPECT_LT((find_bounds(simulation.scene().bodies[0]).high - before.high).norm(), 1e-7);
  // It still follows its pose: turned back, it is level.
  ASSERT_TRUE(simulation.apply(TurnBody{0, Vector3::Zero(), Vector3::UnitZ(), -5.0, 90.0}).ok());
  run_trial_ticks(simulation, 400);
  EXPECT_LT((simulation.bounds(0).low - find_bounds(mesh_plate(0.3)).low).norm(), 1e-6);
  EXPECT_EQ(simulation.apply(RefineKnots{0}).error().code, ErrorCode::unsupported);
}

TEST(MeshBody, IsTheSameOnEveryRunAndAllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << "assertions allocate in this build";
  const auto run_hash = [] {
    Scene scene;
    scene.bodies = {mesh_block({0.0, 0.0045, 0.0}, 0.3), mesh_plate(0.3),
                    surface_block(BodyKind::rigid, {0.001, 0.0130, 0.0}, 0.3)};
    scene.ground = Ground{Vector3(0.0, -0.02, 0.0), Vector3::UnitY(), 0.3};
    Simulation simulation = make_trial_of(scene);
    run_trial_ticks(simulation, 5);
    for (int t = 0; t < 60; ++t) {
      const std::size_t allocated = allocation_count();
      simulation.advance(trial_input());
      EXPECT_EQ(allocation_count(), allocated);
    }
    return simulation.state_hash();
  };
  EXPECT_EQ(run_hash(), run_hash());
}

// Returns the field that is refused in a document whose only body has a mesh and this field of a body with a
// surface.
std::string document_refusal(const std::string& field) {
  Scene scene;
  scene.bodies = {mesh_block({0.0, 0.1, 0.0}, 0.3)};
  Json json = document_to_json({"mesh", scene, Json::object()});
  EXPECT_TRUE(document_from_json(json, "mesh").ok());
  Scene other;
  other.bodies = {surface_block(BodyKind::rigid, Vector3::Zero(), 0.3)};
  other.bodies[0].rim = {{0.0, 0.1}, {0.3, 0.1}, {0.6, 0.1}};
  other.bodies[0].loads = {PointLoad{}};
  json["body"][field] = document_to_json({"surface", other, Json::object()})["body"][field];
  const auto read = document_from_json(json, "mesh");
  return read.ok() ? std::string() : read.error().field;
}

TEST(MeshBody, RefusesWhatItCannotBe) {
  const auto refusal = [](const Body& body) {
    Scene scene;
    scene.bodies = {body, mesh_plate(0.3)};
    const auto made = Simulation::make(scene, InstructionSet::baseline);
    return made.ok() ? std::string() : made.error().field;
  };
  Body block = mesh_block({0.0, 0.1, 0.0}, 0.3);
  EXPECT_EQ(refusal(block), "");
  Body soft = block;
  soft.kind = BodyKind::deformable;
  EXPECT_EQ(refusal(soft), "mesh");
  Body shell = block;
  shell.shell_thickness_m = 1e-3;
  EXPECT_EQ(refusal(shell), "shell_thickness_mm");
  Body loaded = block;
  loaded.loads.emplace_back(PointLoad{});
  EXPECT_EQ(refusal(loaded), "loads");
  TriangleMesh open = block.mesh->mesh;
  open.triangles.resize(10);
  EXPECT_EQ(check_mesh(clean_mesh(open, "open").value()).error().code, ErrorCode::inconsistent);
  TriangleMesh two;
  append_box({0.01, 0.01, 0.01}, Vector3::Zero(), false, two);
  append_box({0.002, 0.002, 0.002}, Vector3::Zero(), false, two);  // inside the first, but not a cavity
  EXPECT_EQ(check_mesh(clean_mesh(two, "two").value()).error().code, ErrorCode::inconsistent);
  TriangleMesh crossed;
  append_box({0.01, 0.002, 0.002}, Vector3::Zero(), false, crossed);
  crossed.vertices_m[7] = Vector3(-0.004, -0.003, -0.003);  // this corner is pulled through the far side
  EXPECT_EQ(check_mesh(clean_mesh(crossed, "crossed").value()).error().code, ErrorCode::self_intersecting);
  EXPECT_EQ(document_refusal("surface"), "body.mesh");
  EXPECT_EQ(document_refusal("loads"), "body.loads");
  EXPECT_EQ(document_refusal("rim_uv"), "body.rim_uv");
}

}  // namespace
}  // namespace spoonbill
