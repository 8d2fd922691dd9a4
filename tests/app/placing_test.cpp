// Tests the changes of a body's place and size, and bringing parts together before they are merged.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "app/program.h"
#include "app/report/document_facts.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/document.h"
#include "engine/inspection/mass_properties.h"
#include "engine/scene/place_body.h"
#include "tests/app/spoon_parts.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

// Rounding of coordinates in documents, of numbers of up to 0.1 m.
constexpr double rounding = 1e-12;

class Placing : public testing::Test {
 protected:
  // Changes a model and reads the result.
  Document change(const std::string& model, const std::vector<std::string>& words,
                  const std::string& out = "out.json") {
    std::vector<std::string> arguments{"change", model};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--out", place_.text(out), "--force"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    auto document = read_document(place_.path(out));
    return outcome.code == exit_done ? std::move(document).value() : Document();
  }

  // Expects that every sampled point of `before` was mapped.
  template <class Map>
  static void expect_mapped(const Surface& before, const Surface& after, const Map& map) {
    for (const double u : uniform_parameters(before.u, 17)) {
      for (const double v : uniform_parameters(before.v, 23)) {
        EXPECT_LT((position(after, u, v) - map(position(before, u, v))).norm(), rounding);
      }
    }
  }

  Workplace place_;
};

TEST_F(Placing, MovesTheBodyWithItsPlanes) {
  Document document = read_document(handle).value();
  document.scene.planes = {{Vector3(0.04, 0, 0), Vector3::UnitX()}};
  ASSERT_TRUE(write_document(document, place_.path("held.json")));
  const Document moved = change(place_.text("held.json"), {"move", "10mm,0,2cm"});
  const Vector3 by_m(0.01, 0.0, 0.02);
  expect_mapped(document.scene.bodies[0].surface, moved.scene.bodies[0].surface,
                [&](const Vector3& point) -> Vector3 { return point + by_m; });
  EXPECT_LT((moved.scene.planes[0].point_m - Vector3(0.05, 0, 0.02)).norm(), rounding);
}

TEST_F(Placing, TurnsAboutTheCentreOrAPoint) {
  const Surface before = surface_of(handle);
  const Vector3 centre_m = compute_enclosed_mass(before).centre_m;
  const Quaternion turn(Eigen::AngleAxisd(30.0 * std::numbers::pi / 180.0, Vector3::UnitY()));
  expect_mapped(before, change(handle, {"rotate", "y", "30deg"}).scene.bodies[0].surface,
                [&](const Vector3& point) -> Vector3 { return centre_m + turn * (point - centre_m); });
  const Vector3 about_m(0.1, 0.0, 0.0);
  expect_mapped(before,
                change(handle, {"rotate", "0,2,0", "30deg", "--about", "100mm,0,0"}).scene.bodies[0].surface,
                [&](const Vector3& point) -> Vector3 { return about_m + turn * (point - about_m); });
}

TEST_F(Placing, Scales) {
  const Surface before = surface_of(handle);
  const EnclosedMass mass = compute_enclosed_mass(before);
  const EnclosedMass twice = compute_enclosed_mass(change(handle, {"scale", "2"}).scene.bodies[0].surface);
  EXPECT_NEAR(twice.volume_m3, 8.0 * mass.volume_m3, 1e-9 * mass.volume_m3);
  EXPECT_LT((twice.centre_m - mass.centre_m).norm(), 1e-9);
  const Document wider = change(handle, {"scale", "1,1.5,3", "--about", "0,0,0"});
  expect_mapped(before, wider.scene.bodies[0].surface,
                [](const Vector3& point) -> Vector3 { return point.cwiseProduct(Vector3(1.0, 1.5, 3.0)); });
}

TEST_F(Placing, ScalesAThicknessAndDepths) {
  Document document = read_document(SPOONBILL_ASSETS "/models/trimmed-plate.json").value();
  Body& plate = document.scene.bodies[0];
  ASSERT_TRUE(plate.shell_thickness_m.has_value());
  plate.loads = {PressureLoad{{.depth_m = {0.0, 0.0005}}, 10.0}};
  ASSERT_TRUE(write_document(document, place_.path("plate.json")));
  const Body scaled = change(place_.text("plate.json"), {"scale", "3"}).scene.bodies[0];
  EXPECT_NEAR(*scaled.shell_thickness_m, 3.0 * *plate.shell_thickness_m, rounding);
  EXPECT_NEAR(std::get<PressureLoad>(scaled.loads[0]).region.depth_m.high, 0.0015, rounding);
  EXPECT_EQ(std::get<PressureLoad>(scaled.loads[0]).pressure_pa, 10.0);
  EXPECT_EQ(scaled.trims.size(), plate.trims.size());
}

// The centre of an open or trimmed surface is that of its area, wherever the surface is.
TEST_F(Placing, TurnsAnOpenSurfaceAboutTheCentreOfItsArea) {
  const std::string plate = SPOONBILL_ASSETS "/models/trimmed-plate.json";
  const auto centre_of = [](const Document& document) {
    const Body& body = document.scene.bodies[0];
    return compute_enclosed_mass(body.surface, *make_trimmed_area(body).value()).area_centre_m;
  };
  const Vector3 before_m = centre_of(read_document(plate).value());
  EXPECT_LT((centre_of(change(plate, {"mirror", "z"})) - before_m).norm(), 1e-9);
  change(plate, {"rotate", "1,2,3", "40deg"}, "once.json");
  EXPECT_LT((centre_of(change(place_.text("once.json"), {"rotate", "x", "20deg"})) - before_m).norm(), 1e-9);
}

// A mirrored body stays outside in: its normals point outward, and what is given by parameters is at the
// mirrored places.
TEST_F(Placing, MirrorsWithRimAndNormals) {
  const Body before = read_document(bowl).value().scene.bodies[0];
  const Body after = change(bowl, {"mirror", "x", "--about", "0,0,0"}).scene.bodies[0];
  const EnclosedMass mass = compute_enclosed_mass(before.surface),
                     mirrored = compute_enclosed_mass(after.surface);
  const Vector3 flip(-1.0, 1.0, 1.0);
  EXPECT_NEAR(mirrored.volume_m3, mass.volume_m3, 1e-9 * mass.volume_m3);
  EXPECT_LT((mirrored.centre_m - flip.cwiseProduct(mass.centre_m)).norm(), 1e-9);
  ASSERT_EQ(after.rim.size(), before.rim.size());
  for (std::size_t c = 0; c < before.rim.size(); ++c) {
    const Vector3 corner_m = position(before.surface, before.rim[c].x(), before.rim[c].y());
    EXPECT_LT(
        (position(after.surface, after.rim[c].x(), after.rim[c].y()) - flip.cwiseProduct(corner_m)).norm(),
        1e-9);
  }
  const Document twice = change(place_.text("out.json"), {"mirror", "x", "--about", "0,0,0"}, "twice.json");
  expect_mapped(before.surface, twice.scene.bodies[0].surface, [](const Vector3& point) { return point; });
}

TEST_F(Placing, MirrorsLoadsSupportsAndRegions) {
  Document document = read_document(SPOONBILL_ASSETS "/models/loaded-handle.json").value();
  Body& before = document.scene.bodies[0];
  const PointLoad point{before.surface.u.parameter_at(0.3), before.surface.v.parameter_at(0.4),
                        Vector3(0.1, 0.2, 0.3)};
  before.loads = {ForceLoad{{}, Vector3(1.0, 2.0, 3.0)}, point};
  Support support{{.along = {0.8, 1.0}, .around = {0.0, 0.25}}};
  support.motion = SupportMotion{.displacement_m = Vector3(0.0, 0.001, 0.002)};
  before.supports = {support, Support{{.along = {0.0, 0.1}, .around = {0.75, 0.25}}}};
  ASSERT_TRUE(write_document(document, place_.path("loaded.json")));
  const Body after = change(place_.text("loaded.json"), {"mirror", "y", "--about", "0,0,0"}).scene.bodies[0];
  const Vector3 flip(1.0, -1.0, 1.0);
  EXPECT_LT((std::get<ForceLoad>(after.loads[0]).force_n - Vector3(1.0, -2.0, 3.0)).norm(), rounding);
  const auto& mirrored = std::get<PointLoad>(after.loads[1]);
  EXPECT_LT((mirrored.force_n - flip.cwiseProduct(point.force_n)).norm(), rounding);
  EXPECT_LT((position(after.surface, mirrored.u, mirrored.v) -
             flip.cwiseProduct(position(before.surface, point.u, point.v)))
                .norm(),
            1e-9);
  EXPECT_LT((after.supports[0].motion->displacement_m - Vector3(0.0, -0.001, 0.002)).norm(), rounding);
  EXPECT_EQ(after.supports[0].region.along.low, 0.8);
  // The seam, where a turn begins and ends, belongs to the range as before.
  EXPECT_EQ(after.supports[0].region.around.low, 0.75);
  EXPECT_EQ(after.supports[0].region.around.high, 0.0);
  EXPECT_EQ(after.supports[1].region.around.low, 0.75);
  EXPECT_EQ(after.supports[1].region.around.high, 0.25);
}

// A trial turns the mirrored body as the mirror image of what it was, and planes go along.
TEST_F(Placing, TakesPlanesSymmetryAndTrialAlong) {
  Document document = read_document(handle).value();
  document.scene.bodies[0].kind = BodyKind::fixed;
  document.scene.planes = {{Vector3(0.04, 0.01, 0.0), Vector3(1.0, 1.0, 0.0).normalized()}};
  document.scene.symmetry = {true, Vector3(0.05, 0.0, 0.0), Vector3::UnitX()};
  TrialPlan trial;
  trial.turned_body = "handle";
  trial.point_m = Vector3(0.02, 0.0, 0.0);
  trial.axis = Vector3::UnitZ();
  trial.angle_deg = 30.0;
  document.scene.trial = trial;
  ASSERT_TRUE(write_document(document, place_.path("all.json")));
  const Scene mirrored = change(place_.text("all.json"), {"mirror", "x", "--about", "0,0,0"}).scene;
  EXPECT_LT((mirrored.planes[0].point_m - Vector3(-0.04, 0.01, 0.0)).norm(), rounding);
  EXPECT_LT((mirrored.planes[0].normal - Vector3(-1.0, 1.0, 0.0).normalized()).norm(), rounding);
  EXPECT_LT((mirrored.symmetry.point_m - Vector3(-0.05, 0.0, 0.0)).norm(), rounding);
  EXPECT_LT((mirrored.trial->axis + Vector3::UnitZ()).norm(), rounding);
  const Scene scaled = change(place_.text("all.json"), {"scale", "1,3,1", "--about", "0,0,0"}).scene;
  // A point of the plane stays in it: along (1, -1, 0) becomes along (1, -3, 0).
  EXPECT_NEAR(scaled.planes[0].normal.dot(Vector3(1.0, -3.0, 0.0)), 0.0, rounding);
  EXPECT_LT((scaled.planes[0].point_m - Vector3(0.04, 0.03, 0.0)).norm(), rounding);

  // Beside another body, they stay.
  document.scene.bodies.push_back(document.scene.bodies[0]);
  document.scene.bodies[1].name = "other";
  ASSERT_TRUE(write_document(document, place_.path("two.json")));
  const Scene one_moved = change(place_.text("two.json"), {"move", "0,1m,0", "--body", "2"}).scene;
  EXPECT_LT((one_moved.planes[0].point_m - document.scene.planes[0].point_m).norm(), rounding);
  EXPECT_LT(
      (one_moved.bodies[0].surface.net.point(3, 5) - document.scene.bodies[0].surface.net.point(3, 5)).norm(),
      rounding);
}

// The faces of a solid stay together.
TEST_F(Placing, MovesAllFacesOfASolid) {
  Document document = read_document(handle).value();
  document.scene.bodies.push_back(document.scene.bodies[0]);
  for (std::size_t b = 0; b < 2; ++b) {
    document.scene.bodies[b].name = "face " + std::to_string(b);
    document.scene.bodies[b].solid = "solid";
  }
  move_body({Vector3(0.0, 0.02, 0.0), Quaternion::Identity()}, document.scene.bodies[1]);
  ASSERT_TRUE(write_document(document, place_.path("solid.json")));
  const Scene turned = change(place_.text("solid.json"), {"rotate", "x", "180deg"}).scene;
  for (std::size_t b = 0; b < 2; ++b) {
    // The centre of both is in the middle between them, so that they change places.
    expect_mapped(
        document.scene.bodies[b].surface, turned.bodies[b].surface,
        [](const Vector3& point) -> Vector3 { return Vector3(point.x(), 0.02 - point.y(), -point.z()); });
  }
}

TEST_F(Placing, AlignsASideOrTheLength) {
  change(handle, {"rotate", "1,2,3", "70deg"}, "turned.json");
  const std::string turned = place_.text("turned.json");
  const auto extent = [](const Document& document) { return extent_of(document.scene.bodies[0].surface); };
  ASSERT_EQ(run({"new", "sphere", "--radius", "20mm", "--out", place_.text("ball.json")}).code, exit_done);
  change(place_.text("ball.json"), {"move", "3mm,7mm,-9mm"}, "moved.json");
  const auto centre_of_ball = [&](const std::vector<std::string>& words) {
    return compute_enclosed_mass(change(place_.text("moved.json"), words).scene.bodies[0].surface).centre_m;
  };
  constexpr double fit_m = 1e-5;  // the ball is fitted within 0.01 mm
  EXPECT_LT((centre_of_ball({"align", "y", "low", "0"}) - Vector3(0.003, 0.02, -0.009)).norm(), fit_m);
  EXPECT_LT((centre_of_ball({"align", "z", "high", "-5mm"}) - Vector3(0.003, 0.007, -0.025)).norm(), fit_m);
  EXPECT_LT((centre_of_ball({"align", "x", "centre", "2cm"}) - Vector3(0.02, 0.007, -0.009)).norm(), fit_m);
  const Vector3 slanted = Vector3(1.0, 1.0, 0.0).normalized();
  EXPECT_NEAR(centre_of_ball({"align", "1,1,0", "low", "0"}).dot(slanted), 0.02, fit_m);
  const Box along = extent(change(turned, {"align", "length", "z"}));
  EXPECT_NEAR(along.high.z() - along.low.z(), 0.1, 1e-4);
}

TEST_F(Placing, RefusesWrongWords) {
  const std::vector<std::vector<std::string>> wrong{{"move", "10,0,0"},
                                                    {"move", "10mm,0"},
                                                    {"rotate", "y"},
                                                    {"rotate", "y", "30"},
                                                    {"rotate", "0,0,0", "1deg"},
                                                    {"scale", "0"},
                                                    {"scale", "-1"},
                                                    {"scale", "1,2"},
                                                    {"mirror", "w"},
                                                    {"align", "y", "low"},
                                                    {"align", "length"},
                                                    {"align", "y", "top", "0"},
                                                    {"split", "v=50", "--about", "0,0,0"},
                                                    {"move", "200m,0,0"},
                                                    {"move", "1mm,0,0", "--about", "0,0,0"}};
  for (const auto& words : wrong) {
    std::vector<std::string> arguments{"change", handle};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--out", place_.text("wrong.json")});
    EXPECT_EQ(run(arguments).code, exit_wrong_use) << words[0];
  }
  EXPECT_FALSE(std::filesystem::exists(place_.path("wrong.json")));
  // A sphere has no longest direction, and a body must stay within 100 m.
  ASSERT_EQ(run({"new", "sphere", "--radius", "20mm", "--out", place_.text("ball.json")}).code, exit_done);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"align", "length", "x"}, {"move", "100m,0,0"}}) {
    std::vector<std::string> arguments{"change", place_.text("ball.json")};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--out", place_.text("wrong.json")});
    EXPECT_EQ(run(arguments).code, exit_failed) << words[0];
  }
}

// Halves of a handle that were moved apart and turned become the whole handle again.
TEST_F(Placing, BringsHalvesTogether) {
  ASSERT_EQ(run({"change", handle, "split", "v=50", "--out", place_.text("halves.json")}).code, exit_done);
  Document halves = read_document(place_.path("halves.json")).value();
  Document one = halves, other = halves;
  one.scene.bodies = {halves.scene.bodies[0]};
  other.scene.bodies = {halves.scene.bodies[1]};
  ASSERT_TRUE(write_document(one, place_.path("one.json")));
  ASSERT_TRUE(write_document(other, place_.path("other.json")));
  change(place_.text("other.json"), {"rotate", "1,-2,1", "50deg"}, "turned.json");
  change(place_.text("turned.json"), {"move", "20mm,30mm,-5mm"}, "away.json");
  const std::vector<std::string> merge{"merge",
                                       place_.text("one.json"),
                                       place_.text("away.json"),
                                       "--edges",
                                       "1.v_end:2.v_start",
                                       "--out",
                                       place_.text("whole.json"),
                                       "--json"};
  std::vector<std::string> bring = merge;
  bring.emplace_back("--bring");
  const Outcome outcome = run(bring);
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json moved = json_of(outcome.out)["moved"];
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0]["patch"], 2);
  EXPECT_NEAR(moved[0]["turned_deg"].get<double>(), 50.0, 0.01);
  const Surface whole = surface_of(place_.path("whole.json")), before = surface_of(handle);
  for (const double u : uniform_parameters(before.u, 16)) {
    for (double v = 0.0; v <= 100.0; v += 1.7) {
      EXPECT_LT((position(whole, u, v) - position(before, u, v)).norm(), 2e-5);
    }
  }
}

// A bowl that lies somewhere is brought to the handle as the bowl at the handle would be.
TEST_F(Placing, BringsABowlFromAnywhere) {
  const auto brought = [&](const std::string& model) {
    const Outcome outcome = run({"merge", handle, model, "--edges", "1.v_end:2.v_start", "--bring", "--out",
                                 place_.text("spoon.json"), "--force", "--json"});
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return surface_of(place_.path("spoon.json"));
  };
  const Surface expected = brought(bowl);
  change(bowl, {"rotate", "0,1,0.3", "40deg"}, "turned.json");
  change(place_.text("turned.json"), {"move", "0,50mm,20mm"}, "away.json");
  const Surface spoon = brought(place_.text("away.json"));
  ASSERT_EQ(spoon.net.size(), expected.net.size());
  EXPECT_GT(compute_enclosed_mass(spoon).volume_m3, 0.0);
  const EnclosedMass mass = compute_enclosed_mass(spoon), expected_mass = compute_enclosed_mass(expected);
  EXPECT_NEAR(mass.volume_m3, expected_mass.volume_m3, 1e-3 * expected_mass.volume_m3);
  EXPECT_LT((mass.centre_m - expected_mass.centre_m).norm(), 2e-4);
}

// Chosen edges that do not exist, and parts that no chosen edges connect, are refused.
TEST_F(Placing, RefusesToBringByWrongEdges) {
  const std::vector<std::string> merge{
      "merge", handle, bowl, handle, "--bring", "--out", place_.text("x.json"), "--edges"};
  for (const std::vector<std::string>& edges : {std::vector<std::string>{"0.v_end:2.v_start"},
                                                {"1.v_end:9.v_start"},
                                                {"1.u_end:2.v_start"},
                                                {"1.v_end:2.v_start"},
                                                {"2.v_end:3.v_start"}}) {
    std::vector<std::string> arguments = merge;
    arguments.insert(arguments.end(), edges.begin(), edges.end());
    EXPECT_NE(run(arguments).code, exit_done) << edges[0];
  }
  EXPECT_FALSE(std::filesystem::exists(place_.path("x.json")));
}

// The pairs may name the parts in any order.
TEST_F(Placing, BringsPartsInTheOrderOfThePairs) {
  const Outcome outcome = run({"merge", handle, handle, bowl, "--bring", "--edges", "1.v_end:3.v_start",
                               "3.v_end:2.v_start", "--out", place_.text("three.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json moved = json_of(outcome.out)["moved"];
  ASSERT_EQ(moved.size(), 2u);
  EXPECT_EQ(moved[0]["patch"], 3);
  EXPECT_EQ(moved[1]["patch"], 2);
}

// Two sheets meet edge to edge, with their normals on one side.
TEST_F(Placing, BringsSheetsEdgeToEdge) {
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(run({"new", "plate", "--size", "60x40mm", "--thickness", "1mm", "--sheet", "--out",
                   place_.text(std::string(name) + ".json")})
                  .code,
              exit_done);
  }
  change(place_.text("b.json"), {"rotate", "1,0,2", "65deg"}, "turned.json");
  change(place_.text("turned.json"), {"move", "0,0,1m"}, "away.json");
  const Outcome outcome = run({"merge", place_.text("a.json"), place_.text("away.json"), "--edges",
                               "1.u_end:2.u_start", "--bring", "--out", place_.text("long.json")});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Box box = extent_of(surface_of(place_.path("long.json")));
  EXPECT_NEAR(box.high.x() - box.low.x(), 0.12, 1e-6);
  EXPECT_NEAR(box.high.y() - box.low.y(), 0.0, 1e-6);
  EXPECT_NEAR(box.high.z() - box.low.z(), 0.04, 1e-6);
  // Sheets have several edges, so that one has to be chosen.
  EXPECT_EQ(run({"merge", place_.text("a.json"), place_.text("away.json"), "--bring", "--out",
                 place_.text("none.json")})
                .code,
            exit_failed);
}

}  // namespace
}  // namespace spoonbill
