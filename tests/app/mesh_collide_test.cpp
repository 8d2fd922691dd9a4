// Tests the collide command for a document and a mesh, and for two meshes. The command runs as a process,
// because reading a mesh starts the program a second time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/program.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"
#include "engine/exchange/document.h"
#include "tests/app/mesh_texts.h"
#include "tests/app/process.h"
#include "tests/app/workplace.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

Outcome collide(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "collide");
  return run_process(SPOONBILL_PROGRAM, arguments);
}

Json facts_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const Outcome outcome = collide(std::move(arguments));
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return json_of(outcome.out);
}

// Returns the distance of a point from the model's surface, by dense sampling.
double sampled_distance(const Workplace& place, const Vector3& point) {
  const auto document = read_document(place.path("model.json"));
  EXPECT_TRUE(document);
  const Surface& surface = document->scene.bodies[0].surface;
  double nearest = 1e300;
  for (const double u : uniform_parameters(surface.u, 600)) {
    for (const double v : uniform_parameters(surface.v, 600)) {
      nearest = std::min(nearest, (evaluate(surface, u, v).position_m - point).norm());
    }
  }
  return nearest;
}

std::string above(double millimetres) {
  return "30mm," + std::to_string(millimetres) + "mm,0,1,0,0,0";
}

// Bound of the distance between the triangles of the ball and the sphere of 8 mm radius on which its vertices
// are. It is 8 mm (1 - cos(pi/100)), because no point of a triangle is farther than an angle of pi/100 from a
// vertex.
constexpr double flatter_m = 8e-3 * 5e-4;
const TriangleMesh ball = ball_mesh(100, 200, 8.0);

TEST(MeshCollide, TheDistanceIsThatOfASphere) {
  const Workplace place;
  const std::string model = place.text("model.json"),
                    mesh = place.write("ball.stl", binary_stl(ball)).string();
  const double expected = sampled_distance(place, {0.03, 0.025, 0.0}) - 8e-3;
  ASSERT_GT(expected, 1e-3);
  const Json facts = facts_of({model, mesh, "--pose", above(25)});
  EXPECT_EQ(facts["touching"], false);
  EXPECT_EQ(facts["complete"], true);
  EXPECT_TRUE(facts["contacts"].empty());
  // The search alone is accurate to 2e-5 m. Newton's method then refines the result.
  EXPECT_NEAR(facts["distance_m"].get<double>(), expected, 2.0 * flatter_m);
  EXPECT_TRUE(facts["nearest"]["a"].contains("u"));
  EXPECT_FALSE(facts["nearest"]["b"].contains("u"));
  EXPECT_EQ(facts["mesh"]["unit"], "mm");
  EXPECT_NEAR(facts["mesh"]["size_mm"][1], 16.0, 1e-5);
  EXPECT_EQ(facts["mesh"]["triangles"], ball.triangles.size());
  EXPECT_EQ(facts["mesh"]["cleaning"]["vertices_joined"], 3 * ball.triangles.size() - ball.vertices_m.size());
}

TEST(MeshCollide, EitherMayBeTheMesh) {
  const Workplace place;
  const std::string model = place.text("model.json");
  const std::string mesh = place.write("ball.obj", obj_text(ball)).string();
  const double apart = facts_of({model, mesh, "--pose", above(25)})["distance_m"];
  const double height = 25.0 - 1e3 * apart - 0.5;  // the ball is half a millimetre deep
  const Json second = facts_of({model, mesh, "--pose", above(height)});
  EXPECT_EQ(second["touching"], true);
  EXPECT_EQ(second["contained"], false);
  // The top of the handle is flat over the width of the contact, within the tolerance of the search.
  EXPECT_NEAR(second["depth_m"].get<double>(), 5e-4, 3e-5);
  ASSERT_EQ(second["contacts"].size(), 1U);
  const Json& contact = second["contacts"][0];
  EXPECT_NEAR(contact["normal"][1].get<double>(), -1.0, 0.01);  // the body moves down, away from the ball
  EXPECT_LE(contact["a"]["u_range"][0], contact["a"]["u"]);
  EXPECT_LE(contact["a"]["v"], contact["a"]["v_range"][1]);
  EXPECT_FALSE(contact["b"].contains("u"));
  const double reached = contact["a"]["point_m"][1].get<double>() - contact["b"]["point_m"][1].get<double>();
  EXPECT_NEAR(reached, contact["depth_m"].get<double>(), 1e-5);

  // With the mesh as A, the model moves in the opposite direction.
  const std::string moved = "-30mm," + std::to_string(-height) + "mm,0,1,0,0,0";
  const Json first = facts_of({mesh, model, "--pose", moved});
  EXPECT_NEAR(first["depth_m"].get<double>(), second["depth_m"].get<double>(), 1e-9);
  EXPECT_NEAR(first["contacts"][0]["normal"][1].get<double>(), 1.0, 0.01);
  EXPECT_TRUE(first["contacts"][0]["b"].contains("u_range"));
  EXPECT_FALSE(first["contacts"][0]["a"].contains("u"));
}

TEST(MeshCollide, OneInsideTheOther) {
  const Workplace place;
  const std::string model = place.text("model.json");
  const std::string seed = place.write("seed.stl", binary_stl(ball_mesh(10, 20, 0.2))).string();
  const Json inside = facts_of({model, seed, "--pose", above(0)});
  EXPECT_EQ(inside["touching"], true);
  EXPECT_EQ(inside["contained"], true);
  EXPECT_EQ(inside["contacts"].size(), 1U);
  EXPECT_GT(inside["depth_m"], 4e-4);

  const std::string room =
      place.write("room.ply", ply_text(box_of_triangles({-1, -1, -1}, {1, 1, 1}))).string();
  const Json around = facts_of({model, room});
  EXPECT_EQ(around["mesh"]["unit"], "m");
  EXPECT_EQ(around["touching"], true);
  EXPECT_GT(around["depth_m"], 0.9);
}

TEST(MeshCollide, TwoMeshesAreAsFarApartAsTheyAre) {
  const Workplace place;
  const std::string box =
      place.write("box.stl", binary_stl(box_of_triangles({-10, -10, -10}, {10, 10, 10}))).string();
  const std::string cube =
      place.write("cube.obj", obj_text(box_of_triangles({-5, -5, -5}, {5, 5, 5}))).string();
  const Json apart = facts_of({box, cube, "--pose", "18mm,2mm,0,1,0,0,0"});
  EXPECT_EQ(apart["touching"], false);
  EXPECT_EQ(apart["complete"], true);
  EXPECT_TRUE(apart["contacts"].empty());
  EXPECT_NEAR(apart["distance_m"], 3e-3, 1e-9);
  EXPECT_NEAR(apart["nearest"]["a"]["point_m"][0], 0.010, 1e-9);
  EXPECT_NEAR(apart["nearest"]["b"]["point_m"][0], 0.013, 1e-9);
  EXPECT_FALSE(apart["nearest"]["a"].contains("u"));
  EXPECT_FALSE(apart.contains("mesh"));
  EXPECT_NEAR(apart["mesh_a"]["size_mm"][1], 20.0, 1e-5);
  EXPECT_NEAR(apart["mesh_b"]["size_mm"][1], 10.0, 1e-5);
  EXPECT_EQ(apart["mesh_a"]["cleaning"]["vertices_joined"], 28);
  // An OBJ file numbers its vertices, an STL file repeats them in each triangle.
  EXPECT_EQ(apart["mesh_b"]["cleaning"]["vertices_joined"], 0);

  // In centimetres, both meshes are ten times as large. In this pose, they overlap by 10 mm.
  const Json deep = facts_of({box, cube, "--unit", "cm", "--pose", "14cm,20mm,0,1,0,0,0"});
  EXPECT_EQ(deep["touching"], true);
  EXPECT_EQ(deep["contained"], false);
  EXPECT_EQ(deep["mesh_a"]["unit"], "cm");
  EXPECT_NEAR(deep["depth_m"], 0.010, 1e-7);
  ASSERT_EQ(deep["contacts"].size(), 1U);
  const Json& contact = deep["contacts"][0];
  EXPECT_NEAR(contact["normal"][0], -1.0, 1e-6);
  EXPECT_EQ(contact["point_m"], contact["a"]["point_m"]);
  EXPECT_FALSE(contact["a"].contains("u"));
  EXPECT_FALSE(contact["b"].contains("u"));

  const Json inside = facts_of({box, cube, "--pose", "2mm,0,0,1,0,0,0"});
  EXPECT_EQ(inside["touching"], true);
  EXPECT_EQ(inside["contained"], true);
  EXPECT_NEAR(inside["depth_m"], 3e-3 + 10e-3, 1e-9);
  const std::string text = collide({box, cube, "--pose", "2mm,0,0,1,0,0,0"}).out;
  for (const char* words : {"Size of A", "20.0 x 20.0 x 20.0 mm", "Size of B", "10.0 x 10.0 x 10.0 mm",
                            "yes, one inside the other", "13.0 mm"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in\n" << text;
  }
}

// Writes a document of two bodies. The second is a copy of the first, 20 mm above it. Returns the name of the
// file.
std::string two_bodies(const Workplace& place) {
  place.text("model.json");
  auto document = read_document(place.path("model.json"));
  EXPECT_TRUE(document);
  Scene& scene = document->scene;
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[0].name = "lower";
  scene.bodies[1].name = "upper";
  Pose above;
  above.position_m = {0.0, 0.02, 0.0};
  scene.bodies[1].surface = placed(scene.bodies[1].surface, above);
  EXPECT_TRUE(write_document(document.value(), place.path("two.json")));
  return place.text("two.json");
}

TEST(MeshCollide, AllBodiesOfADocumentCount) {
  const Workplace place;
  const std::string model = place.text("model.json"), two = two_bodies(place);
  const std::string mesh = place.write("ball.stl", binary_stl(ball)).string();
  // The mesh is as high above the upper body as it was above the only body of the model. The upper body is
  // 20 mm higher.
  const Json one = facts_of({model, mesh, "--pose", above(25)}),
             upper = facts_of({two, mesh, "--pose", above(45)});
  EXPECT_EQ(upper["touching"], false);
  EXPECT_NEAR(upper["distance_m"], one["distance_m"], 1e-6);
  EXPECT_EQ(upper["nearest"]["a"]["body"], "upper");
  EXPECT_FALSE(upper["nearest"]["b"].contains("body"));
  EXPECT_FALSE(one["nearest"]["a"].contains("body"));

  // A copy of the model is between both bodies. It is 1 mm lower than the upper body and overlaps it.
  const Json alone = facts_of({model, model, "--pose", "0,-1mm,0,1,0,0,0"});
  const Json between = facts_of({two, model, "--pose", "0,19mm,0,1,0,0,0"});
  EXPECT_EQ(between["touching"], true);
  ASSERT_FALSE(between["contacts"].empty());
  EXPECT_EQ(between["contacts"][0]["a"]["body"], "upper");
  EXPECT_FALSE(between["contacts"][0]["b"].contains("body"));
  EXPECT_NEAR(between["depth_m"], alone["depth_m"], 1e-4);

  EXPECT_EQ(facts_of({two})["touching"], false);  // no body touches itself or the other
}

TEST(MeshCollide, TellsAPersonWhatTheMeshIs) {
  const Workplace place;
  TriangleMesh mesh = turned(ball_mesh(20, 40, 0.8));
  mesh.triangles.erase(mesh.triangles.begin() + 11, mesh.triangles.begin() + 13);
  const std::string file = place.write("holed.obj", obj_text(mesh)).string();
  const std::string text = collide({place.text("model.json"), file, "--unit", "cm"}).out;
  for (const char* words : {"Unit       cm", "Size       16.0 x 16.0 x 16.0 mm", "holes filled: 1",
                            "reversed: 1", "open edges found: 4", "Parts      1 closed", "Touching   yes"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in\n" << text;
  }
  const std::string sheet = place.write("sheet.ply", ply_text(sheet_mesh(4, 0.0))).string();
  const std::string plate = collide({place.text("model.json"), sheet}).out;
  EXPECT_NE(plate.find("1 open, treated as plates 1.0 mm thick"), std::string::npos) << plate;
}

TEST(MeshCollide, OurOwnEggIsClosed) {
  const Workplace place;
  const Json facts = facts_of({place.text("model.json"), std::string(SPOONBILL_ASSETS) + "/models/egg.stl"});
  EXPECT_EQ(facts["mesh"]["closed_parts"], 1);
  EXPECT_EQ(facts["mesh"]["sheets"], 0);
  EXPECT_EQ(facts["mesh"]["cleaning"]["open_edges"], 0);
  EXPECT_NEAR(facts["mesh"]["size_mm"][1], 50.0, 1e-4);
}

TEST(MeshCollide, WhatCannotBeIsOneLine) {
  const Workplace place;
  const std::string model = place.text("model.json"),
                    good = place.write("ball.stl", binary_stl(ball)).string();
  const std::string text = binary_stl(ball);
  const std::vector<std::pair<std::vector<std::string>, std::string>> uses = {
      {{good}, "add a document or a mesh"},
      {{good, place.text("missing.stl")}, "missing.stl: no such file"},
      {{model, model, "--unit", "mm"}, "remove --unit"},
      {{model, place.text("missing.stl")}, "missing.stl: no such file"},
      {{place.write("empty.ply", "").string(), model}, "empty.ply: is empty"},
      {{model, place.write("cut.stl", text.substr(0, 500)).string()}, "cut.stl: cannot be read as STL"},
      {{model, place.write("far.stl", binary_stl(ball_mesh(8, 8, 1e6))).string()},
       "far.stl: a coordinate is beyond"},
      {{model, place.write("json.stl", content_of(place.path("model.json"))).string()}, "json.stl: "},
      {{place.text("missing.json"), good}, "missing.json: no such file"}};
  for (const auto& [arguments, reason] : uses) {
    const Outcome outcome = collide(arguments);
    EXPECT_EQ(outcome.code, exit_failed) << reason;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(collide({model, good, "--unit", "ft"}).code, exit_wrong_use);
  EXPECT_EQ(run({"--help"}).out.find("read-mesh"), std::string::npos);
}

}  // namespace
}  // namespace spoonbill
