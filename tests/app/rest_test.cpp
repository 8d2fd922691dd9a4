// Tests the rest command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ctime>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

Document elastic_document(const Workplace& place) {
  Document document = read_document(place.path("model.json")).value();
  Material& material = document.scene.bodies[0].material;
  material.plastic = false;
  material.youngs_modulus_pa = 1e9;
  document.scene.planes.clear();
  document.scene.sculpting.gravity_m_per_s2.setZero();
  return document;
}

Vector3 vector_of(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Outcome rest_of(const Workplace& place, const Document& document, std::vector<std::string> more = {}) {
  place.write("loaded.json", json_to_page(document_to_json(document)));
  std::vector<std::string> arguments = {"rest", place.text("loaded.json"), "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments);
}

// Half of the force gives half of the displacement, the reactions balance the load, and the weight counts as
// a load.
TEST(Rest, TellsWhatALoadDoes) {
  const Workplace place;
  Document document = elastic_document(place);
  Body& body = document.scene.bodies[0];
  body.supports = {{{{0.0, 0.2}}, {}}};
  std::vector<double> displaced;
  for (const double force_n : {0.01, 0.02}) {
    body.loads = {ForceLoad{{{0.9, 1.0}}, Vector3(0, -force_n, 0)}};
    const Outcome outcome = rest_of(place, document);
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    const Json facts = json_of(outcome.out)["bodies"][0];
    EXPECT_EQ(facts["name"], body.name);
    EXPECT_NEAR(facts["reaction_n"][1].get<double>(), force_n, 1e-6 * force_n);
    EXPECT_NEAR(facts["load_n"][1].get<double>(), -force_n, 1e-9 * force_n);
    EXPECT_LT(facts["displacement_m"][1].get<double>(), 0.0);
    EXPECT_GT(std::abs(facts["largest_strain"].get<double>()), 0.0);
    displaced.push_back(facts["largest_displacement_m"]);
  }
  EXPECT_NEAR(displaced[1] / displaced[0], 2.0, 0.01);
  body.loads.clear();
  document.scene.sculpting.gravity_m_per_s2 = Vector3(0, 0, 9.81);
  const Json heavy = json_of(rest_of(place, document).out)["bodies"][0];
  EXPECT_LT((vector_of(heavy["load_n"]) + vector_of(heavy["reaction_n"])).norm(),
            1e-6 * vector_of(heavy["load_n"]).norm());
  EXPECT_GT(heavy["load_n"][2].get<double>(), 0.0);
}

TEST(Rest, SavesTheBentShapeWithoutItsLoads) {
  const Workplace place;
  Document document = elastic_document(place);
  Body& body = document.scene.bodies[0];
  SupportMotion motion;
  motion.displacement_m = Vector3(0, 0.003, 0);
  body.supports = {{{{0.0, 0.1}}, {}}, {{{0.9, 1.0}}, motion}};
  body.loads = {PressureLoad{{}, 10.0}};
  const Outcome outcome = rest_of(place, document, {"--out", place.text("bent.json")});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Result<Document> bent = read_document(place.path("bent.json"));
  ASSERT_TRUE(bent.ok()) << bent.error().message;
  const Body& now = bent->scene.bodies[0];
  EXPECT_TRUE(now.loads.empty());
  ASSERT_EQ(now.supports.size(), 2u);
  EXPECT_FALSE(now.supports[1].motion);
  const ControlNet& net = now.surface.net;
  for (const int column : {0, net.columns - 1}) {
    for (int i = 1; i < net.rows; ++i) {
      EXPECT_EQ(net.point(i, column), net.point(0, column)) << "poles stay exactly together";
    }
  }
  const auto end_of = [](const Body& of) {
    return evaluate(of.surface, 0.0, of.surface.v.domain_end()).position_m;
  };
  EXPECT_NEAR((end_of(now) - end_of(body)).y(), 0.003, 3e-5) << "what the control net follows of it";
  const Outcome again = run({"rest", place.text("bent.json"), "--json"});
  ASSERT_EQ(again.code, exit_done) << again.err;
  EXPECT_LT(json_of(again.out)["bodies"][0]["largest_displacement_m"].get<double>(), 1e-12);
}

TEST(Rest, RefusesBodiesThatNothingHolds) {
  const Workplace place;
  Document document = elastic_document(place);
  const Outcome loose = rest_of(place, document);
  EXPECT_TRUE(is_clean_failure(loose)) << loose.err;
  EXPECT_NE(loose.err.find("nothing fixes the body; give it a support"), std::string::npos) << loose.err;
  document.scene.bodies[0].loads = {ForceLoad{{{0.5, 0.5001}}, Vector3(1, 0, 0)}};
  const Outcome nowhere = rest_of(place, document);
  EXPECT_TRUE(is_clean_failure(nowhere));
  EXPECT_NE(nowhere.err.find("loads[0]: the region contains no"), std::string::npos) << nowhere.err;
  EXPECT_TRUE(is_clean_failure(run({"rest", place.text("missing.json")})));
  EXPECT_EQ(run({"rest"}).code, exit_wrong_use);
}

// Every node is fixed, by a support or behind a plane.
TEST(Rest, SaysWhereEverythingIsFixed) {
  const Workplace place;
  Document document = elastic_document(place);
  document.scene.sculpting.gravity_m_per_s2 = Vector3(0, -9.81, 0);
  Body& body = document.scene.bodies[0];
  const auto expect_still = [&] {
    const Outcome outcome = rest_of(place, document);
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    const Json facts = json_of(outcome.out)["bodies"][0];
    EXPECT_EQ(facts["fixed_everywhere"], true);
    EXPECT_EQ(facts["held_nodes"], facts["nodes"]);
    EXPECT_EQ(facts["largest_displacement_m"], 0.0);
    EXPECT_EQ(facts["largest_strain"], 0.0);
    EXPECT_EQ(facts["newton_steps"], 0);
    EXPECT_LT((vector_of(facts["load_n"]) + vector_of(facts["reaction_n"])).norm(), 1e-9);
    const Outcome lines = run({"rest", place.text("loaded.json")});
    EXPECT_NE(lines.out.find("everything is fixed: nothing moves"), std::string::npos) << lines.out;
  };
  document.scene.planes = {FixingPlane{Vector3(0, 100, 0), Vector3(0, 1, 0)}};
  expect_still();
  document.scene.planes.clear();
  body.supports = {{{}, {}}};
  expect_still();
  body.supports[0].motion = SupportMotion{};
  body.supports[0].motion->displacement_m = Vector3(0, 0.003, 0);
  const Outcome moved = rest_of(place, document);
  ASSERT_EQ(moved.code, exit_done) << moved.err;
  EXPECT_NEAR(json_of(moved.out)["bodies"][0]["largest_displacement_m"].get<double>(), 0.003, 1e-12);
}

TEST(Rest, AnswersForBallsThatAreFixedEverywhere) {
  for (const char* file : {"rest-all-held.json", "rest-all-behind-plane.json"}) {
    const Outcome outcome = run({"rest", SPOONBILL_TEST_INPUTS "/" + std::string(file), "--json"});
    ASSERT_EQ(outcome.code, exit_done) << file << outcome.err;
    const Json body = json_of(outcome.out)["bodies"][0];
    EXPECT_EQ(body["fixed_everywhere"], true) << file;
    EXPECT_EQ(body["largest_displacement_m"], 0.0) << file;
  }
}

TEST(Rest, StopsWhenAskedTo) {
  const Workplace place;
  Document document = elastic_document(place);
  document.scene.bodies[0].supports = {{{{0.0, 0.2}}, {}}};
  place.write("bent.json", "mine");
  sigset_t interrupt, before;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  for (const bool writes : {false, true}) {
    pthread_sigmask(SIG_BLOCK, &interrupt, &before);
    raise(SIGINT);
    const Outcome outcome =
        rest_of(place, document,
                writes ? std::vector<std::string>{"--out", place.text("bent.json"), "--force"}
                       : std::vector<std::string>{});
    const timespec no_wait{};
    sigtimedwait(&interrupt, nullptr, &no_wait);  // removes the signal if it is still pending
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    EXPECT_EQ(outcome.code, exit_failed);
    EXPECT_EQ(outcome.err,
              "spoonbill: stopped" +
                  (writes ? "; " + place.text("bent.json") + " was not written" : std::string()) + "\n");
  }
  EXPECT_EQ(content_of(place.path("bent.json")), "mine");
}

TEST(Rest, TellsAPersonInLines) {
  const Workplace place;
  Document document = elastic_document(place);
  document.scene.bodies[0].supports = {{{{0.0, 0.2}}, {}}};
  document.scene.bodies[0].material.plastic = true;
  place.write("loaded.json", json_to_page(document_to_json(document)));
  const Outcome outcome = run({"rest", place.text("loaded.json")});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  for (const char* text : {"Fixed nodes", "Displaced", "Reactions", "Strain", "treated as elastic"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace spoonbill
