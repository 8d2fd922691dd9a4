// Tests the new command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <numbers>
#include <utility>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(New, ReportsWhatItMade) {
  const Workplace place;
  const Outcome outcome = run(
      {"new", "sphere", "--radius", "40mm", "--name", "ball", "--out", place.text("ball.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["kind"], "sphere");
  EXPECT_NEAR(facts["size_mm"][1], 80.0, 0.02);
  EXPECT_LE(facts["deviation_m"], 1e-5);
  EXPECT_NEAR(facts["volume_m3"], 4.0 / 3.0 * pi * std::pow(0.04, 3), 1e-5 * 4.0 * pi * 0.04 * 0.04);
  EXPECT_NEAR(facts["area_m2"], 4.0 * pi * 0.04 * 0.04, 1e-5);
  EXPECT_EQ(facts["closed"], true);
  const Document document = read_document(place.path("ball.json")).value();
  EXPECT_EQ(document.name, "ball");
  const Body& body = document.scene.bodies[0];
  EXPECT_EQ(body.material.name, "modelling-clay");
  EXPECT_EQ(facts["control_points"][0], body.surface.net.rows);
  EXPECT_EQ(facts["control_points"][1], body.surface.net.columns);
}

// Shapes that are round as a whole have the requested radii. For other shapes, the report states how closely
// they reach the requested radius.
TEST(New, RoundShapesKeepTheirRadii) {
  const Workplace place;
  const auto made = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "new");
    const Outcome outcome = run(with(arguments, {"--out", place.text("round.json"), "--json"}));
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out);
  };
  const std::vector<std::pair<std::vector<std::string>, double>> shapes = {
      {{"sphere", "--radius", "20mm"}, 0.02},
      {{"torus", "--ring", "40mm", "--tube", "10mm"}, 0.01},
      {{"cylinder", "--radius", "20mm", "--rounding", "10mm"}, 0.01},
      {{"cone", "--radius", "30mm"}, 0.006},
  };
  for (const auto& [arguments, radius_m] : shapes) {
    const Json facts = made(arguments);
    EXPECT_NEAR(facts["smallest_radius_m"], radius_m, 3e-3 * radius_m) << arguments[0];
    EXPECT_NEAR(facts["asked_radius_m"], radius_m, 1e-12) << arguments[0];
  }
  const Json box = made({"box", "--size", "60x40x20mm", "--rounding", "3mm"});
  EXPECT_NEAR(box["asked_radius_m"], 0.003, 1e-12);
  EXPECT_GT(box["smallest_radius_m"], 0.0);
  EXPECT_EQ(made({"sphere", "--control", "4x5"})["control_points"], Json::array({4, 5}));
}

TEST(New, TakesCountsMaterialAndUnits) {
  const Workplace place;
  const Outcome outcome = run({"new", "box", "--size", "6cmx40mmx0.8in", "--control", "32x24", "--material",
                               "beech", "--out", place.text("box.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_NEAR(facts["size_mm"][0], 60.0, 0.1);
  EXPECT_NEAR(facts["size_mm"][1], 40.0, 0.1);
  EXPECT_NEAR(facts["size_mm"][2], 20.32, 0.1);
  EXPECT_EQ(facts["control_points"], Json::array({32, 24}));
  EXPECT_EQ(read_document(place.path("box.json"))->scene.bodies[0].material.name, "beech");
}

class Lumps : public testing::TestWithParam<std::vector<std::string>> {};

// A script presses the ball tool of the document into the top of the shape. The recording must replay.
TEST_P(Lumps, CanBePressed) {
  const Workplace place;
  const Outcome made = run(with(GetParam(), {"--out", place.text("lump.json"), "--json"}));
  ASSERT_EQ(made.code, exit_done) << made.err;
  const Scene scene = read_document(place.path("lump.json"))->scene;
  const double radius = scene.tool.radius_m;
  const double top = 5e-4 * json_of(made.out)["size_mm"][1].get<double>();
  const auto at = [](double height_m) { return "[0, " + std::to_string(1e3 * height_m) + ", 0]"; };
  place.write("press.json", R"({"spoonbill_script": 1, "model": "lump.json", "steps": [{"start_mm": )" +
                                at(top + 1.2 * radius) + R"(}, {"move_to_mm": )" + at(top + 0.7 * radius) +
                                R"(, "over_s": 0.1}]})");
  const Outcome recorded =
      run({"record", place.text("press.json"), "--out", place.text("press.recording.jsonl"), "--json"});
  ASSERT_EQ(recorded.code, exit_done) << recorded.err;
  const Outcome replayed = run({"replay", place.text("press.recording.jsonl"), "--no-frames", "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_EQ(json_of(replayed.out)["state_hash"], json_of(recorded.out)["state_hash"]);
}

// The ball tool is pressed in by a tenth of its radius. The reaction must be perceptible, and the
// displacement of the surface must be a plausible fraction of the depth.
TEST_P(Lumps, GiveWayToTheirTool) {
  const Workplace place;
  ASSERT_EQ(run(with(GetParam(), {"--out", place.text("lump.json")})).code, exit_done);
  const Scene scene = read_document(place.path("lump.json"))->scene;
  const Surface& surface = scene.bodies[0].surface;
  double top = -1.0;
  for (const double y : surface.net.y) top = std::max(top, y);
  auto simulation = Simulation::make(scene, best_instruction_set());
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  const double radius = scene.tool.radius_m;
  ToolInput hand;
  double largest_n = 0.0;
  for (int tick = 0; tick < 60; ++tick) {
    hand.pose.position_m = Vector3(0.0, top + radius * (1.0 - 0.1 * std::min(1.0, tick / 30.0)), 0.0);
    largest_n = std::max(largest_n, simulation->advance(hand).force_n.y());
  }
  EXPECT_GT(largest_n, 0.01);
  EXPECT_LT(largest_n, 50.0);
  Snapshot snapshot;
  simulation->write_snapshot(snapshot);
  const SurfaceSnapshot& pressed = snapshot.bodies[0].surface;
  ControlNet net(pressed.u.control_point_count(), pressed.v.control_point_count());
  std::copy(pressed.x.begin(), pressed.x.end(), net.x.begin());
  std::copy(pressed.y.begin(), pressed.y.end(), net.y.begin());
  std::copy(pressed.z.begin(), pressed.z.end(), net.z.begin());
  const auto after = make_surface(pressed.u, pressed.v, net);
  ASSERT_TRUE(after.ok()) << after.error().message;
  double moved = 0.0;
  for (double u = 0.0; u < 1.0; u += 0.01) {
    for (double v = 0.0; v <= 1.0; v += 0.01) {
      moved = std::max(moved, (position(after.value(), u, v) - position(surface, u, v)).norm());
    }
  }
  EXPECT_GT(moved, 0.005 * radius);
  EXPECT_LT(moved, radius);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Lumps,
    testing::Values(std::vector<std::string>{"new", "sphere"},
                    std::vector<std::string>{"new", "box", "--size", "60x40x20mm", "--rounding", "3mm"},
                    std::vector<std::string>{"new", "box", "--size", "40x40x40mm"},
                    std::vector<std::string>{"new", "cylinder"},
                    std::vector<std::string>{"new", "cylinder", "--radius", "5cm", "--height", "1cm"},
                    std::vector<std::string>{"new", "cone"},
                    std::vector<std::string>{"new", "cone", "--top", "1cm"},
                    std::vector<std::string>{"new", "plate", "--size", "100x60mm"},
                    std::vector<std::string>{"new", "plate", "--size", "100x60mm", "--sheet"}));

TEST(New, TorusIsSculptedInABoxOfCells) {
  const Workplace place;
  const Outcome outcome = run({"new", "torus", "--out", place.text("ring.json")});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Outcome info = run({"info", place.text("ring.json"), "--json"});
  ASSERT_EQ(info.code, exit_done) << info.err;
  EXPECT_EQ(json_of(info.out)["closedness"], "solid");
  EXPECT_FALSE(json_of(info.out)["lattice"].is_null());
  EXPECT_NE(info.out.find("a box of cells"), std::string::npos);
}

// A bowl knows its rim. The bundled bowl of a spoon was made by this command, and then moved.
TEST(New, ABowlHasARim) {
  const Workplace place;
  const Outcome outcome = run({"new", "bowl", "--length", "60mm", "--width", "38mm", "--depth", "8mm",
                               "--rim", "2mm", "--out", place.text("bowl.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  for (const auto& [axis, size_mm] : {std::pair(0, 60.0), {1, 10.0}, {2, 38.0}}) {
    EXPECT_NEAR(facts["size_mm"][axis], size_mm, 0.05);
  }
  EXPECT_FALSE(facts.contains("asked_radius_m"));
  const Body made = read_document(place.path("bowl.json"))->scene.bodies[0];
  const Body bundled = read_document(SPOONBILL_ASSETS "/models/spoon-bowl.json")->scene.bodies[0];
  EXPECT_EQ(made.rim.size(), 4u);
  EXPECT_EQ(made.rim, bundled.rim);
  for (double u = 0.0; u < 1.0; u += 0.05) {
    for (double v = 0.0; v <= 1.0; v += 0.05) {
      const Vector3 moved = position(made.surface, u, v) + Vector3(0.134, 0.0, 0.0);
      EXPECT_LT((moved - position(bundled.surface, u, v)).norm(), 1e-8);
    }
  }
  const Outcome pitched =
      run({"new", "bowl", "--pitch", "-10deg", "--out", place.text("pitched.json"), "--json"});
  ASSERT_EQ(pitched.code, exit_done) << pitched.err;
  const Surface down = read_document(place.path("pitched.json"))->scene.bodies[0].surface;
  EXPECT_LT(position(down, 0.0, 1.0).y(), -0.005);
}

// A rim stays where the parameters of the surface stay, and goes with a warning where they do not.
TEST(New, TheRimOfABowlGoesWithItsSurface) {
  const Workplace place;
  ASSERT_EQ(run({"new", "bowl", "--out", place.text("bowl.json")}).code, exit_done);
  const auto rim_after = [&](std::vector<std::string> change) {
    const Outcome outcome = run(with({"change", place.text("bowl.json")},
                                     with(std::move(change), {"--out", place.text("out.json"), "--force"})));
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return read_document(place.path("out.json"))->scene.bodies[0].rim.size();
  };
  EXPECT_EQ(rim_after({"degree", "v", "4"}), 4u);
  EXPECT_EQ(rim_after({"reverse", "u"}), 0u);
}

TEST(New, RefusesWhatMakesNoShape) {
  const Workplace place;
  place.write("old.json", "precious");
  const auto out = [&](std::vector<std::string> arguments) {
    return run(with(std::move(arguments), {"--out", place.text("old.json")}));
  };
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"new", "sphere", "--radius", "0.01mm"},
           {"new", "sphere", "--radius", "-5mm"},
           {"new", "sphere", "--radius", "11m"},
           {"new", "box", "--size", "60x40x0mm"},
           {"new", "box", "--size", "60x40x20mm", "--rounding", "9mm"},
           {"new", "cone", "--rounding", "25mm"},
           {"new", "cylinder", "--rounding", "0.01mm"},
           {"new", "torus", "--ring", "1cm", "--tube", "2cm"},
           {"new", "plate", "--size", "100x60mm", "--thickness", "40mm"},
           {"new", "plate", "--size", "100x60mm", "--corner", "1mm"},
           {"new", "bowl", "--depth", "22mm"},
           {"new", "bowl", "--rim", "0.1mm"},
           {"new", "box", "--size", "60x40x20mm", "--tolerance", "0.00001mm"},
           {"new", "sphere", "--material", "cheese"},
           {"new", "sphere", "--material", "silicone"}}) {
    const Outcome outcome = out(arguments);
    EXPECT_EQ(outcome.code, exit_failed) << outcome.err;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"new"},
                                             {"new", "dodecahedron"},
                                             {"new", "sphere", "--radius", "40"},
                                             {"new", "sphere", "--radius", "nan mm"},
                                             {"new", "sphere", "--radius", "1e400mm"},
                                             {"new", "box", "--size", "60x40mm"},
                                             {"new", "box", "--size", "60x40x20x10mm"},
                                             {"new", "box"},
                                             {"new", "sphere", "--control", "3x3"},
                                             {"new", "sphere", "--control", "16"},
                                             {"new", "sphere", "--control", "999x16"}}) {
    const Outcome outcome = out(arguments);
    EXPECT_EQ(outcome.code, exit_wrong_use) << outcome.err;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
  EXPECT_EQ(content_of(place.path("old.json")), "precious");
}

// Both names of the inch are accepted, also in a list with a unit only after its last length.
TEST(New, TakesInchesByBothNames) {
  const Workplace place;
  for (const char* size : {"2inchx40x20mm", "2inx40x20mm", "50.8x40x20mm", "50.8mmx40x20mm"}) {
    const Outcome outcome = run({"new", "box", "--size", size, "--out", place.text("box.json"), "--json"});
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    EXPECT_NEAR(json_of(outcome.out)["size_mm"][0], 50.8, 0.03) << size;  // each face is accurate to 0.01 mm
  }
}

TEST(New, StopsWhenAskedTo) {
  const Workplace place;
  place.write("old.json", "precious");
  sigset_t interrupt, before;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  pthread_sigmask(SIG_BLOCK, &interrupt, &before);
  raise(SIGINT);
  const Outcome outcome = run({"new", "sphere", "--out", place.text("old.json")});
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_EQ(outcome.err, "spoonbill: stopped; " + place.text("old.json") + " was not written\n");
  EXPECT_EQ(content_of(place.path("old.json")), "precious");
}

// Stock shapes cannot intersect themselves, so the command does not search for intersections. For thin and
// wide shapes, such a search would take minutes.
TEST(New, MakesWideThinLumpsAtOnce) {
  const Workplace place;
  for (const std::vector<std::string>& lump :
       std::vector<std::vector<std::string>>{{"torus", "--ring", "10m", "--tube", "0.1mm"},
                                             {"cone", "--radius", "1m", "--height", "1mm"},
                                             {"cylinder", "--radius", "5m", "--height", "0.1mm"},
                                             {"plate", "--size", "1000x10mm", "--thickness", "2mm"}}) {
    const Outcome outcome = run(with({"new"}, with(lump, {"--out", place.text("lump.json"), "--json"})));
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    EXPECT_LE(json_of(outcome.out)["deviation_m"], 1e-5);
  }
}

TEST(New, SaysSizesAsTheyWereGiven) {
  const Workplace place;
  const auto told = [&](const std::vector<std::string>& more) {
    return run(with({"new"}, with(more, {"--out", place.text("none.json")}))).err;
  };
  EXPECT_NE(told({"box", "--size", "60x40x20mm", "--rounding", "9mm"})
                .find("rounding is 9 mm, must be from 0.2 mm"),
            std::string::npos);
  EXPECT_NE(told({"plate", "--size", "60x40mm", "--sheet", "--thickness", "0"}).find("0.01 mm to 100 mm"),
            std::string::npos);
}

TEST(New, OptionsThatContradictEachOtherAreWrongUse) {
  const Workplace place;
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"plate", "--size", "100x60mm", "--sheet", "--corner", "9mm"},
           {"tube", "--path", "0,0,0;60,0,0mm", "--radius", "5mm", "--width", "3mm", "--height", "4mm"},
           {"tube", "--path", "0,0,0;60,0,0mm", "--width", "3mm"},
           {"tube", "--path", "0,0,0;60,0,0mm", "--height", "3mm"},
           {"loft", "--sections", "a.csv", "--cap", "5mm", "--no-caps"},
           {"loft", "--sections", "a.csv", "--cap", "5mm", "--open"},
           {"loft", "--sections", "a.csv", "--no-caps", "--open"}}) {
    const Outcome outcome = run(with({"new"}, with(arguments, {"--out", place.text("none.json")})));
    EXPECT_EQ(outcome.code, exit_wrong_use) << outcome.err;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
}

TEST(New, HelpNamesSizesOfEachKind) {
  EXPECT_NE(run({"new", "--help"}).out.find("torus"), std::string::npos);
  EXPECT_NE(run({"new", "box", "--help"}).out.find("--rounding"), std::string::npos);
}

}  // namespace
}  // namespace spoonbill
