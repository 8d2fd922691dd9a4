// Tests the changes of a body's place and size, and bringing parts together before they are merged.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "app/program.h"
#include "app/report/document_facts.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/document.h"
#include "engine/inspection/mass_properties.h"
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

TEST_F(Placing, ScalesAThicknessAndDepthsAlong) {
  Document document = read_document(SPOONBILL_ASSETS "/models/trimmed-plate.json").value();
  Body& plate = document.scene.bodies[0];
  const bool is_shell = plate.shell_thickness_m.has_value();
  ASSERT_TRUE(is_shell);
  const Document scaled = change(SPOONBILL_ASSETS "/models/trimmed-plate.json", {"scale", "3"});
  EXPECT_NEAR(*scaled.scene.bodies[0].shell_thickness_m, 3.0 * *plate.shell_thickness_m, rounding);
  EXPECT_EQ(scaled.scene.bodies[0].trims.size(), plate.trims.size());
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

TEST_F(Placing, MirrorsLoadsAndSupports) {
  const std::string model = SPOONBILL_ASSETS "/models/loaded-handle.json";
  const Body before = read_document(model).value().scene.bodies[0];
  const Body after = change(model, {"mirror", "z"}).scene.bodies[0];
  ASSERT_EQ(after.loads.size(), before.loads.size());
  ASSERT_FALSE(before.loads.empty() && before.supports.empty());
  const Vector3 flip(1.0, 1.0, -1.0);
  const auto force_of = [](const Load& load) {
    if (const auto* const force = std::get_if<ForceLoad>(&load)) return force->force_n;
    if (const auto* const force = std::get_if<PointLoad>(&load)) return force->force_n;
    return Vector3(Vector3::Zero());
  };
  for (std::size_t k = 0; k < before.loads.size(); ++k) {
    EXPECT_LT((force_of(after.loads[k]) - flip.cwiseProduct(force_of(before.loads[k]))).norm(), 1e-12);
    const auto* const point = std::get_if<PointLoad>(&before.loads[k]);
    if (point == nullptr) continue;
    const auto& mirrored = std::get<PointLoad>(after.loads[k]);
    const double middle_z = compute_enclosed_mass(before.surface).centre_m.z();
    Vector3 expected_m = position(before.surface, point->u, point->v);
    expected_m.z() = 2.0 * middle_z - expected_m.z();
    EXPECT_LT((position(after.surface, mirrored.u, mirrored.v) - expected_m).norm(), 1e-9);
  }
}

TEST_F(Placing, AlignsASideOrTheLength) {
  change(handle, {"rotate", "1,2,3", "70deg"}, "turned.json");
  const std::string turned = place_.text("turned.json");
  const auto extent = [](const Document& document) { return extent_of(document.scene.bodies[0].surface); };
  EXPECT_NEAR(extent(change(turned, {"align", "y", "low", "0"})).low.y(), 0.0, 1e-9);
  EXPECT_NEAR(extent(change(turned, {"align", "z", "high", "-5mm"})).high.z(), -0.005, 1e-9);
  const Box centred = extent(change(turned, {"align", "x", "centre", "2cm"}));
  EXPECT_NEAR(0.5 * (centred.low.x() + centred.high.x()), 0.02, 1e-9);
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
                                                    {"move", "200m,0,0"}};
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
  EXPECT_EQ(run(merge).code, exit_failed);  // they are apart
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
