#include <gtest/gtest.h>

#include "app/program.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

TEST(CommandLine, HelpAndVersionAreWorkDone) {
  for (const char* command : {"replay", "record", "info", "sample"}) {
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
  };
  for (const auto& arguments : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_wrong_use) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
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
