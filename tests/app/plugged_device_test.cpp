// Tests a device that only this file defines, live and in lock-step. The device presses by itself, stops
// responding at times, and returns invalid readings.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "app/live/live_session.h"
#include "app/program.h"
#include "app/session/lockstep.h"
#include "engine/base/assert.h"
#include "tests/app/wait_for.h"
#include "tests/app/workplace.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

constexpr double plugged_limit_n = 0.8;  // force limit of the device, less than the force of a press
constexpr double noticeable_n = 0.3;     // threshold of a noticeable force

enum class Fault { none, silent, garbage, broken_promise };

// Counters of the device that the test reads; the live session owns the device.
struct Hardware {
  std::atomic<Fault> fault{Fault::none};
  std::atomic<double> force_n{0.0};
  std::atomic<double> largest_n{0.0};
  std::atomic<std::uint64_t> noticeable_ticks{0};  // ticks with a noticeable force
  std::atomic<std::uint64_t> faulty_ticks{0};      // ticks without a valid reading
  std::atomic<std::uint64_t> faulty_forces{0};     // number of faulty ticks with a force
  std::atomic<bool> is_open{true};
};

DeviceSpecification plugged_specification() {
  DeviceSpecification specification;
  specification.name = "plugged";
  specification.maximum_force_n = plugged_limit_n;
  specification.maximum_stiffness_n_per_m = 500.0;
  specification.workspace_radius_m = 0.1;
  specification.ramp_time_s = 0.02;
  return specification;
}

// A device that moves down onto the handle and up again once a second, whatever the force.
class PluggedDevice : public Device {
 public:
  explicit PluggedDevice(std::shared_ptr<Hardware> hardware,
                         DeviceSpecification specification = plugged_specification())
      : hardware_(std::move(hardware)), specification_(std::move(specification)) {}
  ~PluggedDevice() override { hardware_->is_open = false; }

  const DeviceSpecification& specification() const override { return specification_; }

  std::optional<DeviceReading> read() override {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(tick_++ % 1000) / 1000.0;
    const Vector3 position_m(0.05, 0.012 + 0.01 * std::cos(phase), 0.0);
    DeviceReading reading = DeviceReading::from({position_m, Quaternion::Identity()}, button_main);
    faulty_ = hardware_->fault != Fault::none;
    if (faulty_) ++hardware_->faulty_ticks;
    if (hardware_->fault == Fault::silent) return {};
    SPOONBILL_ASSERT(hardware_->fault != Fault::broken_promise);
    if (hardware_->fault == Fault::garbage) {
      reading.position_nm[1] = tick_ % 2 == 0 ? std::int64_t{-1} << 60 : reading.position_nm[1];
      reading.orientation_e9[3] = 0;
    }
    return reading;
  }

  void set_force(const Vector3& force_n) override {
    const double size_n = force_n.norm();
    hardware_->force_n = size_n;
    if (!(size_n <= hardware_->largest_n)) hardware_->largest_n = size_n;
    if (size_n > noticeable_n) ++hardware_->noticeable_ticks;
    if (faulty_ && size_n != 0.0) ++hardware_->faulty_forces;
  }

 private:
  std::shared_ptr<Hardware> hardware_;
  DeviceSpecification specification_;
  std::uint64_t tick_ = 0;
  bool faulty_ = false;
};

// Returns a document with a rubber handle, so that each press meets the same resistance. The force scale
// makes the forces exceed the limit of the device.
Document rubber_handle() {
  Document document = held_handle();
  // A loop of fewer than 200 ticks a second gets no force, and a sanitizer slows it.
  document.scene.bodies[0].lattice = {100, {}};
  document.scene.bodies[0].material.plastic = false;
  document.scene.bodies[0].material.youngs_modulus_pa = 3e5;
  document.scene.sculpting.force_scale = 40.0;
  return document;
}

Result<std::unique_ptr<LiveSession>> start_live(std::unique_ptr<Device> device) {
  LiveSettings settings;
  settings.real_time = false;
  return LiveSession::start(rubber_handle(), "test", settings, std::move(device));
}

bool wait_until_felt(LiveSession& live, const Hardware& hardware) {
  const std::uint64_t before = hardware.noticeable_ticks;
  return wait_for(live, [&](const LiveFrame&) { return hardware.noticeable_ticks > before + 20; });
}

void expect_harmless(const Hardware& hardware) {
  EXPECT_LE(hardware.largest_n, plugged_limit_n * (1.0 + 1e-12));
  EXPECT_EQ(hardware.faulty_forces, 0U);
}

void replay_to_the_same_states(const Workplace& place, const char* recording) {
  const Outcome replayed = run({"replay", place.text(recording), "--no-frames", "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_TRUE(json_of(replayed.out)["complete"].get<bool>());
}

TEST(PluggedDevice, DrivesALiveSessionAndIsUnharmedByItsFaults) {
  const Workplace place;
  const auto hardware = std::make_shared<Hardware>();
  auto started = start_live(std::make_unique<PluggedDevice>(hardware));
  ASSERT_TRUE(started) << started.error().message;
  auto live = std::move(started).value();
  EXPECT_EQ(live->frame().snapshot.device.name, "plugged");
  ASSERT_TRUE(live->start_recording(place.path("plugged.jsonl"), ViewChoice()));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.recording; }));
  ASSERT_TRUE(wait_until_felt(*live, *hardware));
  for (const Fault fault : {Fault::silent, Fault::garbage}) {
    const std::uint64_t before = hardware->faulty_ticks;
    hardware->fault = fault;
    EXPECT_TRUE(wait_for(*live, [&](const LiveFrame& frame) {
      return hardware->faulty_ticks > before + 200 && (frame.safety_flags & safety_flag_no_device) != 0 &&
             !frame.facts.in_stroke;
    }));
    EXPECT_EQ(hardware->force_n, 0.0);
    hardware->fault = Fault::none;
    EXPECT_TRUE(wait_until_felt(*live, *hardware));
  }
  live->stop();
  EXPECT_EQ(hardware->force_n, 0.0);
  expect_harmless(*hardware);
  EXPECT_TRUE(hardware->is_open);
  EXPECT_TRUE(live->is_last_recording_complete());
  live.reset();
  EXPECT_FALSE(hardware->is_open);
  replay_to_the_same_states(place, "plugged.jsonl");
}

// Makes failed assertions throw, as they do in the program.
class ThrownAsserts {
 public:
  ThrownAsserts() : previous_(set_assertion_handler(throw_failed_assertion)) {}
  ~ThrownAsserts() { set_assertion_handler(previous_); }

 private:
  AssertionHandler previous_;
};

TEST(PluggedDevice, GetsNoForceInTicksThatAFailedAssertBreaksOff) {
  const ThrownAsserts thrown;
  const auto hardware = std::make_shared<Hardware>();
  auto started = start_live(std::make_unique<PluggedDevice>(hardware));
  ASSERT_TRUE(started) << started.error().message;
  auto live = std::move(started).value();
  ASSERT_TRUE(wait_until_felt(*live, *hardware));
  live->consume_notices();  // those of the start
  const std::uint64_t before = hardware->faulty_ticks;
  hardware->fault = Fault::broken_promise;
  EXPECT_TRUE(wait_for(*live, [&](const LiveFrame&) { return hardware->faulty_ticks > before + 50; }));
  EXPECT_EQ(hardware->force_n, 0.0);
  hardware->fault = Fault::none;
  EXPECT_TRUE(
      wait_for(*live, [](const LiveFrame& frame) { return (frame.snapshot.flags & tick_flag_failed) != 0; }));
  EXPECT_TRUE(wait_until_felt(*live, *hardware));
  const std::vector<Notice> notices = live->consume_notices();
  EXPECT_EQ(std::count_if(notices.begin(), notices.end(),
                          [](const Notice& notice) { return notice.kind == Notice::Kind::problem; }),
            1);
  expect_harmless(*hardware);
}

TEST(PluggedDevice, IsRefusedWhereItDoesNotAnswerOrPromisesWhatNoDeviceDoes) {
  const auto hardware = std::make_shared<Hardware>();
  hardware->fault = Fault::silent;
  const auto silent = start_live(std::make_unique<PluggedDevice>(hardware));
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, ErrorCode::unreadable);
  hardware->fault = Fault::none;
  DeviceSpecification boundless = plugged_specification();
  boundless.maximum_force_n = std::nan("");
  const auto refused = start_live(std::make_unique<PluggedDevice>(hardware, boundless));
  ASSERT_FALSE(refused);
  EXPECT_EQ(Refusal(refused), Refusal(ErrorCode::out_of_range, "maximum_force_n")) << refused.error().message;
  EXPECT_FALSE(hardware->is_open);
}

TEST(PluggedDevice, DrivesTheLockStepLoopThroughTheSameChain) {
  const Workplace place;
  const auto hardware = std::make_shared<Hardware>();
  PluggedDevice device(hardware);
  const Document document = rubber_handle();
  auto session = Session::make(document, "test", device.specification(), InstructionSet::baseline);
  ASSERT_TRUE(session) << session.error().message;
  auto writer = RecordingWriter::create(place.path("plugged.jsonl"), {device.specification(), document});
  ASSERT_TRUE(writer) << writer.error().message;
  Lockstep lockstep(session.value(), {&device, 4000, {}, {}, {}, 0, "test"}, &writer.value());
  ASSERT_TRUE(lockstep.run_to(400));
  EXPECT_GT(hardware->noticeable_ticks, 20U);
  std::uint64_t tick = lockstep.tick();
  for (const Fault fault : {Fault::silent, Fault::garbage}) {
    hardware->fault = fault;
    ASSERT_TRUE(lockstep.run_to(tick += 100));
    EXPECT_EQ(hardware->force_n, 0.0);
    EXPECT_FALSE(session->history.in_stroke());
    hardware->fault = Fault::none;
    const std::uint64_t before = hardware->noticeable_ticks;
    ASSERT_TRUE(lockstep.run_to(tick += 1400));
    EXPECT_GT(hardware->noticeable_ticks, before + 20);
  }
  ASSERT_TRUE(lockstep.finish());
  ASSERT_TRUE(writer->commit());
  EXPECT_EQ(hardware->faulty_ticks, 200U);
  EXPECT_NEAR(hardware->largest_n, plugged_limit_n, 1e-3);
  expect_harmless(*hardware);
  replay_to_the_same_states(place, "plugged.jsonl");
}

}  // namespace
}  // namespace spoonbill
