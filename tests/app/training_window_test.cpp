// Tests training in the window, by mouse and keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "app/program.h"
#include "tests/app/edit_window.h"
#include "tests/app/workplace.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

class TrainingWindow : public EditWindow {
 protected:
  // Trains a bundled task, with two minutes for it: a loaded machine moves the mouse slowly.
  void train(const std::string& task, const std::vector<std::string>& more) {
    const std::filesystem::path assets = SPOONBILL_ASSETS;
    std::ifstream file(assets / "tasks" / (task + ".json"));
    Json json = Json::parse(file);
    json["time_limit_s"] = 120;
    for (const char* const field : {"spoon", "block"}) {
      if (json.contains(field)) json[field] = (assets / "tasks" / json[field].get<std::string>()).string();
    }
    task_ = place_.write("task.json", json.dump());
    std::vector<std::string> arguments = {task_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    start(arguments, "train");
    ASSERT_TRUE(wait_stage("ready"));
  }
  bool wait_stage(const std::string& stage) const {
    return wait_shown([&](const Json& frame) { return frame["stage"] == stage; });
  }
  // Returns what `train --json` prints of a recording of the attempt.
  Json replay(const std::string& recording) const {
    const Outcome outcome = run({"train", task_, "--recording", place_.text(recording), "--json"});
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out);
  }

  std::string task_;
};

// Moves the pointer toward the mouth, 60 mm in front and 120 mm above, until the bowl has arrived. Shakes the
// wheel in between, which turns the spoon and back.
TEST_F(TrainingWindow, ASpoonIsCarriedToTheMouthByMouse) {
  train("carry", {"--rerecord", place_.text("carry.jsonl"), "--guidance", "0.3"});
  ASSERT_TRUE(move_to(700, 560));
  ASSERT_TRUE(hands("key Return"));
  ASSERT_TRUE(wait_stage("running"));
  const auto wanted = [&](int axis) {
    return shown()["wanted_m"][static_cast<std::size_t>(axis)].get<double>();
  };
  EXPECT_TRUE(hands("click 4"));
  EXPECT_TRUE(hands("click 5"));
  int x = 700, y = 560;
  for (int step = 0; step < 300 && shown()["stage"] == "running"; ++step) {
    x += std::clamp(static_cast<int>(1500.0 * (0.06 - wanted(0))), -4, 4);
    y -= std::clamp(static_cast<int>(1500.0 * (0.12 - wanted(1))), -4, 4);
    ASSERT_TRUE(hands("mousemove " + std::to_string(x) + " " + std::to_string(y)));
    const int tick = shown()["tick"].get<int>();
    ASSERT_TRUE(wait_shown([&](const Json& frame) {
      return frame["stage"] != "running" || frame["tick"].get<int>() >= tick + 40;
    }));
  }
  ASSERT_TRUE(wait_stage("ended"));
  EXPECT_EQ(shown()["end"], "success");
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  const Json replayed = replay("carry.jsonl");
  EXPECT_EQ(replayed["success"], true);
  EXPECT_EQ(replayed["guidance"], 0.3);
}

TEST_F(TrainingWindow, AFingerPressesAndMarksAPlace) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  train("palpate", {"--rerecord", place_.text("palpate.jsonl")});
  ASSERT_TRUE(hands("key Return"));
  ASSERT_TRUE(wait_stage("running"));
  ASSERT_TRUE(hands("mousemove 840 310"));
  ASSERT_TRUE(wait_ticks(300));
  ASSERT_TRUE(press_button());
  ASSERT_TRUE(wait_ticks(600));
  press("m");
  ASSERT_TRUE(wait_stage("ended"));
  ASSERT_TRUE(release_button());
  const std::string end = shown()["end"].get<std::string>();
  EXPECT_TRUE(end == "success" || end == "lost") << end;
  ASSERT_TRUE(hands("key Return"));  // again, with the lump elsewhere
  ASSERT_TRUE(wait_stage("ready"));
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  EXPECT_EQ(replay("palpate.jsonl")["end"], end);
}

}  // namespace
}  // namespace spoonbill
