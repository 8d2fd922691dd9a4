// First strokes and drags in the window with real mouse events, measured from what the window recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "app/panel/panel.h"
#include "app/program.h"
#include "app/session/lockstep.h"
#include "engine/bspline/evaluate.h"
#include "haptic/recording.h"
#include "haptic/virtual_device.h"
#include "render/camera.h"
#include "tests/app/edit_window.h"
#include "tests/app/first_stroke.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

constexpr int width_px = 1280, height_px = 720;
constexpr double degrees = 180.0 / std::numbers::pi;

// A session that a window has recorded, replayed to chosen ticks. The replay compares the recorded states.
class Replayed {
 public:
  explicit Replayed(const std::filesystem::path& file)
      : recording_(read_recording(file).value()),
        device_(recording_.header.device, recording_.readings),
        session_(Session::make(recording_.header.document, "replay", recording_.header.device,
                               best_instruction_set())
                     .value()) {
    session_.reading = recording_.readings.front();
    LockstepInput input;
    input.device = &device_;
    input.tick_count = recording_.readings.size();
    input.commands = recording_.commands;
    input.expected = recording_.checkpoints;
    input.source = file.string();
    lockstep_.emplace(session_, std::move(input), nullptr);
    for (std::uint64_t t = 0; t < recording_.readings.size(); ++t) {
      if ((recording_.readings[t].buttons & button_main) == 0) continue;
      if (!pressed_) pressed_ = t;
      released_ = t + 1;
    }
  }

  void run_to(std::uint64_t tick) {
    const Status ran = lockstep_->run_to(tick);
    ASSERT_TRUE(ran) << ran.error().message;
  }
  std::uint64_t ticks() const { return recording_.readings.size(); }
  // First tick with the button down, and first tick after the last with it.
  std::uint64_t pressed() const { return pressed_.value_or(0); }
  std::uint64_t released() const { return released_; }
  Vector3 hand_m(std::uint64_t tick) const { return recording_.readings[tick].pose().position_m; }
  const Surface& surface() const { return session_.simulation.surface(); }
  const Scene& scene() const { return session_.simulation.scene(); }
  Vector3 tool_m() const {
    Snapshot snapshot;
    write_snapshot(session_, snapshot);
    return snapshot.tool.proxy.position_m;
  }

 private:
  Recording recording_;
  PlaybackDevice device_;
  Session session_;
  std::optional<Lockstep> lockstep_;
  std::optional<std::uint64_t> pressed_;
  std::uint64_t released_ = 0;
};

Viewport window_viewport() {
  return make_viewport(width_px, height_px, panel_rectangle(width_px, height_px, 1.0));
}

class FirstStrokeWindow : public EditWindow, public testing::WithParamInterface<std::size_t> {
 protected:
  // Sets the strength of presses by a horizontal drag with F and Shift.
  void set_strength(double strength_m) const {
    constexpr double first_m = 0.004, growth_per_px = 0.01;
    const int drag_px = static_cast<int>(std::lround(std::log(strength_m / first_m) / growth_per_px));
    if (drag_px == 0) return;
    ASSERT_TRUE(move_to(900, 200));
    ASSERT_TRUE(hands("keydown shift keydown f"));
    ASSERT_TRUE(wait_frames(2));
    ASSERT_TRUE(move_to(900 + drag_px, 200));
    ASSERT_TRUE(wait_frames(2));
    ASSERT_TRUE(hands("keyup f keyup shift"));
    ASSERT_TRUE(wait_frames(2));
  }
};

// The camera looks straight at the place that the mouse presses, in the centre of the picture.
TEST_P(FirstStrokeWindow, ShowsUnderTheToolAndStaysInClay) {
  const FirstShape& shape = first_shapes()[GetParam()];
  Document document = make_first_document(shape, place_.path(""));
  const PressedPoint aimed(document.scene.bodies[0].surface, shape.above_m);
  const Vector3 towards_eye = aimed.normal();
  Json camera;
  for (int axis = 0; axis < 3; ++axis) camera["target_mm"].push_back(1e3 * aimed.start_m()[axis]);
  camera["distance_mm"] = 250.0;
  camera["yaw_deg"] = std::atan2(towards_eye.x(), towards_eye.z()) * degrees;
  camera["pitch_deg"] = std::min(89.0, std::asin(towards_eye.y()) * degrees);
  document.view["camera"] = camera;
  ASSERT_TRUE(write_document(document, place_.path("shape.json")));
  start({place_.text("shape.json"), "--record", place_.text("session.jsonl")});
  set_strength(shape.travel_m());
  const Rectangle free_px = window_viewport().free_px;
  const int x = static_cast<int>(std::lround(free_px.x + 0.5 * free_px.width));
  const int y = static_cast<int>(std::lround(free_px.y + 0.5 * free_px.height));
  ASSERT_TRUE(move_to(x, y));
  ASSERT_TRUE(press_button());
  ASSERT_TRUE(wait_ticks(1300));
  ASSERT_TRUE(release_button());
  ASSERT_TRUE(move_to(x, 60));
  ASSERT_TRUE(wait_ticks(1200));
  save_and_quit("shape.json");

  Replayed replayed(place_.path("session.jsonl"));
  ASSERT_GT(replayed.released(), replayed.pressed());
  ASSERT_GE(replayed.ticks(), replayed.released() + 1000);
  const Surface rest = document.scene.bodies[0].surface;
  const double radius_m = document.scene.tool.radius_m;
  const Vector3 from_m = replayed.hand_m(replayed.pressed() - 1),
                to_m = replayed.hand_m(replayed.released() - 1);
  const PressedPoint pressed(rest, from_m);
  const double travel_m = radius_m - (to_m - pressed.start_m()).dot(pressed.normal());
  // The imitated hand gives way to the force, which lasts while the surface is behind the material.
  EXPECT_NEAR(travel_m, shape.travel_m(), 0.3 * shape.travel_m());
  replayed.run_to(replayed.released());
  EXPECT_LT(std::abs(find_gap_m(replayed.surface(), replayed.tool_m(), radius_m)), 0.1 * travel_m);
  replayed.run_to(replayed.released() + 1000);
  const double kept_m = pressed.find_depth_m(replayed.surface(), 3.0 * radius_m);
  EXPECT_GT(kept_m, 0.7 * travel_m);
  EXPECT_LT(kept_m, 1.2 * travel_m);
}

// The shapes that the quick run presses.
std::vector<std::size_t> pressed_shapes() {
  if (!is_full_run()) return {0, 6};
  std::vector<std::size_t> all(first_shapes().size());
  for (std::size_t s = 0; s < all.size(); ++s) all[s] = s;
  return all;
}

INSTANTIATE_TEST_SUITE_P(Shapes, FirstStrokeWindow, testing::ValuesIn(pressed_shapes()),
                         [](const auto& shape) { return first_shape_name(shape.param); });

class DraggedHandle : public EditWindow {
 protected:
  struct Drag {
    double hand_m = 0.0;      // travel of the hand, from the touch to the end of the hold
    double moved_m = 0.0;     // of the pressed point, at the end of the hold
    double farthest_m = 0.0;  // largest of it before
    double slipped_m = 0.0;   // of the tool from the pressed point, at the end of the hold
    double kept_m = 0.0;      // 2 s after the release
  };

  // Presses 10 mm from the free end of the handle, drags 130 pixels down in a time and holds for a second.
  Drag drag(double seconds) {
    Document document = read_document(SPOONBILL_ASSETS "/models/spoon-handle.json").value();
    document.scene.planes = {{Vector3(0.04, 0, 0), Vector3::UnitX()}};
    EXPECT_TRUE(write_document(document, place_.path("handle.json")));
    std::filesystem::remove(place_.path("drag.jsonl"));
    start({place_.text("handle.json"), "--record", place_.text("drag.jsonl")});
    constexpr int x = 1035, y = 307;
    EXPECT_TRUE(move_to(x, y));
    EXPECT_TRUE(press_button());
    constexpr int dragged_px = 130;
    const auto begin = std::chrono::steady_clock::now();
    for (double part = 0.0; part < 1.0;) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
      part = std::min(1.0, passed.count() / seconds);
      EXPECT_TRUE(hands("mousemove " + std::to_string(x) + " " +
                        std::to_string(y + static_cast<int>(std::lround(dragged_px * part)))));
    }
    EXPECT_TRUE(wait_ticks(1000));
    EXPECT_TRUE(release_button());
    EXPECT_TRUE(move_to(x, 60));
    EXPECT_TRUE(wait_ticks(2100));
    save_and_quit("handle.json");

    Replayed replayed(place_.path("drag.jsonl"));
    const double radius_m = document.scene.tool.radius_m;
    const PressedPoint pressed(document.scene.bodies[0].surface, replayed.hand_m(replayed.pressed() - 1));
    EXPECT_NEAR(pressed.start_m().x(), 0.09, 0.002);
    Drag drag;
    const auto moved_m = [&] { return (pressed.position_m(replayed.surface()) - pressed.start_m()).norm(); };
    for (std::uint64_t t = replayed.pressed(); t < replayed.released(); t += 10) {
      replayed.run_to(t);
      drag.farthest_m = std::max(drag.farthest_m, moved_m());
    }
    replayed.run_to(replayed.released());
    drag.moved_m = moved_m();
    const Vector3 touched_m = pressed.start_m() + radius_m * pressed.normal();
    drag.slipped_m =
        (replayed.tool_m() - touched_m - pressed.position_m(replayed.surface()) + pressed.start_m()).norm();
    drag.hand_m = (replayed.hand_m(replayed.released() - 1) - touched_m).norm();
    replayed.run_to(replayed.released() + 2000);
    drag.kept_m = moved_m();
    return drag;
  }
};

TEST_F(DraggedHandle, FollowsTheHandWithoutSwinging) {
  double least_m = HUGE_VAL, most_m = 0.0;
  for (const double seconds : {1.0, 0.5, 3.0}) {
    if (seconds != 1.0 && !is_full_run()) continue;
    SCOPED_TRACE(seconds);
    const Drag dragged = drag(seconds);
    EXPECT_GT(dragged.hand_m, 0.01);
    EXPECT_NEAR(dragged.moved_m, dragged.hand_m, 0.2 * dragged.hand_m);
    EXPECT_LT(dragged.farthest_m, 1.1 * dragged.moved_m);
    EXPECT_GT(dragged.kept_m, 0.65 * dragged.moved_m);
    // A tool held by friction alone slips by 1.4 mm.
    EXPECT_LT(dragged.slipped_m, 4e-4);
    least_m = std::min(least_m, dragged.moved_m);
    most_m = std::max(most_m, dragged.moved_m);
    RecordProperty("drag_" + std::to_string(seconds), std::to_string(dragged.moved_m));
  }
  EXPECT_LT(most_m, 1.1 * least_m);
}

}  // namespace
}  // namespace spoonbill
