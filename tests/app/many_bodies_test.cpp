// Tests documents with more bodies than can be sculpted together, such as CAD parts with many faces.
#include <gtest/gtest.h>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

constexpr int most_together = 8;

class ManyBodies : public testing::Test {
 protected:
  // Each body is a solid of its own, except two that are faces of the same solid.
  void SetUp() override {
    Document document = read_document(place_.path("model.json")).value();
    const Body first = document.scene.bodies[0];
    for (int k = 1; k <= 2 * most_together; ++k) {
      Body body = first;
      body.name = "body " + std::to_string(k + 1);
      for (double& x : body.surface.net.x) x += 0.2 * k;
      document.scene.bodies.push_back(std::move(body));
    }
    document.scene.bodies[1].solid = document.scene.bodies[2].solid = "bracket";
    many_ = place_.write("many.json", json_to_page(document_to_json(document))).string();
  }

  void expect_refusal(const std::vector<std::string>& arguments) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_failed) << arguments[0];
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(many_ + ": holds 17 bodies, and at most 8 are sculpted together; choose some "
                                       "with `spoonbill convert MODEL OUT.json --bodies 1,3-5`"),
              std::string::npos)
        << outcome.err;
  }

  static Json facts_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return outcome.code == exit_done ? json_of(outcome.out) : Json::object();
  }

  Workplace place_;
  std::string many_;
};

TEST_F(ManyBodies, AreNotSculptedTogether) {
  Json script = json_of(content_of(place_.path("script.json")));
  script["model"] = "many.json";
  place_.write("script.json", json_to_page(script));
  expect_refusal({"record", place_.text("script.json"), "--out", place_.text("out.jsonl")});
  EXPECT_FALSE(std::filesystem::exists(place_.path("out.jsonl")));
  expect_refusal({"rest", many_});
}

TEST_F(ManyBodies, AreToldOfWithoutALattice) {
  const Json facts = facts_of({"info", many_});
  EXPECT_EQ(facts["bodies"].size(), 17u);
  EXPECT_TRUE(facts["lattice"].is_null());
  EXPECT_NE(facts["no_lattice_because"].get<std::string>().find("holds 17 bodies"), std::string::npos);
}

TEST_F(ManyBodies, SomeAreChosenAsTheyAre) {
  expect_refusal({"rest", many_});
  const Json facts = facts_of({"convert", many_, place_.text("some.json"), "--bodies", "2-3,17"});
  ASSERT_EQ(facts["bodies"].size(), 3u);
  EXPECT_EQ(facts["bodies"][2]["name"], "body 17");
  Json expected = json_of(content_of(many_));
  expected["body"] = expected["other_bodies"][0];
  expected["other_bodies"] = Json::array({expected["other_bodies"][1], expected["other_bodies"][15]});
  EXPECT_EQ(json_of(content_of(place_.path("some.json"))), expected);
  EXPECT_EQ(facts_of({"info", place_.text("some.json")})["simulated"].size(), 3u);
  const Outcome same_unit =
      run({"convert", many_, place_.text("some.json"), "--bodies", "1", "--unit", "mm"});
  EXPECT_EQ(same_unit.code, exit_failed);
  EXPECT_NE(same_unit.err.find("remove --unit"), std::string::npos) << same_unit.err;
}

TEST_F(ManyBodies, AreCheckedSampledAndChanged) {
  EXPECT_EQ(facts_of({"check", many_})["bodies"].size(), 17u);
  const std::string points = place_.text("points.csv");
  EXPECT_EQ(run({"sample", many_, "--grid", "3x3", "--out", points}).code, exit_done);
  EXPECT_NE(content_of(points).find("\nbody 17,"), std::string::npos);
  const Json changed =
      facts_of({"change", many_, "reverse", "v", "--body", "17", "--out", place_.text("changed.json")});
  EXPECT_EQ(changed["bodies"].size(), 17u);
  EXPECT_EQ(read_document(place_.path("changed.json"))->scene.bodies[1].solid, "bracket");
}

TEST(Bodies, ADocumentHoldsAThousand) {
  Json json = document_to_json(sample_document());
  const Json body = json["body"];
  json["other_bodies"] = Json::array();
  for (int k = 0; k < 999; ++k) json["other_bodies"].push_back(body);
  const auto document = document_from_json(json, "many.json");
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->scene.bodies.size(), 1000u);
  json["other_bodies"].push_back(body);
  const auto more = document_from_json(json, "many.json");
  ASSERT_FALSE(more);
  EXPECT_EQ(Refusal(more), Refusal(ErrorCode::too_many, "other_bodies"));
}

TEST(Bodies, KeepTheNameOfTheirSolid) {
  Json json = document_to_json(sample_document());
  json["body"]["solid"] = "bracket";
  const auto document = document_from_json(json, "a.json");
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->scene.bodies[0].solid, "bracket");
  EXPECT_EQ(document_to_json(document.value()), json);
}

}  // namespace
}  // namespace spoonbill
