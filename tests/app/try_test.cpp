// Tests the try command.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

const std::string jelly_on_spoon = std::string(SPOONBILL_ASSETS) + "/models/jelly-on-spoon.json";

TEST(Try, TellsWhereTheJellyIs) {
  const Workplace place;
  const Outcome outcome = run({"try", jelly_on_spoon, "--seconds", "0.1", "--json", "--out",
                               place.text("frames"), "--every", "30", "--size", "320x180"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["inertia_scale"], 1.0);
  EXPECT_EQ(facts["inverted_cells"], 0);
  EXPECT_TRUE(facts["settled"].get<bool>());
  EXPECT_TRUE(facts["stopped"].is_null());
  EXPECT_LT(facts["largest_speed_m_per_s"].get<double>(), 1e-3);
  ASSERT_EQ(facts["bodies"].size(), 2u);
  EXPECT_EQ(facts["bodies"][1]["kind"], "fixed");
  const double carried_n = facts["bodies"][0]["contact_force_n"][1].get<double>();
  EXPECT_GT(carried_n, 0.0);
  EXPECT_NEAR(facts["bodies"][1]["contact_force_n"][1].get<double>(), -carried_n, 1e-6 * carried_n);
  const auto frames = facts["frames"].get<int>();
  EXPECT_GE(frames, 1);
  EXPECT_TRUE(std::filesystem::exists(place.path("frames") / "frame-0000.png"));
}

// A model without the body that the trial lowers has no trial.
TEST(Try, TheTrialGoesWithItsBodies) {
  const Workplace place;
  const std::string spoon = place.text("spoon.json");
  ASSERT_EQ(run({"convert", jelly_on_spoon, spoon, "--bodies", "2"}).code, exit_done);
  EXPECT_FALSE(read_document(spoon).value().scene.trial.has_value());
  EXPECT_EQ(run({"try", spoon}).code, exit_failed);  // nothing deforms
}

TEST(Try, NamesTheBodyThatNothingBears) {
  const Workplace place;
  Document document = read_document(jelly_on_spoon).value();
  document.scene.bodies.pop_back();
  document.scene.trial->turned_body.clear();
  document.scene.trial->lowering_speed_m_per_s = 1.0;
  document.scene.bodies[0].lattice.counts = {{3, 3, 4}};
  place.write("falls.json", json_to_page(document_to_json(document)));
  const Outcome outcome = run({"try", place.text("falls.json"), "--json"});
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_NE(json_of(outcome.out)["stopped"].get<std::string>().find("jelly"), std::string::npos);
  document.scene.planes = {FixingPlane{Vector3(0.137, 0.0, 0.0), Vector3::UnitX()}};
  place.write("held.json", json_to_page(document_to_json(document)));
  const Outcome held = run({"try", place.text("held.json")});
  EXPECT_EQ(held.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(held)) << held.err;
}

TEST(Try, RefusesWrongUse) {
  const Workplace place;
  EXPECT_EQ(run({"try", jelly_on_spoon, "--tilt", "10"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", jelly_on_spoon, "--tilt", "1000deg"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", jelly_on_spoon, "--seconds", "-1"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", place.text("model.json"), "--tilt", "10deg"}).code, exit_failed);
  EXPECT_EQ(run({"try", place.text("missing.json")}).code, exit_failed);
}

}  // namespace
}  // namespace spoonbill
