// Compares pictures of training sessions with approved ones: a person sees what to do without reading.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/workplace.h"
#include "tests/engine/effort.h"
#include "tests/pictures/approved.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

// Compares the last frame of a session in which the person moves the bowl or the finger to `steps`.
void compare_session(const std::string& task, const Json& steps, const std::vector<std::string>& more = {}) {
  const Workplace place;
  const std::string assets = SPOONBILL_ASSETS;
  const std::string model = task == "palpate" ? "/models/tissue.json" : "/models/spoon-original.json";
  const std::filesystem::path script =
      place.write("motion.script.json",
                  Json({{"spoonbill_script", 1}, {"model", assets + model}, {"steps", steps}}).dump());
  std::vector<std::string> arguments = {"train",
                                        assets + "/tasks/" + task + ".json",
                                        "--script",
                                        script.string(),
                                        "--every",
                                        "1000000",
                                        "--panel",
                                        "--out",
                                        place.text("frames")};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = run(arguments);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::vector<std::filesystem::path> frames;
  for (const auto& entry : std::filesystem::directory_iterator(place.path("frames")))
    frames.push_back(entry.path());
  ASSERT_EQ(frames.size(), 2u) << "the first and the last frame";
  const auto last = read_png(*std::max_element(frames.begin(), frames.end()));
  ASSERT_TRUE(last) << last.error().message;
  compare_with_approved("training-" + task, last.value());
}

const Json waiting = {{{"start_mm", {0, 0, 0}}}, {{"hold_s", 0.05}}};

TEST(TrainingPictures, ALimitedWristCarriesASpoon) {
  compare_session(
      "carry", {{{"start_mm", {0, 0, 0}}}, {{"move_to_mm", {30, 60, 0}}, {"over_s", 1.2}}, {{"hold_s", 0.1}}},
      {"--hand", std::string(SPOONBILL_ASSETS) + "/hands/limited-wrist.json"});
}

TEST(TrainingPictures, AFingerHasMarkedALump) {
  compare_session("palpate", {{{"start_mm", {0, 36, 0}}},
                              {{"move_to_mm", {-6, 20, 9}}, {"over_s", 0.4}},
                              {{"grip", true}},
                              {{"hold_s", 0.05}}});
}

// Only a full run draws these, because the others run the same code.
TEST(TrainingPictures, TheOtherTasksAtTheirStart) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const char* const task : {"scoop", "level", "eat"}) compare_session(task, waiting);
}

}  // namespace
}  // namespace spoonbill
