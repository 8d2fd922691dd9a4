// Tests the new command for shapes made from points in files: tube, lathe and loft.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

void expect_simulable(const Workplace& place, const std::string& name) {
  const auto document = read_document(place.path(name));
  ASSERT_TRUE(document.ok()) << document.error().message;
  const auto simulation = Simulation::make(document->scene, best_instruction_set());
  EXPECT_TRUE(simulation.ok()) << simulation.error().message;
}

TEST(NewTube, GoesThroughThePointsOfAFile) {
  const Workplace place;
  place.write("path.csv", "x_mm,y_mm,z_mm\n0,0,0\n40,10,0\n80,0,10\n");
  const Outcome outcome = run({"new", "tube", "--path", place.text("path.csv"), "--radius", "6mm", "--out",
                               place.text("tube.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["closed"], true);
  EXPECT_LE(facts["deviation_m"], 1e-5);
  EXPECT_GT(facts["volume_m3"], pi * 0.006 * 0.006 * 0.081);
  expect_simulable(place, "tube.json");
}

TEST(NewTube, TakesPointsAndAnEllipse) {
  const Workplace place;
  const Outcome outcome = run({"new", "tube", "--path", "0,0,0;100,0,0mm", "--width", "2cm", "--height",
                               "8mm", "--out", place.text("tube.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_NEAR(facts["size_mm"][0], 108.0, 0.05);
  EXPECT_NEAR(facts["size_mm"][1], 8.0, 0.05);
  EXPECT_NEAR(facts["size_mm"][2], 20.0, 0.05);
  expect_simulable(place, "tube.json");
}

TEST(NewTube, RefusesOneThatPassesThroughItself) {
  const Workplace place;
  const Outcome outcome = run({"new", "tube", "--path", "0,0,0;60,0,0;60,40,0;30,40,0;30,-40,0mm", "--radius",
                               "4mm", "--out", place.text("tube.json")});
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("through itself"), std::string::npos) << outcome.err;
}

// A radius that follows the advice in the error message makes a tube that does not fold.
TEST(NewTube, SaysHowWideItMayBe) {
  const Workplace place;
  const auto made = [&](const std::string& radius) {
    return run({"new", "tube", "--path", "0,0,0;10,0,0;0,1,0mm", "--radius", radius, "--out",
                place.text("tube.json")});
  };
  const std::string told = made("5mm").err;
  const std::size_t at = told.find("at most ");
  ASSERT_NE(at, std::string::npos) << told;
  const double share = std::stod(told.substr(at + 8)) / 100.0;
  EXPECT_LT(share, 1.0) << told;
  const Outcome thinner = made(std::to_string(5.0 * share) + "mm");
  EXPECT_EQ(thinner.err.find("folds"), std::string::npos) << thinner.err;
  EXPECT_EQ(told.find("-0.0"), std::string::npos) << told;
}

TEST(NewLathe, ClosedOnTheAxisOrOpen) {
  const Workplace place;
  place.write("vase.csv", "radius_mm,height_mm\n0,0\n20,5\n25,30\n12,60\n0,70\n");
  const Outcome closed =
      run({"new", "lathe", "--profile", place.text("vase.csv"), "--out", place.text("vase.json"), "--json"});
  ASSERT_EQ(closed.code, exit_done) << closed.err;
  EXPECT_EQ(json_of(closed.out)["closed"], true);
  expect_simulable(place, "vase.json");
  EXPECT_TRUE(is_clean_failure(run({"new", "lathe", "--profile", place.text("vase.csv"), "--thickness", "2mm",
                                    "--out", place.text("vase.json")})));
  place.write("bowl.csv", "radius_mm,height_mm\n0,0\n20,5\n35,20\n40,35\n");
  const Outcome open =
      run({"new", "lathe", "--profile", place.text("bowl.csv"), "--out", place.text("bowl.json"), "--json"});
  ASSERT_EQ(open.code, exit_done) << open.err;
  EXPECT_EQ(json_of(open.out)["closed"], false);
  EXPECT_EQ(read_document(place.path("bowl.json"))->scene.bodies[0].shell_thickness_m, 0.002);
  expect_simulable(place, "bowl.json");
}

std::string ring(int section, double x_mm, double radius_mm) {
  std::string rows;
  for (int k = 0; k < 24; ++k) {
    const double angle = 2.0 * pi * k / 24.0;
    rows += std::to_string(section) + "," + std::to_string(x_mm) + "," +
            std::to_string(radius_mm * std::sin(angle)) + "," + std::to_string(radius_mm * std::cos(angle)) +
            "\n";
  }
  return rows;
}

TEST(NewLoft, GoesThroughItsSections) {
  const Workplace place;
  place.write("sections.csv", "section,x_mm,y_mm,z_mm\n" + ring(1, 0, 10) + ring(2, 30, 14) + ring(3, 60, 8));
  const Outcome outcome = run(
      {"new", "loft", "--sections", place.text("sections.csv"), "--out", place.text("loft.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["closed"], true);
  EXPECT_NEAR(json_of(outcome.out)["size_mm"][1], 28.0, 0.3);
  expect_simulable(place, "loft.json");
  const Outcome pipe = run({"new", "loft", "--sections", place.text("sections.csv"), "--no-caps", "--out",
                            place.text("pipe.json"), "--json"});
  ASSERT_EQ(pipe.code, exit_done) << pipe.err;
  EXPECT_EQ(json_of(pipe.out)["closed"], false);
  expect_simulable(place, "pipe.json");
}

TEST(NewSwept, RefusesFilesThatAreNone) {
  const Workplace place;
  place.write("empty.csv", "");
  place.write("words.csv", "x_mm,y_mm,z_mm\none,two,three\n");
  place.write("once.csv", "x_mm,y_mm,z_mm\n1,2,3\n");
  place.write("same.csv", "x_mm,y_mm,z_mm\n1,2,3\n1,2,3\n");
  place.write("sharp.csv", "x_mm,y_mm,z_mm\n0,0,0\n10,0,0\n0,1,0\n");
  for (const char* name : {"empty.csv", "words.csv", "once.csv", "same.csv", "sharp.csv", "missing.csv"}) {
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"new", "tube", "--path", place.text(name)},
                                               {"new", "lathe", "--profile", place.text(name)},
                                               {"new", "loft", "--sections", place.text(name)}}) {
      auto all = arguments;
      all.insert(all.end(), {"--out", place.text("none.json")});
      const Outcome outcome = run(all);
      EXPECT_EQ(outcome.code, exit_failed) << outcome.out;
      EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(place.path("none.json")));
  EXPECT_TRUE(is_clean_failure(
      run({"new", "tube", "--path", "0,0,0;100,0,0mm", "--width", "2cm", "--out", place.text("none.json")})));
}

}  // namespace
}  // namespace spoonbill
