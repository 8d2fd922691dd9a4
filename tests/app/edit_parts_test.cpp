#include <gtest/gtest.h>

#include <set>

#include "app/edit/menu.h"
#include "app/edit/mouse.h"
#include "app/session/session.h"
#include "app/session/view_choice.h"
#include "engine/simulation/simulation.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

Snapshot handle_snapshot() {
  const auto simulation = Simulation::make(small_handle(), InstructionSet::baseline);
  EXPECT_TRUE(simulation);
  Snapshot snapshot;
  simulation->write_snapshot(snapshot);
  return snapshot;
}

Pointer pointer_with(bool left, bool middle, bool right, bool ctrl = false, bool shift = false) {
  Pointer pointer;
  pointer.left = left;
  pointer.middle = middle;
  pointer.right = right;
  pointer.ctrl = ctrl;
  pointer.shift = shift;
  return pointer;
}

TEST(Navigation, MovesAsTheProgramsItIsNamedAfter) {
  using Preset = NavigationPreset;
  using Motion = CameraMotion;
  EXPECT_EQ(camera_motion(Preset::rhino, pointer_with(false, false, true), true), Motion::orbit);
  EXPECT_EQ(camera_motion(Preset::rhino, pointer_with(false, false, true, false, true), true), Motion::pan);
  EXPECT_EQ(camera_motion(Preset::rhino, pointer_with(false, false, true, true), true), Motion::zoom);
  EXPECT_EQ(camera_motion(Preset::rhino, pointer_with(true, false, false), false), Motion::none);
  EXPECT_EQ(camera_motion(Preset::blender, pointer_with(false, true, false), true), Motion::orbit);
  EXPECT_EQ(camera_motion(Preset::blender, pointer_with(false, true, false, false, true), true), Motion::pan);
  EXPECT_EQ(camera_motion(Preset::sculptgl, pointer_with(true, false, false), false), Motion::orbit);
  EXPECT_EQ(camera_motion(Preset::sculptgl, pointer_with(true, false, false), true), Motion::none);
  EXPECT_EQ(camera_motion(Preset::sculptgl, pointer_with(false, true, false), true), Motion::pan);
  for (const char* name : navigation_names) EXPECT_TRUE(find_navigation(name));
  EXPECT_FALSE(find_navigation("maya"));
}

TEST(Navigation, PanningKeepsThePointUnderThePointer) {
  const Camera camera;
  const Viewport viewport = make_viewport(800, 600, {});
  const Vector3 point = Vector3::Zero();
  const auto before = project(camera, viewport, point);
  const Camera panned = move_camera_by(camera, CameraMotion::pan, {30.0, -20.0}, viewport);
  const auto after = project(panned, viewport, point);
  EXPECT_NEAR(after->x() - before->x(), 30.0, 1e-6);
  EXPECT_NEAR(after->y() - before->y(), -20.0, 1e-6);
}

TEST(Navigation, StaysWithinItsLimits) {
  const Viewport viewport = make_viewport(800, 600, {});
  Camera camera;
  for (int i = 0; i < 500; ++i)
    camera = zoom_camera(move_camera_by(camera, CameraMotion::orbit, {5, 50}, viewport), 3.0);
  EXPECT_LT(camera.pitch_rad, 1.5708);
  EXPECT_GE(camera.distance_m, 0.005);
}

TEST(SurfacePick, FindsWhereASphereFirstTouches) {
  SurfacePick pick;
  pick.update(handle_snapshot());
  const Ray down{Vector3(0.03, 0.1, 0.0), -Vector3::UnitY()};
  const auto touch = pick.first_touch(down, 0.006);
  ASSERT_TRUE(touch);
  // The section rises about 2.65 mm above the centre line. first_touch() finds where the sphere touches one
  // of the balls around sample points of the surface. The radius of these balls is at most half the diagonal
  // of a cell of 1 mm.
  EXPECT_NEAR(touch->centre_m.y(), 0.0025 + 0.006, 1e-3);
  EXPECT_GT(touch->outward.y(), 0.99);
  EXPECT_FALSE(pick.first_touch({Vector3(0.03, 0.1, 0.05), -Vector3::UnitY()}, 0.006));
}

TEST(MouseHand, HoversPressesAndLetsGo) {
  const Snapshot snapshot = handle_snapshot();
  SurfacePick pick;
  pick.update(snapshot);
  Camera camera;
  camera.target_m = Vector3(0.03, 0, 0);
  camera.distance_m = 0.3;
  camera.pitch_rad = 1.5;
  const Viewport viewport = make_viewport(800, 600, {});
  const MouseStroke stroke{0.006, 0.004, false};
  MouseHand hand(Vector3(0.03, 0, 0));
  Pointer pointer;
  const auto follow = [&](bool held) {
    hand.set_frame({pointer, held, camera, viewport, &pick, stroke});
    return hand.next_target({}, 1.0 / 60.0);
  };
  pointer.position_px = *project(camera, viewport, Vector3(0.03, 0.0025, 0));
  const HandTarget hover = follow(false);
  EXPECT_TRUE(hand.on_model());
  EXPECT_GT(hover.pose.position_m.y(), 0.0025 + 0.006);  // the tool hovers above the surface
  HandTarget pressed;
  for (int frame = 0; frame < 30; ++frame) pressed = follow(true);
  EXPECT_NEAR((hover.pose.position_m - pressed.pose.position_m).norm(), 0.005,
              1e-4);  // the hover gap of 1 mm plus the strength of 4 mm
  pointer.wheel = 2.0;
  const HandTarget deeper = follow(true);
  EXPECT_NEAR((deeper.pose.position_m - pressed.pose.position_m).norm(), 0.002, 1e-9);
  pointer.wheel = 0.0;
  hand.release_press();
  EXPECT_EQ(follow(true).pose.position_m, hover.pose.position_m);
  EXPECT_FALSE(hand.is_pressing());
  follow(false);
  follow(true);
  EXPECT_TRUE(hand.is_pressing());
}

TEST(KeyBindings, NoChordMeansTwoThings) {
  std::set<std::tuple<int, bool, bool>> chords;
  for (const KeyBinding& binding : key_bindings()) {
    EXPECT_TRUE(chords.insert({binding.key, binding.ctrl, binding.shift}).second) << binding.chord;
  }
}

TEST(Request, ReadsWhatItWrites) {
  ViewChoice view;
  view.shows_whole_body = false;
  const Request requests[] = {Command(KeepShape{}),
                              UndoStroke{},
                              RedoStroke{},
                              CancelStroke{},
                              ChangeView{camera_command(view)},
                              ChangeView{overlays_command(view.overlays, true)},
                              MarkFile{FileMarkKind::document, "bent-1"},
                              MarkFile{FileMarkKind::picture, "bent_2"}};
  for (const Request& request : requests) {
    const Json json = request_to_json(request);
    const auto read = request_from_json({0, json, "test"});
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->index(), request.index());
    EXPECT_EQ(request_to_json(read.value()), json);
  }
}

TEST(Request, AMarksNameCannotLeaveItsFolder) {
  for (const char* name : {"../x", "a/b", "", "a b", "a.json"}) {
    EXPECT_FALSE(request_from_json({0, Json{{"command", "save"}, {"name", name}}, "test"})) << name;
  }
  EXPECT_EQ(make_mark_name("../my model"), "---my-model");
  EXPECT_EQ(make_mark_name(""), "unnamed");
}

TEST(ViewChoice, WritesNothingThatItWouldRefuse) {
  ViewChoice choice;
  choice.shows_whole_body = false;
  choice.camera.target_m = Vector3(1e4, -1e4, 0.0);
  choice.camera.distance_m = 1e4;
  choice.camera.yaw_rad = 1e3;
  EXPECT_TRUE(view_from_json(view_to_json(choice), "test"));
}

TEST(ViewChoice, ReadsWhatItWrites) {
  ViewChoice choice;
  choice.camera.yaw_rad = 0.7;
  choice.camera.pitch_rad = -0.3;
  choice.camera.target_m = Vector3(0.01, 0.02, -0.03);
  choice.shows_whole_body = false;
  choice.overlays.lattice = true;
  choice.see_through_body = true;
  choice.ground_y_m = -0.04;
  const auto read = view_from_json(view_to_json(choice), "test");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(view_to_json(read.value()), view_to_json(choice));
  EXPECT_NEAR(read->camera.yaw_rad, 0.7, 1e-12);
  EXPECT_TRUE(read->overlays.lattice);
}

}  // namespace
}  // namespace spoonbill
