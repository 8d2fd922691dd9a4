#include <gtest/gtest.h>

#include "app/program.h"
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
  };
  for (const auto& arguments : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_wrong_use) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  }
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
