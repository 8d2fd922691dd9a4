// Tests the fit command, from the file of a scan to a document that the program can open.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "app/report/fit_report.h"
#include "engine/exchange/document.h"
#include "tests/app/mesh_texts.h"
#include "tests/app/process.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"
#include "tests/engine/fitting/clouds.h"

namespace spoonbill {
namespace {

class FitTest : public testing::Test {
 protected:
  Outcome fit(const std::string& scan, std::vector<std::string> options = {}) const {
    std::vector<std::string> arguments{"fit", scan, "--out", out()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_process(SPOONBILL_PROGRAM, arguments);
  }
  Json json_of_fit(const std::string& scan, std::vector<std::string> options = {}) const {
    options.push_back("--json");
    const Outcome outcome = fit(scan, std::move(options));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? json_of(outcome.out) : Json::object();
  }
  std::string out() const { return folder_.path() / "out.json"; }
  std::string write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content).string();
  }

  TemporaryFolder folder_;
};

std::string xyz_of(const Scan& scan, double scale) {
  std::string text;
  for (const Vector3& point : scan.points_m) {
    for (int axis = 0; axis < 3; ++axis) text += std::to_string(scale * point[axis]) + " ";
    text += "\n";
  }
  return text;
}

TEST_F(FitTest, CloudBecomesADocumentThatOpens) {
  const std::string scan = write("egg.xyz", xyz_of(ellipsoid_cloud(5000, {0.02, 0.02, 0.03}), 1e3));
  const Json json = json_of_fit(scan, {"--control", "12x14"});
  EXPECT_EQ(json.at("kind"), "closed");
  EXPECT_EQ(json.at("control"), Json::array({12, 14}));
  EXPECT_EQ(json.at("folds"), 0);
  EXPECT_EQ(json.at("unit"), "mm");
  EXPECT_NEAR(json.at("size_mm")[2].get<double>(), 60.0, 0.1);
  EXPECT_LE(json.at("mean_m"), json.at("p95_m"));
  EXPECT_LE(json.at("p95_m"), json.at("max_m"));
  EXPECT_LT(json.at("p95_m").get<double>(), 1e-4);
  EXPECT_EQ(json.at("points_read"), 5000);
  const auto document = read_document(out());
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->scene.bodies[0].material.name, "modelling-clay");
  EXPECT_EQ(document->scene.planes.size(), 1U);  // one fixing plane, as in documents made by `new`
  const Outcome info = run_process(SPOONBILL_PROGRAM, {"info", out(), "--json"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_FALSE(json_of(info.out).at("lattice").is_null()) << info.out;
}

TEST_F(FitTest, MoreIslandsThanAreSculptedTogetherAreKeptAndToldOf) {
  constexpr int balls = 9;
  const Scan ball = ellipsoid_cloud(400, {0.01, 0.01, 0.01});
  std::string text;
  for (int b = 0; b < balls; ++b) {
    Scan moved = ball;
    for (Vector3& point : moved.points_m) point.x() += 0.05 * b;
    text += xyz_of(moved, 1e3);
  }
  const Json json =
      json_of_fit(write("balls.xyz", text), {"--islands", "all", "--control", "8x8", "--kind", "closed"});
  EXPECT_EQ(json.at("bodies").size(), balls);
  EXPECT_NE(json.at("remarks").dump().find("holds 9 bodies, and at most 8 are sculpted together"),
            std::string::npos)
      << json.at("remarks");
  EXPECT_EQ(read_document(out())->scene.bodies.size(), balls);
}

TEST_F(FitTest, SaysWhereTheSurfaceCannotFollow) {
  const Scan waves = random_cloud(4000, 5, [](double s, double t) { return on_waves(s, t, 0.1, 0.02); });
  const std::string scan = write("waves.xyz", xyz_of(waves, 1e3));
  const std::string loose = "farther from the surface than a hundredth of its size";
  EXPECT_NE(json_of_fit(scan, {"--control", "4x4"}).at("remarks").dump().find(loose), std::string::npos);
  EXPECT_EQ(json_of_fit(scan, {"--control", "24x24"}).at("remarks").dump().find(loose), std::string::npos);
}

bool says(const Json& json, const std::string& words) {
  return json.at("remarks").dump().find(words) != std::string::npos;
}

TEST_F(FitTest, SaysWhetherTheToleranceIsHeld) {
  const Scan waves = random_cloud(4000, 5, [](double s, double t) { return on_waves(s, t, 0.1, 0.02); });
  const std::string scan = write("waves.xyz", xyz_of(waves, 1e3));
  const std::string missed = "is not within the tolerance";
  const Json coarse = json_of_fit(scan, {"--control", "6x6", "--tolerance", "0.001mm"});
  EXPECT_EQ(coarse.at("within_tolerance"), false);
  EXPECT_TRUE(says(coarse, missed)) << coarse.at("remarks");
  EXPECT_TRUE(says(coarse, "not 0.001 mm")) << coarse.at("remarks");
  // With this number of control points, the fit is closer to the scan than the tolerance.
  const Json held = json_of_fit(scan, {"--control", "24x24", "--tolerance", "0.2mm"});
  EXPECT_EQ(held.at("within_tolerance"), true);
  EXPECT_FALSE(says(held, missed)) << held.at("remarks");
  const Json none = json_of_fit(scan, {"--control", "6x6"});
  EXPECT_TRUE(none.at("within_tolerance").is_null());
  EXPECT_FALSE(says(none, missed)) << none.at("remarks");
}

// The ball cannot be fitted as a tube; the pipe beside it can.
TEST_F(FitTest, AnIslandThatCannotBeFittedIsLeftOutAndNamed) {
  const std::vector<std::string> as_tubes{"--islands", "all", "--control", "8x8", "--kind", "tube"};
  const Scan ball = ellipsoid_cloud(4000, {0.01, 0.01, 0.01});
  Scan both = random_cloud(4000, 1, [](double s, double t) { return on_cylinder(s, t, 0.01, 0.06); });
  append(both, ball, {0.1, 0.0, 0.0});
  const Json json = json_of_fit(write("both.xyz", xyz_of(both, 1e3)), as_tubes);
  EXPECT_EQ(json.at("bodies").size(), 1U);
  EXPECT_EQ(json.at("kind"), "tube");
  EXPECT_TRUE(says(json, "the island of 20.0 x 20.0 x 20.0 mm about 100.0 mm, ")) << json.at("remarks");
  EXPECT_TRUE(says(json, "was skipped, with 4000 points: a tube needs two open ends")) << json.at("remarks");
  EXPECT_EQ(json.at("points_left_out").at("other_islands"), 4000);

  Scan balls = ball;
  append(balls, ball, {0.1, 0.0, 0.0});
  const Outcome none = fit(write("balls.xyz", xyz_of(balls, 1e3)), as_tubes);
  EXPECT_TRUE(is_clean_failure(none)) << none.err;
  EXPECT_NE(none.err.find("none of its 2 islands can be fitted; the largest: a tube needs"),
            std::string::npos)
      << none.err;
}

TEST(FitFacts, SaysOfFoldsWhichBodyHasThem) {
  ScanFit fit;
  fit.bodies.resize(2);
  fit.bodies[1].folds.samples = 640;
  EXPECT_TRUE(find_fit_shortcomings(fit, 0.0).empty());
  fit.bodies[1].folds.folds = 3;
  const std::vector<std::string> remarks = find_fit_shortcomings(fit, 0.0);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(remarks[0].starts_with("the surface of body 2 folds at 3 of 640 samples")) << remarks[0];
}

// A bridge between two halves of a pipe leaves the outer ends open, so they get caps. Two halves of a ball
// have no other openings, so bridging them closes the body.
TEST_F(FitTest, SaysWhichIslandsBridgingCaps) {
  const auto bridged = [&](const Scan& scan) {
    return json_of_fit(write("islands.xyz", xyz_of(scan, 1e3)),
                       {"--islands", "bridge", "--control", "10x10"});
  };
  const std::string capped = "islands were open at places other than the gaps";
  Scan pipe = random_cloud(6000, 1, [](double s, double t) { return on_cylinder(s, t, 0.01, 0.08); });
  leave_out(pipe, [](const Vector3& point) { return std::abs(point.z() - 0.04) < 0.003; });
  const Json pillow = bridged(pipe);
  EXPECT_EQ(pillow.at("kind"), "closed");
  EXPECT_TRUE(says(pillow, "2 " + capped)) << pillow.at("remarks");
  Scan ball = ellipsoid_cloud(6000, {0.02, 0.02, 0.02});
  leave_out(ball, [](const Vector3& point) { return std::abs(point.z()) < 0.002; });
  const Json whole = bridged(ball);
  EXPECT_FALSE(says(whole, "at the gaps")) << whole.at("remarks");
}

TEST_F(FitTest, FewPointsAreToldHowManyItTakes) {
  for (const int count : {30, 60, 85}) {
    const Outcome outcome = fit(write("few.xyz", xyz_of(ellipsoid_cloud(count, {0.02, 0.02, 0.02}), 1e3)));
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(std::to_string(count) + ", needs at least 90"), std::string::npos)
        << outcome.err;
  }
}

TEST_F(FitTest, SheetBecomesAShellThatOpens) {
  const Scan waves = random_cloud(5000, 3, [](double s, double t) { return on_waves(s, t, 0.1, 0.004); });
  const Json json =
      json_of_fit(write("waves.csv", xyz_of(waves, 1.0)), {"--unit", "m", "--control", "12x12"});
  EXPECT_EQ(json.at("kind"), "sheet");
  EXPECT_NEAR(json.at("size_mm")[0].get<double>(), 100.0, 1.0);
  const Outcome info = run_process(SPOONBILL_PROGRAM, {"info", out(), "--json"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_FALSE(json_of(info.out).at("lattice").is_null()) << info.out;
}

TEST_F(FitTest, MeshIsReadByTheChildAndItsErrorsAreColoured) {
  const std::string scan = write("ball.stl", binary_stl(ball_mesh(24, 48, 20.0)));
  const std::string errors = folder_.path() / "errors.ply";
  const Json json = json_of_fit(scan, {"--control", "12x12", "--errors", errors});
  EXPECT_EQ(json.at("kind"), "closed");
  EXPECT_NEAR(json.at("size_mm")[0].get<double>(), 40.0, 0.1);
  std::ifstream stream(errors, std::ios::binary);
  std::string first;
  std::getline(stream, first);
  EXPECT_EQ(first, "ply");
}

// A mesh of five million points has twice as many triangles.
TEST_F(FitTest, AMeshOfFiveMillionPointsIsFitted) {
  if (!is_long_run()) GTEST_SKIP() << only_in_long;
  const TriangleMesh ball = ball_mesh(1580, 3160, 0.02);
  ASSERT_GT(ball.triangles.size(), 9'900'000U);
  const Json json = json_of_fit(write("ball.ply", binary_ply(ball)), {"--control", "8x8"});
  EXPECT_EQ(json.at("kind"), "closed");
  EXPECT_GT(json.at("points_used"), 4'900'000);
}

TEST_F(FitTest, RefusalsAreOneLineAndKeepTheOldFile) {
  write("out.json", "kept");
  const std::vector<std::pair<std::string, std::string>> bad{
      {"none.ply", ""},
      {"cut.ply",
       "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
       "property float z\nend_header\n1 2 3\n"},
      {"hostile.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4000000000\nDATA binary\n1"},
      {"nan.xyz", "nan nan nan\nnan nan nan\n"},
      {"huge.xyz", xyz_of(ellipsoid_cloud(500, {1e4, 1e4, 1e4}), 1e3)},
      {"few.xyz", "1 2 3\n4 5 6\n"},
      {"scan.doc", "1 2 3\n"}};
  for (const auto& [name, content] : bad) {
    const Outcome outcome = fit(write(name, content));
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_TRUE(is_clean_failure(outcome)) << name << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(name), std::string::npos) << outcome.err;
  }
  std::ifstream stream(out());
  std::string kept;
  std::getline(stream, kept);
  EXPECT_EQ(kept, "kept");
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST_F(FitTest, TheScanIsNeverReplaced) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n0 0 0\n";
  const std::string scan = write("scan.ply", ply);
  EXPECT_EQ(fit(scan, {"--errors", scan}).code, 1);
  EXPECT_EQ(fit(scan, {"--errors", out()}).code, 2);
  EXPECT_EQ(run_process(SPOONBILL_PROGRAM, {"fit", scan, "--out", scan}).code, 2);
  EXPECT_EQ(content_of(scan), ply);
}

TEST_F(FitTest, PointsOnALineAreNoSurface) {
  std::string line, slanted;
  for (int k = 0; k < 400; ++k) {
    line += std::to_string(k) + " 0 0\n";
    slanted += std::to_string(0.1 * k) + " " + std::to_string(0.2 * k) + " " + std::to_string(0.5 * k) + "\n";
  }
  for (const std::string& text : {line, slanted}) {
    const Outcome outcome = fit(write("line.xyz", text));
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find("on one line"), std::string::npos) << outcome.err;
  }
}

std::string sample_scan(const std::string& name) {
  return std::string(SPOONBILL_SCAN_SAMPLES) + "/" + name;
}

// In this file, the copies of a vertex in different triangles differ by up to 0.2 micrometres.
TEST_F(FitTest, VerticesThatDifferByRoundingAreOne) {
  const Json json = json_of_fit(sample_scan("unwelded-hemisphere.stl"));
  EXPECT_EQ(json.at("islands"), 1);
  EXPECT_EQ(json.at("kind"), "sheet");
  EXPECT_EQ(json.at("folds"), 0);
  EXPECT_NEAR(json.at("size_mm")[0].get<double>(), 40.0, 0.1);
  EXPECT_NEAR(json.at("size_mm")[2].get<double>(), 20.0, 0.1);
  EXPECT_EQ(json.at("points_used"), json.at("points_distinct"));
  // The joining distance is a thousandth of the median edge, which is 3.9 mm long.
  EXPECT_NEAR(json.at("joined_within_m").get<double>(), 3.9e-6, 1e-7);
}

// MeshLab writes range maps with an element of camera data before the vertices.
TEST_F(FitTest, AnUnknownElementBeforeTheVerticesIsSkipped) {
  for (const char* name : {"camera-binary.ply", "camera-ascii.ply"}) {
    SCOPED_TRACE(name);
    const Json json = json_of_fit(sample_scan(name), {"--unit", "mm", "--control", "16x16"});
    EXPECT_EQ(json.at("kind"), "sheet");
    EXPECT_EQ(json.at("points_used"), 651);
    EXPECT_EQ(json.at("folds"), 0);
    EXPECT_NEAR(json.at("size_mm")[0].get<double>(), 60.0, 0.1);
    EXPECT_NEAR(json.at("size_mm")[1].get<double>(), 40.0, 0.1);
    EXPECT_LT(json.at("p95_m").get<double>(), 1e-4);
  }
}

// The vertices of neighbouring triangles are farther apart than the joining distance, so the triangles do not
// form a surface.
TEST_F(FitTest, LessThanHalfOfTheScanIsNoFitUnlessIslandsAreChosen) {
  TriangleMesh loose = ball_mesh(12, 24, 20.0);
  const TriangleMesh ball = loose;
  loose.vertices_m.clear();
  Random random(3);
  for (TriangleCorners& corners : loose.triangles) {
    for (std::uint32_t& corner : corners) {
      const auto shift = [&] { return random.uniform(-0.05, 0.05); };
      loose.vertices_m.push_back(ball.vertices_m[corner] + Vector3(shift(), shift(), shift()));
      corner = static_cast<std::uint32_t>(loose.vertices_m.size() - 1);
    }
  }
  const std::string scan = write("loose.stl", binary_stl(loose));
  const Outcome outcome = fit(scan);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(out()));

  // The largest ball has 900 of 2,300 points, which is less than half.
  Scan balls = ellipsoid_cloud(900, {0.02, 0.02, 0.02});
  append(balls, ellipsoid_cloud(700, {0.01, 0.01, 0.01}), {0.1, 0.0, 0.0});
  append(balls, ellipsoid_cloud(700, {0.01, 0.01, 0.01}), {0.2, 0.0, 0.0});
  const std::string three = write("three.xyz", xyz_of(balls, 1e3));
  EXPECT_TRUE(is_clean_failure(fit(three, {"--control", "8x8"})));
  EXPECT_EQ(json_of_fit(three, {"--control", "8x8", "--islands", "largest"}).at("islands"), 3);
}

// Repeated points count once. The largest island has less than half of all points, but more than half of the
// distinct points.
TEST_F(FitTest, TheHalfIsOfDistinctPoints) {
  Scan balls = ellipsoid_cloud(900, {0.02, 0.02, 0.02});
  for (const double x_m : {0.1, 0.1, 0.2, 0.2}) {
    append(balls, ellipsoid_cloud(300, {0.01, 0.01, 0.01}), {x_m, 0.0, 0.0});
  }
  const Json json =
      json_of_fit(write("repeated.xyz", xyz_of(balls, 1e3)), {"--control", "8x8", "--kind", "closed"});
  EXPECT_EQ(json.at("points_distinct"), 1500);
  EXPECT_NEAR(json.at("size_mm")[0].get<double>(), 40.0, 0.2);
}

TEST_F(FitTest, TheToleranceIsThatOfTheWholeScan) {
  const std::string scan = sample_scan("two-balls.xyz");
  const Json json = json_of_fit(scan, {"--tolerance", "1mm"});
  EXPECT_EQ(json.at("within_tolerance"), false);
  EXPECT_NEAR(json.at("left_out_share").get<double>(), 1200.0 / 2700.0, 1e-12);
  EXPECT_LT(json.at("within_tolerance_share").get<double>(), 0.56);
  const Outcome text = fit(scan, {"--tolerance", "1mm"});
  EXPECT_TRUE(text.out.starts_with("Left out ")) << text.out;
  const Json all = json_of_fit(scan, {"--tolerance", "1mm", "--islands", "all"});
  EXPECT_EQ(all.at("within_tolerance"), true);
  EXPECT_EQ(all.at("left_out_share"), 0.0);
}

// An STL file repeats each vertex for every triangle around it.
TEST_F(FitTest, WhatBecameOfThePointsAddsUp) {
  const Json json = json_of_fit(write("ball.stl", binary_stl(ball_mesh(24, 48, 20.0))), {"--control", "8x8"});
  const Json& left = json.at("points_left_out");
  EXPECT_GT(left.at("joined"), 0);
  int sum = json.at("points_used");
  for (const auto& item : left.items()) sum += item.value().get<int>();
  EXPECT_EQ(sum, json.at("points_read"));
}

TEST_F(FitTest, AsksWhetherTheUnitIsAnother) {
  const std::string scan = write("egg.xyz", xyz_of(ellipsoid_cloud(2000, {0.02, 0.02, 0.03}), 1.0));
  const Json in_mm = json_of_fit(scan, {"--control", "8x8"});
  bool asked = false;
  for (const Json& remark : in_mm.at("remarks"))
    asked |= remark.get<std::string>().find("--unit") != std::string::npos;
  EXPECT_TRUE(asked) << in_mm.at("remarks");
  const Json in_metres = json_of_fit(scan, {"--control", "8x8", "--unit", "m"});
  for (const Json& remark : in_metres.at("remarks")) {
    EXPECT_EQ(remark.get<std::string>().find("--unit"), std::string::npos) << remark;
  }
}

TEST_F(FitTest, AScanOfALongNameGivesABodyOfAShorterOne) {
  const std::string scan =
      write(std::string(230, 'n') + ".xyz", xyz_of(ellipsoid_cloud(2000, {0.02, 0.02, 0.03}), 1e3));
  EXPECT_EQ(json_of_fit(scan, {"--control", "8x8"}).at("kind"), "closed");
}

TEST_F(FitTest, WrongUseIsExitTwo) {
  const std::string scan = write("egg.xyz", "1 2 3\n");
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--control", "24"},
                                             {"--control", "2x24"},
                                             {"--kind", "ball"},
                                             {"--kind", "2"},
                                             {"--errors", "errors.txt"},
                                             {"--islands", "some"},
                                             {"--unit", "parsec"},
                                             {"--tolerance", "0.5"}}) {
    const Outcome outcome = fit(scan, options);
    EXPECT_EQ(outcome.code, 2) << options[0] << ' ' << options[1];
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
}

// Tests real scans in the folder that SPOONBILL_SCANS names. Skipped if the variable is not set.
class RealScans : public FitTest {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("SPOONBILL_SCANS");
    if (folder == nullptr) GTEST_SKIP() << "SPOONBILL_SCANS names no folder with scans";
    scans_ = folder;
  }
  // Expects every body to have no folds, and 95 % of its points to be within 1 mm of the surface. Of the
  // points of all bodies together, 95 % must also be within 1 mm of the surface, and within a hundredth of
  // `size_m`, the size of the object.
  void expect_good(const std::string& name, const std::vector<std::string>& options, double size_m,
                   std::size_t bodies) {
    const Json json = json_of_fit((scans_ / name).string(), options);
    ASSERT_TRUE(json.contains("p95_m"));
    EXPECT_EQ(json.at("bodies").size(), bodies) << name;
    EXPECT_EQ(json.at("kind"), "closed") << name;
    EXPECT_LT(json.at("p95_m").get<double>(), 1e-3) << name;
    EXPECT_LT(json.at("p95_m").get<double>(), 0.01 * size_m) << name;
    for (const Json& body : json.at("bodies")) {
      EXPECT_LT(body.at("data_to_surface").at("p95_m").get<double>(), 1e-3) << name;
      EXPECT_EQ(body.at("folds"), 0) << name;
    }
  }

  std::filesystem::path scans_;
};

TEST_F(RealScans, PearIsClosedWithinAMillimetre) {
  expect_good("ycb_016_pear.ply", {}, 0.088, 1);
}

TEST_F(RealScans, BowlWithinAMillimetre) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  expect_good("ycb_024_bowl.ply", {}, 0.16, 1);
}

TEST_F(RealScans, SpoonAsTwoBodiesWithinAMillimetre) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  expect_good("ycb_031_spoon.ply", {"--islands", "all"}, 0.184, 2);
}

// The neck of the spoon is missing in the scan, so handle and bowl are bridged into one closed body.
TEST_F(RealScans, SpoonsHandleAndBowlAreMerged) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  json_of_fit((scans_ / "ycb_031_spoon.ply").string(), {"--islands", "all"});
  const std::string spoon = folder_.path() / "spoon.json";
  const Outcome merged =
      run_process(SPOONBILL_PROGRAM, {"merge", out(), "--continuity", "C2", "--out", spoon, "--json"});
  ASSERT_EQ(merged.code, 0) << merged.err;
  EXPECT_TRUE(json_of(merged.out).at("joints")[0].at("bridged"));
  EXPECT_LT(json_of(merged.out).at("deviation_m"), 5e-5);
  const Json check = json_of(run_process(SPOONBILL_PROGRAM, {"check", spoon, "--json"}).out).at("bodies")[0];
  EXPECT_EQ(check.at("closedness"), "solid");
  EXPECT_TRUE(check.at("sound")) << check.at("problems");
  const Json info = json_of(run_process(SPOONBILL_PROGRAM, {"info", spoon, "--json"}).out);
  EXPECT_FALSE(info.at("lattice").is_null()) << info.at("no_lattice_because");
}

TEST_F(RealScans, SpoonBridgedIsOneBodyWithinAMillimetre) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  expect_good("ycb_031_spoon.ply", {"--islands", "bridge"}, 0.184, 1);
}

// Every fitted scan can be sculpted; bowls with a thin wall get a box of cells.
TEST_F(RealScans, AllHoldALattice) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const auto& [scan, in_box] : {std::pair("ycb_024_bowl.ply", true), {"ycb_016_pear.ply", false}}) {
    json_of_fit((scans_ / scan).string(), {"--control", "24x24"});
    const Json info = json_of(run_process(SPOONBILL_PROGRAM, {"info", out(), "--json"}).out);
    ASSERT_FALSE(info.at("lattice").is_null()) << scan << info.at("no_lattice_because");
    EXPECT_EQ(info.at("remarks").dump().find("a box of cells") != std::string::npos, in_box) << scan;
  }
}

TEST_F(RealScans, DepthCameraBowlWithinAMillimetre) {
  expect_good("blue_bowl.pcd", {}, 0.22, 1);
}

}  // namespace
}  // namespace spoonbill
