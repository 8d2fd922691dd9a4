// Tests training in a live session: the score and the states of an attempt are those of its recording's
// replay.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "app/live/live_session.h"
#include "app/program.h"
#include "app/session/training_session.h"
#include "haptic/virtual_device.h"
#include "tests/app/wait_for.h"
#include "tests/app/workplace.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Starts an attempt of a task with a hand that trembles. Ticks follow each other at once.
std::unique_ptr<LiveSession> start_attempt(const TrainingSetting& setting, const std::string& recording,
                                           std::shared_ptr<TargetMailbox>& mailbox) {
  HandTarget start;
  start.pose.position_m = setting.scene.start_m;
  auto device = SteeredDevice::make(Hand{}, start).value();
  mailbox = device->mailbox();
  auto session = make_training_session(setting, "task", device->specification(), best_instruction_set());
  EXPECT_TRUE(session) << session.error().message;
  auto writer =
      RecordingWriter::create(recording, {session->device, setting.document(), setting.identity}).value();
  LiveSettings settings;
  settings.real_time = false;
  auto live = LiveSession::start(std::make_unique<Session>(std::move(session).value()), settings,
                                 std::move(device), std::make_unique<RecordingWriter>(std::move(writer)));
  EXPECT_TRUE(live) << live.error().message;
  return std::move(live).value();
}

TEST(LiveTraining, ScoreIsThatOfTheReplay) {
  const Workplace place;
  const std::string assets = SPOONBILL_ASSETS, recording = place.text("attempt.recording.jsonl");
  TrainingChoice choice;
  choice.task = assets + "/tasks/carry.json";
  choice.hand = assets + "/hands/aged.json";
  choice.seed = 5;
  choice.guidance = 0.7;
  const TrainingSetting setting = read_training_setting(choice).value();
  std::shared_ptr<TargetMailbox> mailbox;
  const auto live = start_attempt(setting, recording, mailbox);
  mailbox->aim({{Vector3(0.05, 0.03, 0.01), Quaternion::Identity()}, 0});
  // The device feels the guidance. Under a sanitizer, the loop is too slow for a force.
  bool is_felt = sanitized;
  std::vector<float> forces_n;
  ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) {
    live->consume_forces(forces_n);
    is_felt |= std::any_of(forces_n.begin(), forces_n.end(), [](float force_n) { return force_n > 0.1F; });
    return frame.snapshot.tick > 2600 && is_felt;
  }));
  live->ask(SwitchForce{false});
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return !frame.facts.force_on; }));
  const std::uint64_t tick = live->frame().snapshot.tick;
  ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) { return frame.snapshot.tick > tick + 200; }));
  ASSERT_TRUE(live->frame().facts.training);
  EXPECT_GT(live->frame().facts.training->progress.largest_force_n, 0.05);
  live->stop();
  ASSERT_TRUE(live->is_last_recording_complete());
  const TaskResult result = live->session()->watch->result();
  const Outcome replayed = run({"train", choice.task.string(), "--recording", recording, "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  const Json json = json_of(replayed.out);
  EXPECT_EQ(json["hand"], "aged person");
  EXPECT_EQ(json["time_s"], result.time_s);
  EXPECT_EQ(json["path_m"], result.path_m);
  EXPECT_EQ(json["smoothness"], result.smoothness);
  EXPECT_EQ(json["tremor_m"], result.tremor_m);
  EXPECT_EQ(json["largest_force_n"], result.largest_force_n);
  EXPECT_EQ(json["score"], result.score(setting.task));
}

}  // namespace
}  // namespace spoonbill
