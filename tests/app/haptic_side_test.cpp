#include "app/live/haptic_side.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <thread>

#include "app/program.h"
#include "haptic/virtual_device.h"
#include "tests/app/workplace.h"
#include "tests/engine/allocations.h"
#include "tests/engine/random.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

HandTarget at_height(double y_m, std::uint32_t buttons = 0) {
  return {{Vector3(0.05, y_m, 0.0), Quaternion::Identity()}, buttons};
}

// The virtual device with a sensor that fails now and then.
class FailingSensor : public Device {
 public:
  explicit FailingSensor(std::unique_ptr<Device> device) : device_(std::move(device)) {}
  const DeviceSpecification& specification() const override { return device_->specification(); }
  void set_force(const Vector3& force_n) override { device_->set_force(force_n); }

  std::optional<DeviceReading> read() override {
    std::optional<DeviceReading> reading = device_->read();
    ++tick_;
    if (tick_ % 97 == 0) return {};
    if (tick_ % 131 == 0) reading->position_nm[1] += 45'000'000;
    if (tick_ % 173 == 0) return DeviceReading::from({Vector3::Constant(std::nan("")), {}}, 0);
    return reading;
  }

 private:
  std::unique_ptr<Device> device_;
  std::uint64_t tick_ = 0;
};

// The haptic thread's part of a live session, called on the test's thread, whose allocations are counted.
class Side {
 public:
  explicit Side(bool sensor_fails = false, const Document& document = held_handle()) {
    auto session =
        Session::make(document, "test", VirtualDevice::default_specification(), InstructionSet::baseline);
    EXPECT_TRUE(session);
    auto made = std::make_unique<Session>(std::move(session).value());
    LiveFrame first;
    write_snapshot(*made, first.snapshot);
    write_facts(*made, first.facts);
    const LiveScene scene{made->title, make_session_document(*made).scene};
    journal_.emplace(notices_, scene);
    worker_.emplace(notices_);
    exchange_.emplace(first);
    auto steered = SteeredDevice::make(Hand{}, at_height(0.03)).value();
    mailbox_ = steered->mailbox();
    std::unique_ptr<Device> device = std::move(steered);
    if (sensor_fails) device = std::make_unique<FailingSensor>(std::move(device));
    side_.emplace(std::move(made), std::move(device), *exchange_, *journal_, *worker_);
  }

  void aim(const HandTarget& target) { mailbox_->aim(target); }
  void ask(Request request) {
    Json json = request_to_json(request);
    ASSERT_TRUE(exchange_->commands.push(QueuedRequest{std::move(request), std::move(json)}));
  }
  void begin_recording(const std::filesystem::path& file) {
    const SessionJob work = [file](LentSession& lent) {
      auto recording =
          RecordingWriter::create(file, {lent.session->device, make_session_document(*lent.session)});
      if (!recording) return Status(recording.error());
      auto restarted = Session::make(make_session_document(*lent.session), "test", lent.session->device,
                                     InstructionSet::baseline);
      if (!restarted) return Status(restarted.error());
      lent.session = std::make_unique<Session>(std::move(restarted).value());
      lent.is_new_session = true;
      lent.recording = std::make_unique<RecordingWriter>(std::move(recording).value());
      return Status();
    };
    ASSERT_TRUE(exchange_->commands.push(QueuedJob{work, true}));
    for (int i = 0; i < 300'000 && !frame().recording; ++i) {
      tick(4);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(frame().recording);
  }

  void cut_force() { exchange_->force_cut.store(true); }

  // Ends the session and its recording.
  void close() {
    side_->close();
    journal_->stop();
  }

  // Runs ticks. Returns the number of heap allocations during these ticks.
  std::size_t tick(int count, std::uint64_t dropped = 0) {
    const std::size_t before = allocation_count();
    for (int i = 0; i < count; ++i) side_->tick({index_++, dropped});
    return allocation_count() - before;
  }

  const LiveFrame& frame() {
    exchange_->frames.update_reading();
    return exchange_->frames.reading();
  }

 private:
  Notices notices_;
  std::optional<Journal> journal_;
  std::optional<SessionWorker> worker_;
  std::optional<LiveExchange> exchange_;
  std::shared_ptr<TargetMailbox> mailbox_;
  std::optional<HapticSide> side_;
  std::uint64_t index_ = 0;
};

TEST(HapticSide, TicksStrokesAndLightCommandsAllocateNothing) {
  const Workplace place;
  Side side;
  side.begin_recording(place.path("live.jsonl"));
  side.tick(2000);  // the first ticks fill every buffer
  side.aim(at_height(0.004));
  bool in_stroke = false;
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(side.tick(1), 0U) << i;
    in_stroke = in_stroke || side.frame().facts.in_stroke;
  }
  EXPECT_TRUE(in_stroke);
  Tool tool = small_handle().tool;
  tool.radius_m = 0.005;
  side.ask(Command(SetTool{tool}));
  side.ask(CancelStroke{});
  side.ask(ChangeView{camera_command(ViewChoice())});
  EXPECT_EQ(side.tick(50), 0U);
  side.aim(at_height(0.03));
  EXPECT_EQ(side.tick(1500), 0U);  // these ticks include a state hash
  side.ask(UndoStroke{});
  side.ask(RedoStroke{});
  EXPECT_EQ(side.tick(100), 0U);
  EXPECT_EQ(side.tick(5, 40), 0U);  // dropped ticks reset the proxy
}

// A stroke that the control net cannot follow: the surface is refined while the stroke goes on. Every tick
// advances the session, none allocates, and the recording has the refinement at its tick.
TEST(HapticSide, RefinesDuringAStrokeWithoutSkippingATick) {
  const Workplace place;
  Document document{"fine handle", small_handle(), Json::object()};
  document.scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  document.scene.tool.kind = ToolKind::point;
  Side side(false, document);
  side.begin_recording(place.path("refined.jsonl"));
  side.tick(2000);
  const auto columns = [&] { return side.frame().snapshot.bodies[0].surface.v.control_point_count(); };
  const auto rows = [&] { return side.frame().snapshot.bodies[0].surface.u.control_point_count(); };
  const int first_columns = columns(), first_rows = rows();
  std::uint64_t ticks = side.frame().snapshot.tick;
  bool is_refined_in_stroke = false;
  for (int i = 0; i < 20'000 && !is_refined_in_stroke; ++i) {
    // The clay gives way, so that only a hand that goes on keeps touching it.
    side.aim(at_height(0.0005 - 5e-6 * i, button_main));
    EXPECT_EQ(side.tick(4), 0U) << i;
    ASSERT_EQ(side.frame().snapshot.tick, ticks += 4);
    is_refined_in_stroke = side.frame().facts.in_stroke && (columns() > first_columns || rows() > first_rows);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(is_refined_in_stroke);
  side.tick(200);
  side.aim(at_height(0.03));
  side.tick(400);
  side.ask(UndoStroke{});
  for (int i = 0; i < 20'000 && columns() + rows() != first_columns + first_rows; ++i) {
    side.tick(4);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(columns(), first_columns);
  EXPECT_EQ(rows(), first_rows);
  side.tick(100);
  side.close();
  const auto recording = read_recording(place.path("refined.jsonl"));
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_TRUE(
      std::any_of(recording->commands.begin(), recording->commands.end(),
                  [](const TimedCommand& timed) { return timed.command["command"] == "refine_knots"; }));
  const Outcome replayed = run({"replay", place.text("refined.jsonl"), "--no-frames"});
  EXPECT_EQ(replayed.code, exit_done) << replayed.err;
}

TEST(HapticSide, ARecordingWithFaultsAndMissedTicksReplaysToItsOwnStates) {
  const Workplace place;
  Side side(true);
  side.begin_recording(place.path("faults.jsonl"));
  Random random(24);
  double highest_n = 0.0;
  for (int k = 0; k < 3000; ++k) {
    if (k % 250 == 0) side.aim(at_height(k % 500 == 0 ? 0.004 : 0.03));
    if (k == 1200) side.cut_force();
    if (k == 1700) side.ask(SwitchForce{true});
    const std::uint64_t dropped = random.once_in(20) ? random.bits() % 8 : random.once_in(400) ? 20 : 0;
    side.tick(1, dropped);
    highest_n = std::max(highest_n, side.frame().snapshot.force_n.norm());
  }
  side.close();
  EXPECT_GT(highest_n, 0.1);
  const auto recording = read_recording(place.path("faults.jsonl"));
  ASSERT_TRUE(recording) << recording.error().message;
  std::map<std::string, int> commands;
  for (const TimedCommand& timed : recording->commands)
    ++commands[timed.command["command"].get<std::string>()];
  EXPECT_EQ(commands["switch_force"], 2);
  EXPECT_GT(commands["reset_proxy"], 30);
  EXPECT_GT(recording->missed, 300U);
  const Outcome replayed =
      run({"replay", place.text("faults.jsonl"), "--no-frames", "--rerecord", place.text("again.jsonl")});
  EXPECT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_TRUE(content_of(place.path("again.jsonl")) == content_of(place.path("faults.jsonl")));
}

TEST(HapticSide, ATargetThatIsNotFiniteIsNotFollowed) {
  Side side;
  side.tick(20);
  const Vector3 before = side.frame().snapshot.tool.device.position_m;
  HandTarget broken = at_height(0.0);
  broken.pose.position_m.x() = std::nan("");
  side.aim(broken);
  side.tick(100);
  EXPECT_LT((side.frame().snapshot.tool.device.position_m - before).norm(), 1e-6);
}

TEST(HapticSide, AfterALoanTheForceComesBackByTheRamp) {
  Side side;
  side.tick(1500);
  EXPECT_EQ(side.frame().safety_flags, 0U);
  side.ask(Command(PlacePlane{{Vector3(0.025, 0, 0), Vector3::UnitX()}}));
  side.tick(1);
  for (int i = 0; i < 300'000 && side.frame().snapshot.planes.size() != 2; ++i) {
    side.tick(4);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(side.frame().snapshot.planes.size(), 2U);
  EXPECT_NE(side.frame().safety_flags, 0U);
}

}  // namespace
}  // namespace spoonbill
