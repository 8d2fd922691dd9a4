// Tests how commands treat documents in which a body has a mesh.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/process.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

// A closed mesh becomes a body. What works on surfaces names the body and does nothing.
TEST(MeshBodyFiles, AreMadeOfAMesh) {
  const Workplace place;
  const std::string egg = std::string(SPOONBILL_ASSETS) + "/models/egg.stl", out = place.text("out.json");
  const std::string model = place.text("model.json");
  const Outcome outcome =
      run_process(SPOONBILL_PROGRAM, {"add", model, egg, "--pose", "0,0,0,1,0,0,0", "--pose",
                                      "0,-80mm,0,1,0,0,0", "--material", "beech", "--out", out, "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const auto sum = read_document(out);
  ASSERT_TRUE(sum.ok()) << sum.error().message;
  const Body& body = sum->scene.bodies[1];
  EXPECT_EQ(body.name, "egg");
  EXPECT_EQ(body.kind, BodyKind::fixed);
  EXPECT_EQ(body.material.name, "beech");
  ASSERT_TRUE(body.mesh);
  EXPECT_NEAR(find_bounds(body).centre().y(), -0.08, 0.01);
  const Json info = json_of(run({"info", out, "--json"}).out);
  EXPECT_EQ(info["bodies"][1]["mesh"]["triangles"], body.mesh->mesh.triangles.size());
  EXPECT_GT(info["simulated"][1]["mass_kg"], 0.0);
  const Json changed =
      json_of(run({"change", out, "reverse", "v", "--out", place.text("b.json"), "--json"}).out);
  EXPECT_EQ(changed["bodies"].size(), 1u);  // those with a surface
  ASSERT_EQ(run({"add", out, "--held", "egg", "--out", place.text("held.json")}).code, exit_done);
  EXPECT_TRUE(read_document(place.text("held.json")).value().scene.bodies[1].hand);
  EXPECT_EQ(run({"add", out, "--material", "beech", "--out", place.text("c.json")}).code, exit_wrong_use);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"check", out},
        {"sample", out, "--out", place.text("a.csv")},
        {"convert", out, place.text("a.step")},
        {"convert", out, place.text("a.stl")},
        {"change", out, "reverse", "v", "--body", "2", "--out", place.text("a.json")}}) {
    const Outcome refused = run(command);
    EXPECT_EQ(refused.code, exit_failed) << command[0];
    EXPECT_TRUE(is_clean_failure(refused)) << refused.err;
    EXPECT_NE(refused.err.find("egg"), std::string::npos) << refused.err;
  }
  const Outcome part =
      run_process(SPOONBILL_PROGRAM, {"convert", out, place.text("a.step"), "--bodies", "1"});
  EXPECT_EQ(part.code, exit_done) << part.err;
}

}  // namespace
}  // namespace spoonbill
