// The command that tells whether bodies are sound.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

Json check_of(const Workplace& place, const std::string& name) {
  const Outcome outcome = run({"check", place.text(name), "--json"});
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  return json_of(outcome.out);
}

Document made(const Workplace& place, std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--out", place.text("made.json")});
  EXPECT_EQ(run(arguments).code, exit_done);
  return read_document(place.path("made.json")).value();
}

void save(const Workplace& place, const std::string& name, const Document& document) {
  place.write(name, json_to_page(document_to_json(document)));
}

TEST(Check, MeasuresATorus) {
  const Workplace place;
  made(place, {"new", "torus", "--ring", "40mm", "--tube", "10mm", "--control", "64x64"});
  const Json facts = check_of(place, "made.json");
  EXPECT_EQ(facts["sound"], true);
  const Json body = facts["bodies"][0];
  EXPECT_EQ(body["closedness"], "solid");
  EXPECT_EQ(body["normals_outward"], true);
  const double volume = 2.0 * pi * pi * 0.04 * 0.01 * 0.01;
  EXPECT_NEAR(body["volume_m3"].get<double>() / volume, 1.0, 1e-4);
  EXPECT_NEAR(body["area_m2"].get<double>() / (4.0 * pi * pi * 0.04 * 0.01), 1.0, 1e-4);
  EXPECT_NEAR(body["mass_kg"].get<double>() / (1700.0 * volume), 1.0, 1e-4);
  EXPECT_NEAR(body["smallest_thickness_m"], 0.02, 1e-5);
  EXPECT_NEAR(body["smallest_convex_radius_m"], 0.01, 1e-5);
  EXPECT_NEAR(body["smallest_concave_radius_m"], 0.03, 1e-4);
  EXPECT_TRUE(body["self_intersections"].empty());
  EXPECT_TRUE(body["degenerate"].empty());
}

TEST(Check, SaysWhatIsWrongAndEndsWellAllTheSame) {
  const Workplace place;
  Document sheet = made(place, {"new", "plate", "--size", "100x60mm", "--sheet"});
  save(place, "shell.json", sheet);
  EXPECT_EQ(check_of(place, "shell.json")["sound"], true);
  sheet.scene.bodies[0].shell_thickness_m.reset();
  save(place, "open.json", sheet);
  const Json open = check_of(place, "open.json")["bodies"][0];
  EXPECT_EQ(open["sound"], false);
  EXPECT_EQ(open["closedness"], "sheet");
  EXPECT_NE(open["problems"][0].get<std::string>().find("open by"), std::string::npos);

  Document ball = made(place, {"new", "sphere"});
  for (double& x : ball.scene.bodies[0].surface.net.x) x = -x;
  save(place, "inside-out.json", ball);
  const Json turned = check_of(place, "inside-out.json")["bodies"][0];
  EXPECT_EQ(turned["sound"], false);
  EXPECT_EQ(turned["normals_outward"], false);

  for (double& x : ball.scene.bodies[0].surface.net.x) x = -x;
  ball.scene.bodies[0].shell_thickness_m = 0.05;
  save(place, "thick.json", ball);
  const Json thick = check_of(place, "thick.json")["bodies"][0];
  ASSERT_EQ(thick["problems"].size(), 1U);
  EXPECT_NE(thick["problems"][0].get<std::string>().find("thicker than"), std::string::npos);
  const Outcome lines = run({"check", place.text("inside-out.json")});
  EXPECT_EQ(lines.code, exit_done);
  EXPECT_NE(lines.out.find("not sound"), std::string::npos);
}

TEST(Check, LooksAtEveryBody) {
  const Workplace place;
  Document two = made(place, {"new", "sphere"});
  two.scene.bodies.push_back(two.scene.bodies[0]);
  two.scene.bodies[1].name = "other";
  for (double& x : two.scene.bodies[1].surface.net.x) x = -x;
  save(place, "two.json", two);
  const Json facts = check_of(place, "two.json");
  EXPECT_EQ(facts["sound"], false);
  EXPECT_EQ(facts["bodies"][0]["sound"], true);
  EXPECT_EQ(facts["bodies"][1]["sound"], false);
}

TEST(Check, RefusesWhatIsNoDocument) {
  const Workplace place;
  place.write("broken.json", "{\"spoonbill_document\": 1");
  EXPECT_TRUE(is_clean_failure(run({"check", place.text("broken.json")})));
  EXPECT_TRUE(is_clean_failure(run({"check", place.text("missing.json")})));
  EXPECT_EQ(run({"check"}).code, exit_wrong_use);
}

}  // namespace
}  // namespace spoonbill
