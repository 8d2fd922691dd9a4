// Tests tasks with modelled hands, from the recordings of their demonstrations.
#include "app/training/training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "app/program.h"
#include "app/training/motion_measures.h"
#include "app/training/task.h"
#include "app/training/task_watch.h"
#include "engine/base/processor.h"
#include "haptic/recording_lines.h"
#include "haptic/virtual_device.h"
#include "tests/app/workplace.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

std::string asset(const std::string& name) {
  return (std::filesystem::path(SPOONBILL_ASSETS) / name).string();
}

// Does a task as its demonstration does, and returns what `train --json` prints.
Json train(const std::string& name, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"train", asset("tasks/" + name + ".json"), "--recording",
                                        asset("recordings/" + name + ".recording.jsonl"), "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  return json_of(outcome.out);
}

// The state hashes of each recording are compared on the way.
class Demonstrations : public testing::TestWithParam<const char*> {};

TEST_P(Demonstrations, SucceedAndReplayToTheirStates) {
  const Json result = train(GetParam());
  EXPECT_EQ(result["success"], true) << result["end"];
  EXPECT_EQ(result.value("food_lost_fraction", 0.0), 0.0);
  EXPECT_LT(result.value("error_m", 0.0), 0.003);
  EXPECT_GT(result["score"], 50.0);
  EXPECT_LT(result["tremor_m"], 0.2e-3);
  EXPECT_LE(result["largest_force_n"], VirtualDevice::default_specification().maximum_force_n);
}
INSTANTIATE_TEST_SUITE_P(Tasks, Demonstrations, testing::Values("scoop", "carry", "level", "eat", "palpate"));

// A demonstration of a task with each bundled hand, whether or not it succeeds: the hand is that of the
// recording, and its states are compared on the way. Exercises one recording of each hand, or all in a long
// run.
TEST(HandDemonstrations, ReplayToTheirStates) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const auto& entry : std::filesystem::directory_iterator(asset("hands"))) {
    const HandModel hand = read_hand(entry.path()).value();
    for (const std::string task : {"carry", "level"}) {
      if (task == "level" && !is_long_run()) continue;
      const std::string file =
          asset("recordings/hands/" + task + "-" + entry.path().stem().string() + ".recording.jsonl");
      const Outcome outcome = run({"train", asset("tasks/" + task + ".json"), "--recording", file, "--json"});
      ASSERT_EQ(outcome.code, exit_done) << outcome.err;
      EXPECT_EQ(json_of(outcome.out)["hand"], hand.name);
      EXPECT_EQ(json_of(outcome.out)["state_hash"], hash_text(read_recording(file)->end->state_hash));
    }
  }
}

// The difference between seeds is tested with the tremor itself.
TEST(Training, TremorReachesTheBowlTheSameEachTime) {
  const std::vector<std::string> trembling = {"--hand", asset("hands/essential-tremor.json"), "--severity",
                                              "0.3"};
  const Json one = train("carry", trembling);
  EXPECT_GT(one["tremor_m"], 0.2e-3);
  EXPECT_EQ(train("carry", trembling), one);
}

// A limited wrist tilts the bowl where a free hand keeps it level. The device feels that the hand stops. A
// new recording of this session replays to its states.
TEST(Training, LimitedWristTiltsTheBowl) {
  const Workplace place;
  const std::string made = place.text("again.recording.jsonl");
  const std::vector<std::string> hand = {"--hand", asset("hands/limited-wrist.json")};
  const std::string frames = place.text("frames");
  const Json limited = train(
      "carry", {hand[0], hand[1], "--rerecord", made, "--out", frames, "--every", "60", "--size", "320x180"});
  // A frame for each second until the bowl arrives, and one of that moment.
  EXPECT_EQ(limited["frames"], 4);
  EXPECT_TRUE(std::filesystem::exists(frames + "/frame-0000.png"));
  EXPECT_GT(limited["largest_tilt_rad"], 0.05);
  EXPECT_GT(limited["largest_force_n"], 1.0);
  constexpr double widest_rad = 8.0 * std::numbers::pi / 180.0;  // 5 degrees and a stop of 3
  for (const auto& angle : limited["wrist_rad"]["deviation"])
    EXPECT_LT(std::abs(angle.get<double>()), widest_rad);
  const Outcome again =
      run({"train", asset("tasks/carry.json"), "--recording", made, hand[0], hand[1], "--json"});
  EXPECT_EQ(again.code, exit_done) << again.err;
  EXPECT_EQ(json_of(again.out)["state_hash"], limited["state_hash"]);
  EXPECT_TRUE(is_clean_failure(run({"replay", made, "--no-frames"})));
}

TEST(Training, TickAllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  const Task task = read_task(asset("tasks/carry.json")).value();
  const TrainingScene scene = make_training_scene(task, {}).value();
  HandModel hand = read_hand(asset("hands/essential-tremor.json")).value();
  hand.wrist = read_hand(asset("hands/limited-wrist.json"))->wrist;
  hand.speed = read_hand(asset("hands/slow.json"))->speed;
  hand.grip = read_hand(asset("hands/weak-grip.json"))->grip;
  Simulation simulation = Simulation::make(scene.scene, best_instruction_set()).value();
  ASSERT_TRUE(Training::lay_food(simulation));
  Training training(scene, hand, task.elbow_m, 1, Guidance(task.path_m, 1.0));
  TaskWatch watch(task, scene, simulation);
  CouplingState coupling;
  const DeviceSpecification device = VirtualDevice::default_specification();
  const std::size_t before = allocation_count();
  for (int k = 0; k < 300; ++k) {
    const Pose wanted{Vector3(0.0, 2e-5 * k, 0.0), Quaternion::Identity()};
    const TickResult result = training.tick(simulation, coupling, device, DeviceReading::from(wanted, 0));
    watch.follow(simulation, training, result.force_n);
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(watch.progress().time_s, 0.2);
}

TEST(MotionMeasures, SmoothReachHasTheArcLengthOfItsSpectrum) {
  // A minimum-jerk reach of a second: -1.41 in Balasubramanian et al. 2015, whatever its length.
  std::vector<double> slow, fast, interrupted;
  for (int k = 0; k <= 100; ++k) {
    const double t = 0.01 * k, speed = 30.0 * t * t * (1.0 - t) * (1.0 - t);
    slow.push_back(0.1 * speed);
    fast.push_back(0.5 * speed);
    interrupted.push_back(0.1 * speed * (1.0 + 0.9 * std::sin(8.0 * std::numbers::pi * t)));
  }
  const double smooth = find_spectral_arc_length(slow, 100.0);
  EXPECT_NEAR(smooth, -1.41, 0.03);
  EXPECT_NEAR(find_spectral_arc_length(fast, 100.0), smooth, 1e-9);
  EXPECT_LT(find_spectral_arc_length(interrupted, 100.0), smooth - 0.3);
  EXPECT_EQ(find_spectral_arc_length({0.0, 0.0}, 100.0), 0.0);
}

TEST(MotionMeasures, TremorIsWhatIsFasterThanAMotion) {
  std::vector<Vector3> smooth, trembling;
  for (int k = 0; k < 500; ++k) {
    const double t = 0.01 * k;
    smooth.emplace_back(0.1 * t * t, 0.05 * std::sin(2.0 * t), 0.0);
    trembling.push_back(smooth.back() + Vector3(0.0, 0.0, 1e-3 * std::sin(2.0 * std::numbers::pi * 8.0 * t)));
  }
  EXPECT_LT(find_tremor_m(smooth, 100.0), 0.02e-3);
  EXPECT_NEAR(find_tremor_m(trembling, 100.0), 1e-3 / std::sqrt(2.0), 0.1e-3);
  EXPECT_EQ(find_tremor_m({Vector3::Zero()}, 100.0), 0.0);
  EXPECT_DOUBLE_EQ(find_path_length_m({Vector3::Zero(), Vector3(0.0, 3.0, 4.0), Vector3::Zero()}), 10.0);
}

TEST(TaskFiles, WrongFieldsAreNamed) {
  const Workplace place;
  std::ifstream file(asset("tasks/level.json"));
  const Json good = Json::parse(file);
  const auto field_of = [&](const std::string& field, const Json& value) {
    Json json = good;
    json["spoon"] = asset("models/spoon-original.json");
    json[field] = value;
    if (value.is_null()) json.erase(field);
    const auto task = read_task(place.write("task.json", json.dump()));
    return task ? std::string("read") : task.error().field;
  };
  EXPECT_EQ(field_of("note", "another"), "read");
  EXPECT_EQ(field_of("spoonbill_task", 2), "spoonbill_task");
  EXPECT_EQ(field_of("kind", "juggle"), "kind");
  EXPECT_EQ(field_of("hold_s", 100), "hold_s");
  EXPECT_EQ(field_of("hold_s", Json()), "hold_s");
  EXPECT_EQ(field_of("mouth_mm", {0, 0, 0}), "mouth_mm");
  EXPECT_EQ(field_of("friction", -1), "friction");
  EXPECT_EQ(field_of("time_limit_s", 1e9), "time_limit_s");
}

TEST(TaskFiles, WrongCommandLinesGetOneLine) {
  const Workplace place;
  const std::string task = asset("tasks/carry.json"), recording = asset("recordings/carry.recording.jsonl");
  const std::string other = place.record("press.recording.jsonl").string();
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"train", task},
           {"train", task, "--recording", "missing.jsonl"},
           {"train", task, "--recording", other},
           {"train", task, "--recording", recording, "--hand", task},
           {"train", task, "--recording", recording, "--spoon", asset("models/jelly-on-spoon.json")},
           {"train", task, "--recording", recording, "--spoon", asset("models/spoon-bowl.json")},
           {"train", task, "--recording", recording, "--severity", "0.5"},
           {"train", task, "--script", asset("recordings/clay-press.script.json")},
           {"train", recording, "--recording", recording},
       }) {
    EXPECT_TRUE(is_clean_failure(run(arguments))) << arguments.back();
  }
}

}  // namespace
}  // namespace spoonbill
