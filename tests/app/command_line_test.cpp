#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

TEST(CommandLine, HelpAndVersionAreWorkDone) {
  for (const char* command : {"replay", "record", "info", "sample", "collide"}) {
    const Outcome help = run({command, "--help"});
    EXPECT_EQ(help.code, exit_done);
    EXPECT_NE(help.out.find("Example: spoonbill"), std::string::npos) << command;
    EXPECT_EQ(help.err, "");
  }
  EXPECT_EQ(run({"--help"}).code, exit_done);
  EXPECT_TRUE(run({"--version"}).out.starts_with("spoonbill "));
}

TEST(CommandLine, HelpNamesThingsNotTypes) {
  for (const char* command : {"check", "convert", "fit", "merge", "change", "info"}) {
    const std::string help = run({command, "--help"}).out;
    EXPECT_EQ(help.find("TEXT REQUIRED   "), std::string::npos) << help;
    EXPECT_EQ(help.find("(1x)"), std::string::npos) << help;
    EXPECT_EQ(help.find(" in ["), std::string::npos) << help;
  }
}

TEST(CommandLine, WrongUseIsTwoAndSaysWhatIsWrong) {
  const Workplace place;
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"carve"},
      {"replay"},
      {"replay", "a.jsonl"},
      {"replay", "a.jsonl", "--out", "pictures", "--size", "720"},
      {"replay", "a.jsonl", "--out", "pictures", "--size", "1280x"},
      {"replay", "a.jsonl", "--out", "pictures", "--size", "63x64"},
      {"replay", "a.jsonl", "--out", "pictures", "--size", "99999999999x10"},
      {"replay", "a.jsonl", "--out", "pictures", "--size", "-640x480"},
      {"replay", "a.jsonl", "--out", "pictures", "--every", "0"},
      {"replay", "a.jsonl", "--out", "pictures", "--every", "x"},
      {"replay", "a.jsonl", "--out", "pictures", "--colour", "red"},
      {"replay", "a.jsonl", "--out", "pictures", "--instruction-set", "mmx"},
      {"record", place.text("script.json")},
      {"info"},
      {"info", place.text("model.json"), "--jsn"},
      {"sample", place.text("model.json"), "--grid", "1x5", "--out", "-"},
      {"sample", place.text("model.json"), "--grid", "5", "--out", "-"},
      {"sample", place.text("model.json"), "--grid", "5x5x5", "--out", "-"},
      {"collide"},
      {"edit", place.text("model.json"), "--quality", "best"},
  };
  for (const auto& arguments : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_wrong_use) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
}

TEST(CommandLine, SaysWhatIsWrongAndWhereHelpIs) {
  const Workplace place;
  const std::string model = place.text("model.json"), out = place.text("out.json");
  const std::vector<std::pair<std::vector<std::string>, const char*>> wrong = {
      {{}, "a command is missing; see `spoonbill --help`"},
      {{"carve"}, "'carve' is not a command; see `spoonbill --help`"},
      {{"new"}, "a command is missing; see `spoonbill new --help`"},
      {{"new", "dodecahedron"}, "'dodecahedron' is not a command; see `spoonbill new --help`"},
      {{"new", "box", "--out", out}, "--size is required; see `spoonbill new box --help`"},
      {{"sample", model, "--out", out, "--out", out}, "--out is given more than once"},
      {{"sample", model, "--out", out, "--grid", "7"}, "'7' is not two numbers like 50x50, each from 2"},
      {{"new", "sphere", "--control", "3x3", "--out", out},
       "'3x3' is not two numbers like 24x24, each from 4"},
      {{"new", "sphere", "--radius", "7", "--out", out},
       "'7' is not a length with a unit, like 5mm (mm, cm, m or in); see"},
      {{"change", model, "reverse", "v", "--tolerance", "0", "--out", out},
       "must be from 1e-06 mm to 100 mm; see"},
      {{"change", model, "reverse", "v", "--body", "none", "--out", out},
       "'none' is not a whole number, which must be from 1 to 1000"},
      {{"change", model, "reverse", "v", "--body", "1001", "--out", out},
       "1001 is outside the range 1 to 1000"},
      {{"try", model, "--seconds", "2s"}, "'2s' is not a number, which must be from 0 to 600"}};
  for (const auto& [arguments, told] : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_wrong_use) << told;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(told), std::string::npos) << outcome.err;
  }
}

// A document written under another extension could overwrite a scan or a CAD file.
TEST(CommandLine, DocumentsAreWrittenAsJsonAlone) {
  const Workplace place;
  const std::string model = place.text("model.json");
  for (const char* name : {"spoon.step", "scan.ply", "noending", ""}) {
    const std::string out = *name == '\0' ? "" : place.write(name, "precious").string();
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"new", "sphere", "--out", out},
                                               {"fit", "scan.ply", "--out", out},
                                               {"merge", model, "--out", out},
                                               {"change", model, "simplify", "--out", out},
                                               {"rest", model, "--out", out}}) {
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, exit_wrong_use) << arguments[0];
      EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
      EXPECT_NE(outcome.err.find("does not end in .json"), std::string::npos) << outcome.err;
    }
    if (!out.empty()) {
      EXPECT_EQ(std::filesystem::file_size(out), 8U);
    }
  }
  EXPECT_EQ(run({"new", "sphere", "--out", place.text("ball.JSON")}).code, exit_done);
}

// The error names the file and the command that converts it to a document.
TEST(CommandLine, SaysWhatTakesForeignFiles) {
  const Workplace place;
  const std::string cad = place.write("a.step", "ISO-10303-21;").string();
  const std::string mesh = place.write("a.stl", "solid a").string();
  for (const char* command : {"check", "rest"}) {
    EXPECT_NE(run({command, cad}).err.find("`spoonbill convert`"), std::string::npos);
    EXPECT_NE(run({command, mesh}).err.find("`spoonbill fit`"), std::string::npos);
  }
  EXPECT_NE(run({"info", mesh}).err.find("`spoonbill fit`"), std::string::npos);
}

// Every body of a document has rows in the table.
TEST(CommandLine, SampleTakesAllBodies) {
  const Workplace place;
  Document two = read_document(place.path("model.json")).value();
  two.scene.bodies.push_back(two.scene.bodies[0]);
  two.scene.bodies[1].name = "other";
  place.write("two.json", json_to_page(document_to_json(two)));
  const std::string rows = run({"sample", place.text("two.json"), "--grid", "2x3", "--out", "-"}).out;
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1 + 2 * 6);
  EXPECT_EQ(rows.rfind("body,"), 0U);
  EXPECT_NE(rows.find("\nother,"), std::string::npos);
}

TEST(CommandLine, APoseIsAPositionWithUnitsAndATurn) {
  const Workplace place;
  const std::string model = place.text("model.json");
  for (const char* pose :
       {"", "10mm", "10,0,0,1,0,0,0", "10mm,0,0", "10mm,0,0,1,0,0", "10mm,0,0,1,0,0,0,0", "0,0,0,0,0,0,0",
        "nanmm,0,0,1,0,0,0", "inf,0,0,1,0,0,0", "0,0,0,nan,0,0,0", "101m,0,0,1,0,0,0", "1e999mm,0,0,1,0,0,0",
        "1mm,0,0,1e200,0,0,0", "1 mm,0,0,1,0,0,0", "1ft,0,0,1,0,0,0", "1mm;0;0;1;0;0;0", ",,,,,,"}) {
    const Outcome outcome = run({"collide", model, model, "--pose", pose});
    EXPECT_EQ(outcome.code, exit_wrong_use) << pose;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find("--pose"), std::string::npos) << outcome.err;
  }
  for (const char* pose :
       {"10cm,0,0,1,0,0,0", "0.1m,0,0,2,0,0,0", "100mm,0,0,-1,0,0,0", "0,0,0,0.5,0.5,0.5,0.5"}) {
    EXPECT_EQ(run({"collide", model, model, "--pose", pose}).code, exit_done) << pose;
  }
}

TEST(CommandLine, OptionsAreReadBeforeAnythingIsDone) {
  const Workplace place;
  const Outcome outcome =
      run({"sample", place.text("model.json"), "--out", place.text("points.csv"), "--grid", "0x0"});
  EXPECT_EQ(outcome.code, exit_wrong_use);
  EXPECT_FALSE(std::filesystem::exists(place.path("points.csv")));
}

}  // namespace
}  // namespace spoonbill
