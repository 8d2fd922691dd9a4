// Tests the built program: the state is the same in every build and with any number of drawing threads, a
// recording survives a kill, and a full standard output is a failure.
#include "app/program.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/processor.h"
#include "tests/app/process.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::string program = SPOONBILL_PROGRAM;
const std::string bend_recording = SPOONBILL_ASSETS "/recordings/spoon-handle-bend.recording.jsonl";
const std::string press_recording = SPOONBILL_ASSETS "/recordings/soft-press.recording.jsonl";

std::string hash_of(const std::string& of_program, const std::string& recording,
                    std::vector<std::string> more, const std::string& settings = "") {
  std::vector<std::string> arguments = {"replay", recording, "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = run_process(of_program, arguments, settings);
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  return outcome.code == exit_done ? json_of(outcome.out)["state_hash"].get<std::string>() : "none";
}

void expect_one_hash(const std::string& recording) {
  const std::string hash = hash_of(program, recording, {"--no-frames"});
  for (const InstructionSet set : available_instruction_sets()) {
    EXPECT_EQ(hash_of(program, recording, {"--no-frames", "--instruction-set", std::string(name_of(set))}),
              hash);
  }
}

TEST(StateHash, IsTheSameWithEveryInstructionSet) {
  const Workplace place;
  expect_one_hash(place.record("bend.jsonl").string());
}

TEST(StateHash, OfBundledRecordingsIsTheSameWithEveryInstructionSet) {
  if (sanitized) {
    GTEST_SKIP() << "a sanitizer learns nothing from them that the short recording does not tell";
  }
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const std::string& bundled : {bend_recording, press_recording}) expect_one_hash(bundled);
}

TEST(StateHash, AndTheFramesAreTheSameWithOneAndFourDrawingThreads) {
  const Workplace place;
  const std::string recording = place.record("bend.jsonl").string();
  const auto draw = [&](const std::string& folder, const std::string& threads) {
    return hash_of(program, recording, {"--out", place.text(folder), "--every", "18", "--size", "1280x720"},
                   "LP_NUM_THREADS=" + threads);
  };
  EXPECT_EQ(draw("one", "1"), draw("four", "4"));
  for (const char* frame : {"frame-0000.png", "frame-0018.png", "frame-0036.png"}) {
    EXPECT_EQ(content_of(place.path("one") / frame), content_of(place.path("four") / frame)) << frame;
  }
}

TEST(StateHash, IsTheSameInTheDebugBuild) {
  const char* in_debug = std::getenv("SPOONBILL_DEBUG_STATE_HASH");
  if (in_debug == nullptr) GTEST_SKIP() << "SPOONBILL_DEBUG_STATE_HASH is not set";
  const Workplace place;
  for (const std::string& recording :
       {place.record("bend.jsonl").string(), bend_recording, press_recording}) {
    const Outcome outcome = run_process(in_debug, {recording});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, hash_of(program, recording, {"--no-frames"}) + "\n");
  }
}

TEST(Program, AKilledRecordingReplaysUpToTheCut) {
  const Workplace place;
  std::string script = content_of(place.path("script.json"));
  script.replace(script.rfind("\"hold_s\": 0.1"), 13, "\"hold_s\": 500");
  place.write("long.json", script);
  const auto recording = place.path("killed.jsonl.part");
  const Outcome whole =
      run_process(program, {"record", place.text("script.json"), "--out", place.text("whole.jsonl")});
  ASSERT_EQ(whole.code, exit_done) << whole.err;
  const auto header = content_of(place.path("whole.jsonl")).find('\n');
  run_and_kill(program, {"record", place.text("long.json"), "--out", place.text("killed.jsonl")}, recording,
               header + 2000);
  const Outcome outcome = run_process(program, {"replay", recording.string(), "--no-frames", "--json"});
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["complete"], false);
  EXPECT_GT(facts["ticks"], 0);
  EXPECT_EQ(facts["ticks"].get<int>() % 100, 0);
}

// The limit on file size is 12 KiB. The recording's header is shorter than that, and the whole recording is
// longer even if half of the ticks are missed.
TEST(Program, ALiveRecordingThatIsCutIsAFailure) {
  const Workplace place;
  place.write("live.json", R"({"spoonbill_script": 1, "model": "model.json",
    "steps": [{"start_mm": [50, 14, 0]}, {"move_to_mm": [50, 6, 0], "over_s": 3}, {"move_to_mm": [50, 14, 0], "over_s": 3}]})");
  const Outcome outcome = run_process(
      program, {"record", place.text("live.json"), "--live", "--out", place.text("live.jsonl"), "--json"},
      "trap '' XFSZ; ulimit -f 24;");
  EXPECT_EQ(outcome.code, exit_failed) << outcome.out;
  EXPECT_NE(outcome.err.find("the recording has ended: "), std::string::npos) << outcome.err;
}

// A file that reaches the size limit gives an error of one line, and an existing file is not changed.
TEST(Program, AFileThatMayNotGrowIsAFailureThatLeavesNothing) {
  const Workplace place;
  place.write("kept.json", "old");
  place.write("kept.stl", "old");
  const auto expect_refusal = [&](const std::string& name, const std::vector<std::string>& arguments) {
    const Outcome outcome = run_process(program, arguments, "ulimit -f 4;");
    EXPECT_EQ(outcome.code, exit_failed);
    EXPECT_EQ(outcome.err, "spoonbill: " + place.text(name) + ": cannot be written: File too large\n");
    EXPECT_EQ(content_of(place.path(name)), "old");
  };
  const auto names = [&] { return std::distance(std::filesystem::directory_iterator(place.path("")), {}); };
  const auto before = names();
  expect_refusal("kept.json", {"new", "sphere", "--out", place.text("kept.json")});
  expect_refusal("kept.stl", {"convert", place.text("model.json"), place.text("kept.stl")});
  EXPECT_EQ(names(), before);
}

TEST(Program, AFullStandardOutputIsAFailure) {
  const Workplace place;
  for (const std::string& command :
       {"sample " + place.text("model.json") + " --out -", std::string("--help"), std::string("--version")}) {
    const Outcome outcome = run_process("/bin/sh", {"-c", "\"$0\" " + command + " >/dev/full", program});
    EXPECT_EQ(outcome.code, exit_failed) << command;
    EXPECT_EQ(outcome.err, "spoonbill: standard output could not be written\n") << command;
  }
}

}  // namespace
}  // namespace spoonbill
