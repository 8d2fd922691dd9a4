// Tests the add command.
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

// A quarter turn about z, and a move by 10 mm along x.
constexpr const char* quarter_turn = "10mm,0,0,1,0,0,1";

Document loaded_document(const Workplace& place) {
  Document document = read_document(place.path("model.json")).value();
  document.scene.bodies[0].loads = {ForceLoad{{}, Vector3(0.5, 0.0, 0.0)}};
  document.scene.bodies[0].solid = "bracket";
  document.scene.planes = {FixingPlane{Vector3(0.01, 0.0, 0.0), Vector3::UnitX()}};
  place.write("loaded.json", json_to_page(document_to_json(document)));
  return document;
}

TEST(Add, MovesBodiesAndKeepsTheRest) {
  const Workplace place;
  const Document before = loaded_document(place);
  const std::string model = place.text("loaded.json"), out = place.text("out.json");
  const Outcome outcome =
      run({"add", model, model, "--pose", "0,0,0,1,0,0,0", "--pose", quarter_turn, "--out", out, "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Document sum = read_document(out).value();
  ASSERT_EQ(sum.scene.bodies.size(), 2u);
  const Body &first = sum.scene.bodies[0], &second = sum.scene.bodies[1];
  EXPECT_EQ(first.name, before.scene.bodies[0].name);
  EXPECT_EQ(second.name, first.name + "-2");
  EXPECT_EQ(first.solid, "bracket");
  EXPECT_EQ(second.solid, "bracket-2");
  const ControlNet &net = before.scene.bodies[0].surface.net, &moved = second.surface.net;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const Vector3 p = net.point(i, j);
      EXPECT_LT((moved.point(i, j) - Vector3(0.01 - p.y(), p.x(), p.z())).norm(), 1e-12);
      EXPECT_EQ(first.surface.net.point(i, j), p);
    }
  }
  EXPECT_LT((std::get<ForceLoad>(second.loads[0]).force_n - Vector3(0.0, 0.5, 0.0)).norm(), 1e-12);
  EXPECT_EQ(sum.scene.planes.size(), before.scene.planes.size());
  EXPECT_EQ(json_of(outcome.out)["remarks"].size(), 1u);  // the planes of the second model are left out
}

TEST(Add, MakesABodyFixed) {
  const Workplace place;
  const std::string model = place.text("model.json"), out = place.text("out.json");
  const std::string name = read_document(model).value().scene.bodies[0].name;
  ASSERT_EQ(run({"add", model, model, "--fixed", name + "-2", "--out", out}).code, exit_done);
  const Document sum = read_document(out).value();
  EXPECT_EQ(sum.scene.bodies[0].kind, BodyKind::deformable);
  EXPECT_EQ(sum.scene.bodies[1].kind, BodyKind::fixed);
}

TEST(Add, MakesBodiesRigid) {
  const Workplace place;
  const std::string model = place.text("model.json"), out = place.text("out.json");
  const std::string name = read_document(model).value().scene.bodies[0].name;
  ASSERT_EQ(run({"add", model, model, "--rigid", name, "--held", name + "-2", "--out", out}).code, exit_done);
  const Document sum = read_document(out).value();
  EXPECT_EQ(sum.scene.bodies[0].kind, BodyKind::rigid);
  EXPECT_FALSE(sum.scene.bodies[0].hand);
  EXPECT_EQ(sum.scene.bodies[1].kind, BodyKind::rigid);
  EXPECT_TRUE(sum.scene.bodies[1].hand);
  // A body has one kind.
  const Outcome twice =
      run({"add", model, "--rigid", name, "--fixed", name, "--out", place.text("two.json")});
  EXPECT_EQ(twice.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(twice)) << twice.err;
}

// A trial that lowers a body which can no longer be lowered is left out, so that the document can be read.
TEST(Add, LeavesOutATrialThatDoesNotFit) {
  const Workplace place;
  const std::string jelly = std::string(SPOONBILL_ASSETS) + "/models/jelly-on-spoon.json";
  const std::string out = place.text("out.json");
  const Outcome outcome = run({"add", jelly, "--fixed", "jelly", "--out", out, "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["remarks"].size(), 1u);
  const auto sum = read_document(out);
  ASSERT_TRUE(sum.ok()) << sum.error().message;
  EXPECT_FALSE(sum->scene.trial);
}

TEST(Add, RefusesWrongUse) {
  const Workplace place;
  loaded_document(place);
  const std::string model = place.text("loaded.json"), out = place.text("out.json");
  EXPECT_EQ(run({"add", model}).code, exit_wrong_use);
  EXPECT_EQ(run({"add", model, "--pose", "1,0,0,1,0,0,0", "--out", out}).code, exit_wrong_use);
  EXPECT_EQ(run({"add", model, "--pose", quarter_turn, "--pose", quarter_turn, "--out", out}).code,
            exit_wrong_use);
  for (const char* name : {"nobody", "handle"}) {
    const Outcome outcome = run({"add", model, "--fixed", name, "--out", out});
    EXPECT_EQ(outcome.code, exit_failed);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace spoonbill
