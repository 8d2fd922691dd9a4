// Tests damaged, hostile and missing input: the program reports every fault in one line and does not crash.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "app/program.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t place = text.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  return place == std::string::npos ? text : text.replace(place, what.size(), with);
}

// Expects each of these commands to fail on the file with a message of one line.
void expect_refusals(const Workplace& place, const std::string& file) {
  const std::vector<std::vector<std::string>> uses = {
      {"info", file},
      {"sample", file, "--grid", "3x3", "--out", place.text("points.csv")},
      {"collide", file, place.text("model.json")},
      {"collide", place.text("model.json"), file},
      {"record", file, "--out", place.text("out.jsonl")},
      {"replay", file, "--out", place.text("pictures")},
  };
  for (const auto& arguments : uses) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_failed) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(std::filesystem::path(file).filename().string()), std::string::npos)
        << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(place.path("points.csv")));
}

TEST(BadInput, FilesThatHoldNothingOfOurs) {
  const Workplace place;
  expect_refusals(place, place.text("missing.json"));
  expect_refusals(place, place.path("").string());
  expect_refusals(place, place.write("empty.json", "").string());
  expect_refusals(place, place.write("noise.json", std::string("\0\x01\xff{\"", 5)).string());
  expect_refusals(place, place.write("other.json", "{\"a\": 1}").string());
  expect_refusals(place, place.write("deep.json", std::string(100000, '[')).string());
  expect_refusals(place, place.write("list.json", "[1, 2]").string());
  expect_refusals(place, "/dev/null");
}

TEST(BadInput, DamagedModels) {
  const Workplace place;
  const std::string model = content_of(place.path("model.json"));
  const std::string start = model.substr(0, model.find(':'));
  ASSERT_NE(start.find("spoonbill_document"), std::string::npos);
  for (const std::string& damaged :
       {model.substr(0, model.size() / 2),
        replaced(model, start + ": " + std::to_string(document_version), start + ": 99"),
        replaced(model, "\"degree\": 3", "\"degree\": 42"),
        replaced(model, "\"degree\": 3", "\"degree\": NaN"),
        replaced(model, "\"degree\": 3", "\"degree\": 1e999"), replaced(model, "\"degree\"", "\"degre\"")}) {
    expect_refusals(place, place.write("damaged.json", damaged).string());
  }
}

// Writes the model with `move` applied to all its control points, and returns the name of the file.
template <class Move>
std::string moved_model(const Workplace& place, const std::string& name, const Move& move) {
  auto document = read_document(place.path("model.json"));
  EXPECT_TRUE(document);
  ControlNet& net = document->scene.bodies[0].surface.net;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, move(net.point(i, j)));
  }
  return place.write(name, json_to_page(document_to_json(document.value()))).string();
}

void expect_refusal(const std::vector<std::string>& arguments, const std::string& reason) {
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.code, exit_failed) << testing::PrintToString(arguments);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
}

void expect_no_lattice(const std::string& model, const std::string& reason) {
  const Outcome outcome = run({"info", model, "--json"});
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_TRUE(json_of(outcome.out)["lattice"].is_null());
  const std::string told = json_of(outcome.out)["no_lattice_because"].get<std::string>();
  EXPECT_NE(told.find(reason), std::string::npos) << told;
}

TEST(BadInput, InfoRefusesWhatSculptingRefusesForAnotherReasonThanTheLattice) {
  const Workplace place;
  auto document = read_document(place.path("model.json"));
  ASSERT_TRUE(document);
  document->view = Json{{"camera", Json{{"yaw_deg", 1000}}}};
  place.write("view.json", json_to_page(document_to_json(document.value())));
  expect_refusal({"info", place.text("view.json")}, "view: camera.yaw_deg");
}

TEST(BadInput, APipeIsNoFile) {
  const Workplace place;
  ASSERT_EQ(mkfifo(place.path("pipe.json").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(place.path("pipe.ply").c_str(), 0600), 0);
  expect_refusal({"info", place.text("pipe.json")}, "is not a regular file");
  expect_refusal({"record", place.text("pipe.json"), "--out", place.text("out.jsonl")},
                 "is not a regular file");
  expect_refusal({"fit", place.text("pipe.ply"), "--out", place.text("out.json")}, "pipe.ply");
}

TEST(BadInput, TheModelIsNotRecordedOver) {
  const Workplace place;
  const std::string before = content_of(place.path("model.json"));
  expect_refusal({"edit", place.text("model.json"), "--record", place.text("model.json")},
                 "is the model itself; record to another file");
  EXPECT_EQ(content_of(place.path("model.json")), before);
}

TEST(BadInput, BodiesInsideOutHaveNoOutside) {
  const Workplace place;
  const std::string mirrored =
      moved_model(place, "mirrored.json", [](const Vector3& p) { return Vector3(p.x(), p.y(), -p.z()); });
  expect_no_lattice(mirrored, "mirrored.json: surface: normals point inward");
  expect_refusal({"collide", mirrored, place.text("model.json")},
                 "mirrored.json: surface: normals point inward");
  expect_refusal({"collide", place.text("model.json"), mirrored},
                 "mirrored.json: surface: normals point inward");
}

TEST(BadInput, BodiesWithoutThicknessHoldNoLattice) {
  const Workplace place;
  for (const double thickness : {1e-6, 1e-9, 1e-13, 0.0}) {
    const std::string flat = moved_model(
        place, "flat.json", [&](const Vector3& p) { return Vector3(p.x(), thickness * p.y(), p.z()); });
    expect_no_lattice(flat,
                      thickness > 0.0 ? "flat.json: surface: " : "flat.json: surface: encloses no volume");
  }
}

TEST(BadInput, DamagedRecordings) {
  const Workplace place;
  const std::string recording = content_of(place.record("good.jsonl"));
  for (const std::string& damaged :
       {recording.substr(0, 40),
        replaced(recording, "\"spoonbill_recording\":1", "\"spoonbill_recording\":2"),
        replaced(recording, "\"ticks\":100", "\"ticks\":1000000000000"),
        replaced(recording, "\"command\":\"place_plane\"", "\"command\":\"explode\""),
        replaced(recording, "\"lattice\":true", "\"lattice\":\"yes\""),
        replaced(recording, "\"lattice\":true", "\"latice\":true"),
        replaced(recording, "\"tick\":0,\"ticks\"", "\"tick\":7,\"ticks\"")}) {
    const std::string file = place.write("damaged.jsonl", damaged).string();
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"info", file},
                                               {"replay", file, "--no-frames"},
                                               {"record", file, "--out", place.text("o.jsonl")}}) {
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, exit_failed) << damaged.substr(0, 100);
      EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    }
  }
}

TEST(BadInput, DamagedScripts) {
  const Workplace place;
  const std::string script = content_of(place.path("script.json"));
  for (const std::string& damaged :
       {script.substr(0, script.size() / 2), replaced(script, "script\": 1", "script\": 2"),
        replaced(script, "model.json", "missing-model.json"), replaced(script, "0.1", "1e9"),
        replaced(script, "0.1", "-1"), replaced(script, "\"undo\"", "\"undoo\""),
        replaced(script, "\"lattice\"", "\"latice\""), replaced(script, "start_mm", "begin_mm")}) {
    const std::string file = place.write("damaged-script.json", damaged).string();
    const Outcome outcome = run({"record", file, "--out", place.text("out.jsonl")});
    EXPECT_EQ(outcome.code, exit_failed) << damaged;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(place.path("out.jsonl")));
  }
}

TEST(BadInput, ScriptsAreToldWhatTheyNameWrongly) {
  const Workplace place;
  const std::string script = content_of(place.path("script.json"));
  const std::string unknown = place.write("unknown.json", replaced(script, "\"undo\"", "\"undoo\"")).string();
  expect_refusal({"record", unknown, "--out", place.text("out.jsonl")},
                 "is \"undoo\", must be one of save, screenshot, undo,");
  moved_model(place, "mirrored.json", [](const Vector3& p) { return Vector3(p.x(), p.y(), -p.z()); });
  const std::string inside_out =
      place.write("inside-out.json", replaced(script, "model.json", "mirrored.json")).string();
  for (const char* const way : {"--json", "--live"}) {
    expect_refusal({"record", inside_out, way, "--out", place.text("out.jsonl")},
                   "mirrored.json: surface: normals point inward");
  }
}

TEST(BadInput, PlacesThatCannotBeWritten) {
  const Workplace place;
  const std::string recording = place.record("good.jsonl").string();
  const std::string blocked = place.write("file", "in the way").string();
  const std::vector<std::vector<std::string>> uses = {
      {"replay", recording, "--out", blocked + "/pictures"},
      {"replay", recording, "--out", blocked},
      {"replay", recording, "--out", "/proc/pictures"},
      {"replay", recording, "--no-frames", "--rerecord", blocked + "/again.jsonl"},
      {"replay", recording, "--no-frames", "--rerecord", "/dev/full"},
      {"replay", recording, "--no-frames", "--rerecord", recording},
      {"record", place.text("script.json"), "--out", "/dev/full"},
      {"record", place.text("script.json"), "--out", blocked + "/out.jsonl"},
      {"record", recording, "--out", recording},
      {"record", place.text("script.json"), "--out", place.text("model.json")},
      {"sample", place.text("model.json"), "--grid", "4x4", "--out", place.text("model.json")},
      {"sample", place.text("model.json"), "--grid", "40x40", "--out", "/dev/full"},
      {"sample", place.text("model.json"), "--grid", "4x4", "--out", place.path("").string()},
      {"sample", place.text("model.json"), "--grid", "4x4", "--out", blocked + "/points.csv"},
  };
  const std::string before = content_of(recording), model = content_of(place.path("model.json"));
  for (const auto& arguments : uses) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_failed) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
  EXPECT_EQ(content_of(recording), before);
  EXPECT_EQ(content_of(place.path("model.json")), model);
}

}  // namespace
}  // namespace spoonbill
