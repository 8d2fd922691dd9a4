// Tests the check command.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <numbers>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

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

// A straight tube is curved in one direction only, apart from rounding errors.
TEST(Check, AStraightTubeHasNoHollowRadius) {
  const Workplace place;
  place.write("profile.csv", "radius_mm,height_mm\n10,0\n10,20\n10,40\n");
  made(place, {"new", "lathe", "--profile", place.text("profile.csv")});
  const Json body = check_of(place, "made.json")["bodies"][0];
  EXPECT_NEAR(body["smallest_convex_radius_m"], 0.01, 5e-4);
  EXPECT_TRUE(body["smallest_concave_radius_m"].is_null()) << body["smallest_concave_radius_m"];
}

// If a pole was computed in single precision, its control points are about 10 nm apart.
TEST(Check, AnEdgeOfAMillionthIsAPoint) {
  const Workplace place;
  Document ball = made(place, {"new", "sphere", "--radius", "20mm"});
  const Json exact = check_of(place, "made.json")["bodies"][0];
  ControlNet& net = ball.scene.bodies[0].surface.net;
  for (int i = 0; i < net.rows; ++i) {
    const Vector3 apart(1e-8 * std::sin(2.0 * i), 0.0, 1e-8 * std::cos(3.0 * i));
    net.set_point(i, 0, net.point(i, 0) + apart);
    net.set_point(i, net.columns - 1, net.point(i, net.columns - 1) - apart);
  }
  save(place, "apart.json", ball);
  const Json facts = check_of(place, "apart.json")["bodies"][0];
  EXPECT_EQ(facts["sound"], true) << facts["problems"];
  for (const char* field : {"smallest_convex_radius_m", "smallest_thickness_m", "bending"}) {
    EXPECT_NEAR(facts[field].get<double>() / exact[field].get<double>(), 1.0, 1e-3) << field;
  }
}

// The poles of this bent handle were fitted in single precision, so their points are about 10 nm apart. The
// expected thickness is that of the bent part, measured on a fine triangulation.
TEST(Check, ABentHandleIsNotThinAtItsPoles) {
  const Outcome outcome = run({"check", SPOONBILL_TEST_INPUTS "/bent-handle.json", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json body = json_of(outcome.out)["bodies"][0];
  EXPECT_EQ(body["sound"], true);
  EXPECT_NEAR(body["smallest_thickness_m"], 0.0045, 1e-4);
  EXPECT_GT(body["smallest_convex_radius_m"], 0.0005);
}

bool has_null(const Json& json) {
  if (!json.is_structured()) return json.is_null();
  return std::any_of(json.begin(), json.end(), [](const Json& part) { return has_null(part); });
}

// The body is collapsed to a point, and then to a line.
TEST(Check, ACollapsedBodyHasNoCurvature) {
  const Workplace place;
  const Document ball = made(place, {"new", "sphere", "--radius", "20mm"});
  for (const double height : {0.0, 1.0}) {
    Document flat = ball;
    ControlNet& net = flat.scene.bodies[0].surface.net;
    for (int i = 0; i < net.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        net.set_point(i, j, Vector3(0.01, 0.02 + height * net.point(i, j).y(), 0.03));
      }
    }
    save(place, "flat.json", flat);
    Json facts = check_of(place, "flat.json");
    EXPECT_EQ(facts["sound"], false);
    Json& body = facts["bodies"][0];
    EXPECT_FALSE(body.contains("curvature"));
    EXPECT_FALSE(body["problems"].empty());
    EXPECT_LT(body["area_m2"].get<double>(), 1e-12);
    EXPECT_LT(body["bending"].get<double>(), 1e3);
    body.erase("solid");
    body.erase("smallest_thickness_m");
    EXPECT_FALSE(has_null(facts)) << facts;
  }
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

// The hole removes an eighth of the area.
TEST(Check, TakesTrimsIntoAccount) {
  const Workplace place;
  Document document = made(place, {"new", "plate", "--size", "100x60mm", "--sheet"});
  Body& body = document.scene.bodies[0];
  const std::vector<Eigen::Vector2d> hole{{0.25, 0.25}, {0.25, 0.75}, {0.5, 0.75}, {0.5, 0.25}};
  body.trims = {make_polygon_loop(body.surface.u, body.surface.v, hole).value()};
  save(place, "trimmed.json", document);
  const Json facts = check_of(place, "trimmed.json")["bodies"][0];
  EXPECT_EQ(facts["sound"], true);
  EXPECT_EQ(facts["trim_loops"], 1);
  EXPECT_NEAR(facts["area_m2"], 0.875 * 0.006, 1e-9);
  EXPECT_NEAR(facts["volume_m3"], 0.875 * 0.006 * 0.003, 1e-12);
  EXPECT_NEAR(facts["mass_kg"], 1700.0 * 0.875 * 0.006 * 0.003, 1e-9);
  EXPECT_NE(run({"check", place.text("trimmed.json")}).out.find("trimmed by 1 loop"), std::string::npos);
  // A closed surface with a hole encloses nothing.
  Document ball = made(place, {"new", "sphere"});
  Body& cut = ball.scene.bodies[0];
  cut.trims = {make_polygon_loop(cut.surface.u, cut.surface.v, hole).value()};
  save(place, "cut.json", ball);
  const Json open = check_of(place, "cut.json")["bodies"][0];
  EXPECT_EQ(open["sound"], false);
  EXPECT_FALSE(open.contains("volume_m3"));
}

// The lower half of the cylinder has half the density.
TEST(Check, WeighsRegionsByWhatTheyAreMadeOf) {
  const Workplace place;
  Document document = made(place, {"new", "cylinder"});
  save(place, "plain.json", document);
  Body& body = document.scene.bodies[0];
  MaterialRegion lower;
  lower.region.along = {0.0, 0.5};
  lower.material = body.material;
  lower.material->name = "light";
  lower.material->density_kg_per_m3 *= 0.5;
  body.regions = {lower};
  save(place, "grip.json", document);
  const Json plain = check_of(place, "plain.json")["bodies"][0],
             grip = check_of(place, "grip.json")["bodies"][0];
  // A cell has a single material. This shifts the boundary between the materials by at most half the height
  // of a layer of cells. There are ten or more layers.
  EXPECT_NEAR(grip["mass_kg"].get<double>() / plain["mass_kg"].get<double>(), 0.75, 0.03);
  EXPECT_EQ(grip["materials"], Json::array({"modelling-clay", "light"}));
  EXPECT_GT(grip["centre_of_mass_m"][1], 0.003);
}

TEST(Check, StopsWhenAskedTo) {
  const Workplace place;
  made(place, {"new", "sphere"});
  sigset_t interrupt, before;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  pthread_sigmask(SIG_BLOCK, &interrupt, &before);
  raise(SIGINT);
  const Outcome outcome = run({"check", place.text("made.json")});
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("stopped"), std::string::npos) << outcome.err;
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

TEST(Check, TellsWhichBodiesAreInEachOther) {
  const Workplace place;
  Document three = made(place, {"new", "sphere"});
  EXPECT_FALSE(check_of(place, "made.json").contains("meetings"));
  const double size = check_of(place, "made.json")["bodies"][0]["smallest_thickness_m"];
  std::vector<Body>& bodies = three.scene.bodies;
  bodies.resize(3, bodies[0]);
  for (int b = 0; b < 3; ++b) {
    bodies[static_cast<std::size_t>(b)].name = std::string(1, static_cast<char>('a' + b));
    // The second ball overlaps the first by a tenth of the diameter. The third ball is a tenth of the
    // diameter away from the second.
    for (double& x : bodies[static_cast<std::size_t>(b)].surface.net.x)
      x += std::array{0.0, 0.9, 2.0}[b] * size;
  }
  save(place, "three.json", three);
  const Json facts = check_of(place, "three.json");
  EXPECT_EQ(facts["sound"], true);
  EXPECT_EQ(facts["meetings_complete"], true);
  ASSERT_EQ(facts["meetings"].size(), 1U);
  const Json& meeting = facts["meetings"][0];
  EXPECT_EQ(meeting["a"], "a");
  EXPECT_EQ(meeting["b"], "b");
  EXPECT_EQ(meeting["contained"], false);
  EXPECT_NEAR(meeting["depth_m"].get<double>() / size, 0.1, 2e-3);
  EXPECT_NE(run({"check", place.text("three.json")}).out.find("a and b, "), std::string::npos);

  for (double& x : bodies[2].surface.net.x) x = 0.4 * (x - 2.0 * size) + 0.2 * size;
  for (double& y : bodies[2].surface.net.y) y *= 0.4;
  for (double& z : bodies[2].surface.net.z) z *= 0.4;
  bodies.erase(bodies.begin() + 1);
  save(place, "inside.json", three);
  const Json inside = check_of(place, "inside.json")["meetings"];
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_EQ(inside[0]["contained"], true);
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
