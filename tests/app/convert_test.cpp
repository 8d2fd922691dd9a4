// Tests the convert command as a process.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "app/program.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/document.h"
#include "tests/app/process.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

class ConvertTest : public testing::Test {
 protected:
  Outcome convert(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = {"convert"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run_process(SPOONBILL_PROGRAM, all);
  }

  Json convert_for_facts(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = convert(arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out);
  }

  void expect_failure(const std::vector<std::string>& arguments, const std::string& reason,
                      int code = exit_failed) const {
    const Outcome outcome = convert(arguments);
    EXPECT_EQ(outcome.code, code);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  }

  Workplace place_;
  const std::string handle_ = std::string(SPOONBILL_ASSETS) + "/models/spoon-handle.json";
};

std::string two_bodies() {
  Document document = sample_document();
  Body other = document.scene.bodies[0];
  other.name = "other";
  for (double& x : other.surface.net.x) x += 0.1;
  document.scene.bodies.push_back(other);
  return json_to_page(document_to_json(document));
}

double largest_distance_m(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto first = read_document(a), second = read_document(b);
  if (!first || !second) return 1e30;
  const Surface& x = first->scene.bodies[0].surface;
  const Surface& y = second->scene.bodies[0].surface;
  double largest = 0.0;
  for (const double u : uniform_parameters(x.u, 41)) {
    for (const double v : uniform_parameters(x.v, 41)) {
      largest = std::max(largest, (position(x, u, v) - position(y, u, v)).norm());
    }
  }
  return largest;
}

TEST_F(ConvertTest, AHandleGoesOutToCadAndComesBack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const std::string name : {"out.step", "out.STP", "out.iges", "out.igs"}) {
    SCOPED_TRACE(name);
    for (const std::string unit : {"mm", "cm", "m", "in", "inch"}) {
      // The ending only selects the format, and the unit is written in the same manner for each ending.
      const bool is_usual = name == "out.step" || (name == "out.iges" && unit == "cm");
      if (!is_usual && unit != "inch" && !is_full_run()) continue;
      const Json out = convert_for_facts({handle_, place_.text(name), "--unit", unit});
      EXPECT_EQ(out["unit_in"], "mm");
      EXPECT_EQ(out["unit_out"], unit == "inch" ? "in" : unit);
      EXPECT_NEAR(out["size_mm"][0].get<double>(), 100.0, 0.1);
      const Json back = convert_for_facts({place_.text(name), place_.text("back.json")});
      EXPECT_EQ(back["unit_in"], out["unit_out"] == "in" ? Json("inch") : out["unit_out"]);
      EXPECT_EQ(back["bodies"][0]["name"], "handle");
      EXPECT_EQ(back["deviation_m"], 0.0);
      EXPECT_LT(largest_distance_m(handle_, place_.path("back.json")), 1e-9);
      // The converted body can be simulated.
      const Outcome info = run_process(SPOONBILL_PROGRAM, {"info", place_.text("back.json"), "--json"});
      ASSERT_EQ(info.code, exit_done) << info.err;
      EXPECT_FALSE(json_of(info.out)["lattice"].is_null()) << info.out;
    }
  }
}

TEST_F(ConvertTest, SchemasAndSolidsAreAsAskedFor) {
  const Json facts = convert_for_facts({handle_, place_.text("a.step"), "--schema", "ap242"});
  EXPECT_EQ(facts["solids"], 1);
  EXPECT_EQ(facts["open_shells"], 0);
  EXPECT_NE(content_of(place_.path("a.step")).find("AP242"), std::string::npos);
  convert_for_facts({handle_, place_.text("a.step")});
  EXPECT_NE(content_of(place_.path("a.step")).find("AUTOMOTIVE_DESIGN"), std::string::npos);
  EXPECT_NE(content_of(place_.path("a.step")).find("MANIFOLD_SOLID_BREP"), std::string::npos);
}

TEST_F(ConvertTest, MeshesKeepTheirChordErrorAndSayTheirUnit) {
  for (const auto& [name, unit] : {std::pair("a.stl", "mm"), std::pair("a.obj", "mm"),
                                   std::pair("a.ply", "m"), std::pair("a.3mf", "mm")}) {
    SCOPED_TRACE(name);
    const Json coarse = convert_for_facts({handle_, place_.text(name), "--chord", "0.5mm"});
    const Json fine = convert_for_facts({handle_, place_.text(name), "--chord", "0.02mm"});
    EXPECT_EQ(fine["unit_out"], unit);
    EXPECT_EQ(fine["closed_meshes"], 1);
    EXPECT_LE(fine["chord_error_m"].get<double>(), 2e-5);
    EXPECT_LE(coarse["chord_error_m"].get<double>(), 5e-4);
    EXPECT_GT(fine["triangles"].get<int>(), coarse["triangles"].get<int>());
    EXPECT_GT(std::filesystem::file_size(place_.path(name)), 1000u);
  }
}

// A sheet that is exact, with more control points than can be sculpted.
TEST_F(ConvertTest, AWideSheetIsExactAndIsSculptedOnceItIsRebuilt) {
  Document document = sample_document();
  document.scene.bodies[0].surface = wavy_sheet(4, 201);
  document.scene.bodies[0].shell_thickness_m = 0.002;
  document.scene.planes.clear();
  document.view = Json::object();
  place_.write("sheet.json", json_to_page(document_to_json(document)));
  convert_for_facts({place_.text("sheet.json"), place_.text("sheet.step")});
  const Json back = convert_for_facts({place_.text("sheet.step"), place_.text("back.json")});
  EXPECT_EQ(back["bodies"][0]["deviation_m"], 0.0);
  EXPECT_LT(largest_distance_m(place_.path("sheet.json"), place_.path("back.json")), 1e-9);
  const Outcome refused = run_process(SPOONBILL_PROGRAM, {"try", place_.text("sheet.json")});
  EXPECT_EQ(refused.code, exit_failed);
  EXPECT_NE(refused.err.find("rebuild --control 4x200"), std::string::npos) << refused.err;
  const Outcome rebuilt =
      run_process(SPOONBILL_PROGRAM, {"change", place_.text("sheet.json"), "rebuild", "--control", "4x100",
                                      "--tolerance", "1mm", "--out", place_.text("less.json")});
  ASSERT_EQ(rebuilt.code, exit_done) << rebuilt.err;
  const Outcome tried =
      run_process(SPOONBILL_PROGRAM, {"try", place_.text("less.json"), "--seconds", "0.01"});
  EXPECT_EQ(tried.code, exit_done) << tried.err;
}

TEST_F(ConvertTest, AStepFileOfAnotherUnitOrNone) {
  convert_for_facts({handle_, place_.text("a.step")});
  std::string text = content_of(place_.path("a.step"));
  const Json taken_as_inches =
      convert_for_facts({place_.text("a.step"), place_.text("in.json"), "--unit", "in"});
  EXPECT_NEAR(taken_as_inches["size_mm"][0].get<double>(), 2540.0, 1.0);

  const std::string declared = "SI_UNIT(.MILLI.,.METRE.)";
  ASSERT_NE(text.find(declared), std::string::npos);
  std::string metres = text;
  metres.replace(metres.find(declared), declared.size(), "SI_UNIT($,.METRE.)");
  place_.write("m.step", metres);
  const Json in_metres = convert_for_facts({place_.text("m.step"), place_.text("m.json"), "--unit", "mm"});
  EXPECT_NEAR(in_metres["size_mm"][0].get<double>(), 100.0, 0.1);
  EXPECT_EQ(in_metres["unit_in"], "m");

  const std::size_t units = text.find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  ASSERT_NE(units, std::string::npos);
  const std::size_t end = text.find("))", units);
  text.replace(units, end + 2 - units, "");
  place_.write("none.step", text);
  const Json without = convert_for_facts({place_.text("none.step"), place_.text("none.json")});
  EXPECT_EQ(without["unit_declared"], false);
  EXPECT_NEAR(without["size_mm"][0].get<double>(), 100.0, 0.1);
  EXPECT_NE(without["notes"][0].get<std::string>().find("declares no unit"), std::string::npos);
  const Json named = convert_for_facts({place_.text("none.step"), place_.text("none.json"), "--unit", "cm"});
  EXPECT_NEAR(named["size_mm"][0].get<double>(), 1000.0, 1.0);
}

TEST_F(ConvertTest, BodiesAreChosen) {
  const Json all =
      convert_for_facts({place_.write("two.json", two_bodies()).string(), place_.text("a.step")});
  EXPECT_EQ(all["bodies"].size(), 2u);
  EXPECT_EQ(all["solids"], 2);
  const Json second = convert_for_facts({place_.text("a.step"), place_.text("b.json"), "--bodies", "2"});
  ASSERT_EQ(second["bodies"].size(), 1u);
  EXPECT_EQ(second["bodies"][0]["name"], "other");
  const Json both = convert_for_facts({place_.text("a.step"), place_.text("b.json"), "--bodies", "2,1-2"});
  ASSERT_EQ(both["bodies"].size(), 2u);
  EXPECT_EQ(both["bodies"][1]["name"], all["bodies"][0]["name"]);
  expect_failure({place_.text("a.step"), place_.text("b.json"), "--bodies", "3"}, "has 2 bodies");
  for (const char* list : {"0", "a", "2-1", "1,", "1-1001", "-1"}) {
    expect_failure({place_.text("a.step"), place_.text("b.json"), std::string("--bodies=") + list},
                   "is not a list like 1,3-5", exit_wrong_use);
  }
}

TEST_F(ConvertTest, ATrimmedSurfaceStaysTrimmed) {
  Json document = json_of(content_of(place_.path("model.json")));
  document["spoonbill_document"] = 3;
  Json& surface = document["body"]["surface"];
  const auto domain = read_document(place_.path("model.json"))->scene.bodies[0].surface;
  const double low = domain.v.domain_start(), high = domain.v.domain_end();
  // The loop of a hole runs clockwise.
  const auto at = [&](double u, double v) {
    const double start = domain.u.domain_start(), end = domain.u.domain_end();
    return Json::array({start + u * (end - start), low + v * (high - low)});
  };
  surface["trims"] =
      Json::array({{{"degree", 1},
                    {"periodic", true},
                    {"knots", {0, 1, 2, 3, 4}},
                    {"control_points_uv", {at(0.3, 0.4), at(0.3, 0.6), at(0.6, 0.6), at(0.6, 0.4)}}}});
  place_.write("trimmed.json", json_to_page(document));
  const Json whole = convert_for_facts({place_.text("model.json"), place_.text("a.stl")});
  const Json cut = convert_for_facts({place_.text("trimmed.json"), place_.text("b.stl")});
  EXPECT_EQ(whole["closed_meshes"], 1);
  EXPECT_EQ(cut["closed_meshes"], 0);
  for (const char* name : {"t.step", "t.igs"}) {
    SCOPED_TRACE(name);
    const Json out = convert_for_facts({place_.text("trimmed.json"), place_.text(name)});
    EXPECT_EQ(out["bodies"][0]["trims"], 1);
    const Json back = convert_for_facts({place_.text(name), place_.text("back.json")});
    std::size_t trims = 0;
    for (const Json& body : back["bodies"]) trims += body["trims"].get<std::size_t>();
    EXPECT_GE(trims, 1u);
    EXPECT_TRUE(back["notes"].empty());
  }
}

// The chord is finer than the polygons that replace trim loops.
TEST_F(ConvertTest, AMeshThatMissesItsChordIsRefusedUnlessThatIsAllowed) {
  Json document = json_of(content_of(place_.path("model.json")));
  const Surface surface = read_document(place_.path("model.json"))->scene.bodies[0].surface;
  const auto at = [](const KnotVector& knots, double fraction) {
    return knots.domain_start() + fraction * knots.domain_length();
  };
  Json points = Json::array();
  for (const auto& [u, v] : {std::pair(0.3, 0.45), std::pair(0.3, 0.5), std::pair(0.4, 0.55),
                             std::pair(0.5, 0.5), std::pair(0.5, 0.45), std::pair(0.4, 0.4)}) {
    points.push_back(Json::array({at(surface.u, u), at(surface.v, v)}));
  }
  document["body"]["surface"]["trims"] = Json::array(
      {{{"degree", 3}, {"periodic", true}, {"knots", {0, 1, 2, 3, 4, 5, 6}}, {"control_points_uv", points}}});
  place_.write("trimmed.json", json_to_page(document));
  const std::vector<std::string> fine = {place_.text("trimmed.json"), place_.text("a.stl"), "--chord",
                                         "0.0002mm"};
  expect_failure(fine, "--allow-deviation");
  EXPECT_FALSE(std::filesystem::exists(place_.path("a.stl")));
  std::vector<std::string> allowed = fine;
  allowed.push_back("--allow-deviation");
  EXPECT_GT(convert_for_facts(allowed)["chord_error_m"].get<double>(), 2e-7);
}

TEST_F(ConvertTest, InfoTellsWhatACadFileHolds) {
  convert_for_facts({handle_, place_.text("a.step"), "--unit", "in"});
  const Outcome told = run_process(SPOONBILL_PROGRAM, {"info", place_.text("a.step"), "--json"});
  ASSERT_EQ(told.code, exit_done) << told.err;
  const Json facts = json_of(told.out);
  EXPECT_EQ(facts["kind"], "step");
  EXPECT_EQ(facts["unit_in"], "inch");
  EXPECT_EQ(facts["bodies"].size(), 1u);
  EXPECT_EQ(facts["bodies"][0]["name"], "handle");
  EXPECT_NEAR(facts["size_mm"][0].get<double>(), 100.0, 0.1);
  const Outcome refused = run_process(SPOONBILL_PROGRAM, {"info", place_.text("missing.igs")});
  EXPECT_EQ(refused.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(refused)) << refused.err;
}

TEST_F(ConvertTest, WhatMakesNoSenseIsRefused) {
  expect_failure({handle_, place_.text("a.txt")}, "does not have the ending of a format that can be written");
  expect_failure({place_.text("script.json.txt"), place_.text("a.step")},
                 "does not have the ending of a model");
  expect_failure({place_.text("a.stl"), place_.text("a.step")}, "is a mesh");
  expect_failure({handle_, place_.text("a.json")}, "is a document, as the input is");
  expect_failure({place_.text("missing.step"), place_.text("a.json")}, "no such file");
  expect_failure({handle_, place_.text("nowhere/a.step")}, "cannot be written");
  expect_failure({handle_, place_.text("a.step"), "--chord", "1mm"}, "only meshes have a chord error");
  expect_failure({handle_, place_.text("a.stl"), "--schema", "ap242"}, "is not a STEP file");
  expect_failure({handle_, place_.text("a.iges"), "--schema", "ap242"}, "is not a STEP file");
  expect_failure({handle_, place_.text("a.step"), "--tolerance", "1mm"}, "is converted exactly");
  expect_failure({handle_, place_.text("a.3mf"), "--unit", "in"}, "is written in millimetres");
  expect_failure({handle_, place_.text("a.stl"), "--chord", "5"}, "is not a length", exit_wrong_use);
  expect_failure({handle_, place_.text("a.stl"), "--chord", "0mm"}, "must be from 0.0001 mm to 100 mm",
                 exit_wrong_use);
  expect_failure({handle_, place_.text("a.stl"), "--chord", "nanmm"}, "is not a length", exit_wrong_use);
  expect_failure({handle_, place_.text("a.stl"), "--unit", "ell"}, "is not a supported unit", exit_wrong_use);
  expect_failure({handle_, place_.text("a.step"), "--schema", "ap1"}, "is not a supported STEP schema",
                 exit_wrong_use);
  expect_failure({handle_}, "OUT", exit_wrong_use);
}

TEST_F(ConvertTest, AnOlderFileStaysWhenAConversionFails) {
  for (const char* name : {"a.step", "a.igs", "a.stl", "a.obj", "a.ply", "a.3mf", "a.json"}) {
    SCOPED_TRACE(name);
    place_.write("broken.step", "ISO-10303-21;\nHEADER;\nthis is");
    place_.write("broken.json", "{");
    place_.write(name, "precious");
    const bool comes_in = std::string(name) == "a.json";
    const Outcome failed =
        convert({place_.text(comes_in ? "broken.step" : "broken.json"), place_.text(name)});
    EXPECT_EQ(failed.code, exit_failed);
    EXPECT_EQ(content_of(place_.path(name)), "precious");
  }
  // No temporary files are left.
  for (const auto& entry : std::filesystem::directory_iterator(place_.path(""))) {
    EXPECT_EQ(entry.path().string().find("unfinished"), std::string::npos) << entry.path();
  }
}

// A CAD system would treat two products of the same name as one.
TEST_F(ConvertTest, BodiesOfOneNameAreToldApart) {
  Json document = json_of(two_bodies());
  document["other_bodies"][0]["name"] = document["body"]["name"];
  const std::string name = document["body"]["name"].get<std::string>();
  place_.write("same.json", json_to_page(document));
  for (const char* out : {"a.step", "a.igs", "a.obj"}) {
    SCOPED_TRACE(out);
    const Json facts = convert_for_facts({place_.text("same.json"), place_.text(out)});
    EXPECT_EQ(facts["bodies"][0]["name"], name + " 1");
    const std::string text = content_of(place_.path(out));
    for (const char* number : {" 1", " 2"}) {
      EXPECT_NE(text.find(name + number), std::string::npos) << number;
    }
  }
}

TEST_F(ConvertTest, WhatDoesNotGoOutIsSaid) {
  Json document = json_of(content_of(place_.path("model.json")));
  document["body"]["shell_thickness_mm"] = 0.5;
  place_.write("shell.json", json_to_page(document));
  const std::string name = document["body"]["name"].get<std::string>();
  for (const char* out : {"a.step", "a.igs"}) {
    const Json facts = convert_for_facts({place_.text("shell.json"), place_.text(out)});
    EXPECT_EQ(facts["notes"], Json::array({"'" + name +
                                           "' is a shell of 0.5 mm; its surface is written without the "
                                           "thickness"}));
  }
}

// The mesh of a shell has both faces and walls along all edges, including those of holes. A shell that is too
// thick is written as its surface alone.
TEST_F(ConvertTest, AShellGoesOutAsAMeshOfItsThickness) {
  const std::string plate = std::string(SPOONBILL_ASSETS) + "/models/trimmed-plate.json";
  Json document = json_of(content_of(plate));
  const Json thick = convert_for_facts({plate, place_.text("plate.obj")});
  EXPECT_EQ(thick["notes"], Json::array());
  EXPECT_EQ(thick["closed_meshes"], 1);
  document["body"].erase("shell_thickness_mm");
  place_.write("face.json", json_to_page(document));
  const Json face = convert_for_facts({place_.text("face.json"), place_.text("face.obj")});
  EXPECT_EQ(face["closed_meshes"], 0);
  EXPECT_GT(thick["triangles"].get<int>(), 2 * face["triangles"].get<int>());
  const Json mesh = json_of(
      run_process(SPOONBILL_PROGRAM, {"collide", handle_, place_.text("plate.obj"), "--json"}).out)["mesh"];
  EXPECT_EQ(mesh["cleaning"]["open_edges"], 0) << mesh;
  EXPECT_EQ(mesh["closed_parts"], 1) << mesh;

  document["body"]["shell_thickness_mm"] = 100.0;
  place_.write("thick.json", json_to_page(document));
  const Json too_thick = convert_for_facts({place_.text("thick.json"), place_.text("thick.obj")});
  ASSERT_EQ(too_thick["notes"].size(), 1u);
  EXPECT_NE(too_thick["notes"][0].get<std::string>().find(
                "a shell of 100 mm is thicker than the radius of curvature"),
            std::string::npos)
      << too_thick["notes"];
  EXPECT_EQ(too_thick["closed_meshes"], 0);
}

TEST_F(ConvertTest, ALinkIsFollowedAndPermissionsStay) {
  const auto file = place_.write("real.stl", "older");
  std::filesystem::permissions(file,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("real.stl", place_.path("link.stl"));
  convert_for_facts({handle_, place_.text("link.stl")});
  EXPECT_TRUE(std::filesystem::is_symlink(place_.path("link.stl")));
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(ConvertTest, NoMessageCommandsTheTerminal) {
  const Outcome outcome = convert({place_.text("\x1b[31mred\xc2\x9b.txt"), place_.text("a.step")});
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_NE(outcome.err.find("?[31mred?.txt: does not have the ending of a model"), std::string::npos)
      << outcome.err;
}

// Returns the exit code of a conversion that Ctrl+C interrupts. The child process sends itself the signal
// before the work begins, and the signal takes effect at the first check.
int exit_code_when_interrupted(const std::string& in, const std::string& out) {
  const pid_t process = fork();
  if (process == 0) {
    sigset_t interrupt;
    sigemptyset(&interrupt);
    sigaddset(&interrupt, SIGINT);
    sigprocmask(SIG_BLOCK, &interrupt, nullptr);
    raise(SIGINT);
    if (freopen("/dev/null", "w", stderr) == nullptr) _exit(9);
    execl(SPOONBILL_PROGRAM, SPOONBILL_PROGRAM, "convert", in.c_str(), out.c_str(), nullptr);
    _exit(9);
  }
  int status = 0;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(ConvertTest, CtrlCLeavesTheOlderFile) {
  convert_for_facts({handle_, place_.text("in.step")});
  for (const char* name : {"a.obj", "a.3mf", "a.step", "a.igs", "a.json"}) {
    SCOPED_TRACE(name);
    const std::string in = std::string(name) == "a.json" ? place_.text("in.step") : handle_;
    const auto old = place_.write(name, "precious");
    EXPECT_EQ(exit_code_when_interrupted(in, old.string()), exit_failed);
    EXPECT_EQ(content_of(old), "precious");
  }
}

}  // namespace
}  // namespace spoonbill
