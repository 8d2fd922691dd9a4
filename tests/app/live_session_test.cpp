#include "app/live/live_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>

#include "app/files/content_hash.h"
#include "app/files/documents.h"
#include "app/program.h"
#include "engine/material/lattice_solver.h"
#include "haptic/recording.h"
#include "haptic/safe_device.h"
#include "haptic/virtual_device.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/app/wait_for.h"
#include "tests/app/workplace.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

HandTarget at(double x_m, double y_m) {
  return {{Vector3(x_m, y_m, 0.0), Quaternion::Identity()}, 0};
}

// A live session with the virtual device.
class Live {
 public:
  explicit Live(const Document& document) {
    auto device = SteeredDevice::make(Hand{}, at(0.05, 0.03)).value();
    mailbox_ = device->mailbox();
    LiveSettings settings;
    settings.real_time = false;
    auto session = LiveSession::start(document, "test", settings, std::move(device));
    EXPECT_TRUE(session) << session.error().message;
    session_ = std::move(session).value();
  }

  void aim(const HandTarget& target) { mailbox_->aim(target); }
  LiveSession& operator*() { return *session_; }
  LiveSession* operator->() { return session_.get(); }

 private:
  std::shared_ptr<TargetMailbox> mailbox_;
  std::unique_ptr<LiveSession> session_;
};

void wait_ticks(LiveSession& live, std::uint64_t ticks) {
  const std::uint64_t from = live.frame().snapshot.tick;
  EXPECT_TRUE(wait_for(live, [&](const LiveFrame& frame) { return frame.snapshot.tick >= from + ticks; }));
}

double tip_height_m(const LiveFrame& frame) {
  const LatticeSnapshot& lattice = frame.snapshot.bodies[0].lattice;
  double lowest = 1.0;
  for (const float y : lattice.y) lowest = std::min(lowest, static_cast<double>(y));
  return lowest;
}

// Presses the end of the handle down by more than a millimetre, in 100 ticks at least, and releases it. The
// hand moves slowly: at once, on a busy machine, it would move so far from tick to tick that it slips past
// the handle.
void stroke(Live& live) {
  const double before = tip_height_m(live->frame());
  for (int step = 0; step <= 10; ++step) {
    live.aim(at(0.05, 0.02 - 0.002 * step));
    wait_ticks(*live, 10);
  }
  ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) { return tip_height_m(frame) < before - 1e-3; }));
  live.aim(at(0.05, 0.03));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return !frame.facts.in_stroke; }));
}

TEST(LiveSession, AStrokeIsUndoneAndRedone) {
  Live live(held_handle());
  const double before = tip_height_m(live->frame());
  stroke(live);
  wait_ticks(*live, 300);
  const double after = tip_height_m(live->frame());
  EXPECT_LT(after, before - 1e-4);
  ASSERT_TRUE(live->frame().facts.can_undo);
  ASSERT_TRUE(live->ask(UndoStroke{}));
  EXPECT_TRUE(
      wait_for(*live, [&](const LiveFrame& frame) { return std::abs(tip_height_m(frame) - before) < 1e-6; }));
  ASSERT_TRUE(live->ask(RedoStroke{}));
  EXPECT_TRUE(
      wait_for(*live, [&](const LiveFrame& frame) { return std::abs(tip_height_m(frame) - after) < 1e-4; }));
}

TEST(LiveSession, ACancelledStrokeLeavesNothingAndTheToolActsAgainOnceItHasLeft) {
  // Rubber stays in contact with the tool. Clay would yield at the first touch and lose contact, which would
  // end the stroke.
  Document rubber = held_handle();
  rubber.scene.bodies[0].material.plastic = false;
  rubber.scene.bodies[0].lattice = small_handle().bodies[0].lattice;  // does not bend out of the tool's way
  Live live(rubber);
  const double before = tip_height_m(live->frame());
  live.aim(at(0.05, 0.0));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.facts.in_stroke; }));
  wait_ticks(*live, 60);
  ASSERT_TRUE(live->ask(CancelStroke{}));
  EXPECT_TRUE(
      wait_for(*live, [&](const LiveFrame& frame) { return std::abs(tip_height_m(frame) - before) < 1e-6; }));
  wait_ticks(*live, 50);
  EXPECT_NEAR(tip_height_m(live->frame()), before, 1e-6);
  live.aim(at(0.05, 0.03));
  wait_ticks(*live, 200);
  stroke(live);
}

TEST(LiveSession, WhatRebuildsIsDoneWhileTheLoopGoesOn) {
  Live live(Document{"small handle", small_handle(), Json::object()});
  ASSERT_TRUE(live->ask(Command(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}})));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.snapshot.planes.size() == 1; }));
  Material stiffer = small_handle().bodies[0].material;
  stiffer.poissons_ratio = 0.3;
  ASSERT_TRUE(live->ask(Command(SetMaterial{stiffer})));
  EXPECT_TRUE(
      wait_for(*live, [](const LiveFrame& frame) { return frame.facts.material.poissons_ratio == 0.3; }));
}

TEST(LiveSession, ARefusedRequestIsSaidAndChangesNothing) {
  Live live(held_handle());
  Material wrong = small_handle().bodies[0].material;
  wrong.poissons_ratio = 0.7;
  ASSERT_TRUE(live->ask(Command(SetMaterial{wrong})));
  std::vector<Notice> notices;
  EXPECT_TRUE(wait_for(*live, [&](const LiveFrame&) {
    for (Notice& notice : live->consume_notices()) {
      if (notice.kind == Notice::Kind::problem) notices.push_back(std::move(notice));
    }
    return !notices.empty();
  }));
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].text.find("poissons_ratio"), std::string::npos) << notices[0].text;
  wait_ticks(*live, 10);
  EXPECT_NE(live->frame().facts.material.poissons_ratio, 0.7);
}

// Returns a handle of this stiffness. Its material is plastic, so the handle is simulated as a mass-spring
// lattice with explicit time steps.
Document handle_of_stiffness(double youngs_modulus_pa, bool real_time) {
  Document document = held_handle();
  document.scene.bodies[0].material.plastic = true;
  document.scene.bodies[0].material.youngs_modulus_pa = youngs_modulus_pa;
  document.scene.sculpting.real_time = real_time;
  return document;
}

TEST(LiveSession, RunsInRealTimeWhereATickHasTheTime) {
  Live live(handle_of_stiffness(1e3, false));
  const LiveFrame& first = live->frame();
  ASSERT_LE(first.snapshot.real_time_substeps, live_substeps_limit);
  Sculpting sculpting = first.facts.sculpting;
  sculpting.real_time = true;
  ASSERT_TRUE(live->ask(Command(SetSculpting{sculpting})));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) {
    return frame.facts.sculpting.real_time && frame.snapshot.bodies[0].material.inertia_scale == 1.0;
  }));
  // A new material may need more substeps, so it switches real time off.
  Material stiffer = first.facts.material;
  stiffer.youngs_modulus_pa = 1e8;
  ASSERT_TRUE(live->ask(Command(SetMaterial{stiffer})));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) {
    return frame.facts.material.youngs_modulus_pa == 1e8 && !frame.facts.sculpting.real_time;
  }));
}

TEST(LiveSession, RefusesRealTimeThatATickHasNoTimeFor) {
  Live live(handle_of_stiffness(1e8, false));
  Sculpting sculpting = live->frame().facts.sculpting;
  sculpting.real_time = true;
  live->consume_notices();
  ASSERT_TRUE(live->ask(Command(SetSculpting{sculpting})));
  const std::vector<Notice> notices = live->consume_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0].text,
            "this material needs " + std::to_string(live->last_frame().snapshot.real_time_substeps) +
                " substeps a tick in real time; a live session can take 32; a replay can take any number");
  wait_ticks(*live, 10);
  EXPECT_FALSE(live->frame().facts.sculpting.real_time);
}

TEST(LiveSession, OpensADocumentThatNeedsTooManySubstepsWithRealTimeOff) {
  Live live(handle_of_stiffness(1e8, true));
  EXPECT_FALSE(live->frame().facts.sculpting.real_time);
  const std::vector<Notice> notices = live->consume_notices();
  const auto is_off = [](const Notice& notice) { return notice.text.starts_with("real time is off: "); };
  EXPECT_EQ(std::count_if(notices.begin(), notices.end(), is_off), 1);
}

TEST(LiveSession, SavesWhatTheShapeIsNow) {
  const Workplace place;
  Live live(held_handle());
  stroke(live);
  ASSERT_TRUE(live->save(place.path("bent.json")));
  EXPECT_TRUE(wait_for(*live, [&](const LiveFrame&) { return live->consume_saved_document().has_value(); }));
  const auto saved = read_document(place.path("bent.json"));
  ASSERT_TRUE(saved) << saved.error().message;
  double lowest = 1.0, lowest_before = 1.0;
  for (const double y : saved->scene.bodies[0].surface.net.y) lowest = std::min(lowest, y);
  const Scene before = small_handle();
  for (const double y : before.bodies[0].surface.net.y) lowest_before = std::min(lowest_before, y);
  EXPECT_LT(lowest, lowest_before - 1e-4);
  EXPECT_EQ(saved->scene.planes.size(), 1U);
}

std::string next_notice(LiveSession& live, Notice::Kind kind) {
  std::string text;
  EXPECT_TRUE(wait_for(live, [&](const LiveFrame&) {
    for (const Notice& notice : live.consume_notices()) {
      if (notice.kind == kind && notice.text.find("export") != std::string::npos) text = notice.text;
    }
    return !text.empty();
  }));
  return text;
}

TEST(LiveSession, ExportsAMeshWhichSavesNothing) {
  const Workplace place;
  setenv("XDG_STATE_HOME", place.text("state").c_str(), 1);
  Live live(held_handle());
  stroke(live);
  ASSERT_TRUE(live->save(place.path("bent.stl")));
  EXPECT_EQ(next_notice(*live, Notice::Kind::information), "exported bent.stl, in mm");
  EXPECT_FALSE(live->consume_saved_document().has_value());
  // A binary STL file has a header of 80 bytes, a count of 4 bytes and 50 bytes per triangle.
  std::ifstream in(place.path("bent.stl"), std::ios::binary);
  std::uint32_t triangles = 0;
  in.seekg(80);
  in.read(reinterpret_cast<char*>(&triangles), sizeof triangles);
  EXPECT_GT(triangles, 100U);
  EXPECT_EQ(std::filesystem::file_size(place.path("bent.stl")), 84U + 50U * triangles);
  EXPECT_FALSE(std::filesystem::exists(place.path("state")));
  ASSERT_TRUE(live->save(place.path("no such folder/bent.stl")));
  EXPECT_EQ(next_notice(*live, Notice::Kind::problem).substr(0, 14), "not exported: ");
}

bool waits_for_save(LiveSession& live) {
  return wait_for(live, [&](const LiveFrame&) { return live.consume_saved_document().has_value(); });
}

bool waits_for_conflict(LiveSession& live) {
  return wait_for(live, [&](const LiveFrame&) { return live.consume_save_conflict().has_value(); });
}

TEST(LiveSession, AFileThatChangedOnTheDiskIsNotReplacedUnasked) {
  const Workplace place;
  const auto file = place.path("model.json");
  Live live(held_handle());
  live->set_known_content(file_content_hash(file));
  // A repeated save is no conflict, because the session knows the content of its last save.
  for (int n = 0; n < 2; ++n) {
    ASSERT_TRUE(live->save(file));
    EXPECT_TRUE(waits_for_save(*live));
  }
  std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now());
  ASSERT_TRUE(live->save(file));
  EXPECT_TRUE(waits_for_save(*live));
  std::ofstream(file, std::ios::app) << " ";
  const std::string theirs = content_of(file);
  ASSERT_TRUE(live->save(file));
  EXPECT_TRUE(waits_for_conflict(*live));
  EXPECT_EQ(content_of(file), theirs);
  EXPECT_FALSE(live->consume_saved_document().has_value());
  ASSERT_TRUE(live->save(file, Replaced::any));
  EXPECT_TRUE(waits_for_save(*live));
  EXPECT_EQ(content_of(file.string() + ".bak"), theirs);
  // The file of another document, named by mistake, is not replaced either.
  const auto other = place.write("other.json", "theirs");
  ASSERT_TRUE(live->save(other));
  EXPECT_TRUE(waits_for_conflict(*live));
  EXPECT_EQ(content_of(other), "theirs");
}

// A save is requested while the first document is still shown, but after another document was requested. The
// save must not write the other document to the file of the first.
TEST(LiveSession, ASaveDoesNotPassToADocumentThatWasOpenedMeanwhile) {
  const Workplace place;
  Live live(held_handle());
  Document other = held_handle();
  other.name = "another";
  ASSERT_TRUE(live->open(other, "other"));
  ASSERT_TRUE(live->save(place.path("model.json"), Replaced::any));  // the first document is still shown
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.facts.title == "another"; }));
  wait_ticks(*live, 1000);
  EXPECT_FALSE(live->consume_saved_document().has_value());
  EXPECT_EQ(read_document(place.path("model.json"))->name, "small handle");
}

// A fault in the program destroys the session, which must leave its newest work autosaved.
TEST(LiveSession, LeavesItsNewestWorkAutosavedWhenItEndsInAFault) {
  const Workplace place;
  const Autosave autosave(place.path("."), place.path("model.json"));
  {
    Live live(held_handle());
    live->set_autosave(autosave);
    const std::uint64_t before = live->frame().edit_count;
    ASSERT_TRUE(live->ask(Command(PlacePlane{{Vector3(0.01, 0, 0), Vector3::UnitX()}})));
    ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) { return frame.edit_count > before; }));
  }
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found.value().has_value());
  EXPECT_EQ(found.value()->scene.planes.size(), 2U);
}

TEST(LiveSession, AutosavesUnsavedWorkUntilItIsSaved) {
  const Workplace place;
  const Autosave autosave(place.path("."), place.path("model.json"));
  Live live(held_handle());
  live->set_autosave(autosave);
  wait_ticks(*live, 600);
  EXPECT_FALSE(std::filesystem::exists(autosave.file()));  // there are no changes to save yet
  stroke(live);
  EXPECT_TRUE(wait_for(*live, [&](const LiveFrame&) { return std::filesystem::exists(autosave.file()); }));
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found.value().has_value());
  // The session must be at rest, so that nothing is autosaved after the save.
  wait_ticks(*live, 4000);
  ASSERT_TRUE(live->save(place.path("model.json"), Replaced::any));
  EXPECT_TRUE(wait_for(*live, [&](const LiveFrame&) { return live->consume_saved_document().has_value(); }));
  EXPECT_FALSE(std::filesystem::exists(autosave.file()));
}

TEST(LiveSession, ARecordingThatCannotBeWrittenIsSaid) {
  const Workplace place;
  Live live(held_handle());
  ASSERT_TRUE(live->start_recording(place.path("no such folder/x.recording.jsonl"), ViewChoice()));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.completed_jobs == 1; }));
  EXPECT_EQ(live->frame().failed_jobs, 1U);
  EXPECT_FALSE(live->frame().recording);
  wait_ticks(*live, 10);
}

TEST(LiveSession, AnOlderRecordingStaysUntilTheNewOneIsWhole) {
  const Workplace place;
  const auto file = place.write("x.recording.jsonl", "an older one");
  Live live(held_handle());
  ASSERT_TRUE(live->start_recording(file, ViewChoice()));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.recording; }));
  wait_ticks(*live, 50);
  EXPECT_EQ(content_of(file), "an older one");
  live->stop();
  EXPECT_TRUE(live->is_last_recording_complete());
  const auto recording = read_recording(file);
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_TRUE(recording->end.has_value());
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
}

TEST(LiveSession, OpensAnotherDocument) {
  Live live(held_handle());
  Document other = held_handle();
  other.name = "another";
  other.scene.planes.clear();
  ASSERT_TRUE(live->open(other, "other"));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.facts.title == "another"; }));
  EXPECT_TRUE(live->frame().snapshot.planes.empty());
  // Without the plane the surface has fewer knots than before, while the buffers still hold the surface of
  // the first document.
  for (int frame = 0; frame < 6; ++frame) {
    ASSERT_TRUE(check_net(live->frame().snapshot.bodies[0].surface));
    wait_ticks(*live, 5);
  }
  EXPECT_EQ(live->frame().completed_jobs, 1U);
}

TEST(LiveSession, TheWorkspaceFollowsTheModelThatIsOpened) {
  Live live(held_handle());
  Document far = held_handle();
  far.scene.planes.clear();
  for (double& x : far.scene.bodies[0].surface.net.x) x += 2.0;
  ASSERT_TRUE(live->open(far, "far"));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.completed_jobs == 1; }));
  live.aim(at(2.05, 0.03));
  EXPECT_TRUE(wait_for(*live, [](const LiveFrame& frame) {
    return frame.snapshot.tool.device.position_m.x() > 2.04 &&
           (frame.safety_flags & safety_flag_outside) == 0;
  }));
}

// A force that was cut stays off when another document is opened. The recording contains the commands that
// switch it off and on.
TEST(LiveSession, TheForceIsCutAtOnceUntilItIsSwitchedOn) {
  const Workplace place;
  Live live(held_handle());
  const auto is_off = [](const LiveFrame& frame) {
    return !frame.facts.force_on && (frame.safety_flags & safety_flag_off) != 0;
  };
  const std::uint64_t edits = live->frame().edit_count;
  live->cut_force();
  ASSERT_TRUE(wait_for(*live, is_off));
  EXPECT_EQ(live->frame().edit_count, edits) << "the switch changes no document";
  ASSERT_TRUE(live->open(held_handle(), "again"));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.completed_jobs == 1; }));
  EXPECT_TRUE(is_off(live->frame()));
  ASSERT_TRUE(live->start_recording(place.path("off.jsonl"), ViewChoice()));
  ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) { return frame.recording && is_off(frame); }));
  stroke(live);
  ASSERT_TRUE(live->ask(SwitchForce{true}));
  ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.facts.force_on; }));
  live->stop();
  ASSERT_TRUE(live->is_last_recording_complete());
  const auto recording = read_recording(place.path("off.jsonl"));
  ASSERT_TRUE(recording) << recording.error().message;
  std::vector<bool> switches;
  for (const TimedCommand& timed : recording->commands) {
    if (timed.command["command"] == "switch_force") switches.push_back(timed.command["on"].get<bool>());
  }
  EXPECT_EQ(switches, (std::vector{false, true}));
  const Outcome replayed = run({"replay", place.text("off.jsonl"), "--no-frames"});
  EXPECT_EQ(replayed.code, exit_done) << replayed.err;
}

// Returns the largest distance of the lattice's nodes from a point; infinite if a coordinate is not finite.
double farthest_node_m(const LatticeSnapshot& lattice, const Vector3& from) {
  double farthest = 0.0;
  for (std::size_t n = 0; n < lattice.x.size(); ++n) {
    const Vector3 node(lattice.x[n], lattice.y[n], lattice.z[n]);
    if (!node.allFinite()) return std::numeric_limits<double>::infinity();
    farthest = std::max(farthest, (node - from).norm());
  }
  return farthest;
}

TEST(LiveSession, AHandleOfBeechThatIsPulledStaysInTheScene) {
  for (const bool is_fixed : {true, false}) {
    SCOPED_TRACE(is_fixed);
    Document document = held_handle();
    document.scene.bodies[0].material = shipped_material("beech").value();
    if (!is_fixed) document.scene.planes.clear();
    document.scene.tool.action = ToolAction::pull;
    const Box box = bounding_box(document.scene.bodies[0].surface.net);
    const int substep_limit = document.scene.tool.substeps * substep_ceiling;
    Live live(document);
    double farthest_m = 0.0;
    int substeps = 0;
    std::uint32_t flags = 0;
    const auto watch = [&](const LiveFrame& frame) {
      farthest_m = std::max(farthest_m, farthest_node_m(frame.snapshot.bodies[0].lattice, box.centre()));
      substeps = std::max(substeps, frame.snapshot.substeps);
      flags |= frame.snapshot.flags;
    };
    const auto watch_ticks = [&](std::uint64_t ticks) {
      const std::uint64_t from = live->frame().snapshot.tick;
      ASSERT_TRUE(wait_for(*live, [&](const LiveFrame& frame) {
        watch(frame);
        return frame.snapshot.tick >= from + ticks;
      }));
    };
    HandTarget hand = at(0.05, 0.005);
    hand.buttons = button_main;
    live.aim(hand);
    ASSERT_TRUE(wait_for(*live, [](const LiveFrame& frame) { return frame.facts.in_stroke; }));
    hand.pose.position_m.y() = live->last_frame().snapshot.tool.proxy.position_m.y() + 0.005;
    live.aim(hand);
    watch_ticks(800);
    live.aim(at(0.05, 0.04));
    watch_ticks(800);
    EXPECT_LT(farthest_m, box.size());
    EXPECT_GT(substeps, 0);
    EXPECT_LE(substeps, substep_limit);
    EXPECT_EQ(flags & tick_flag_failed, 0U);
    const Workplace place;
    ASSERT_TRUE(live->save(place.path("pulled.json")));
    EXPECT_TRUE(waits_for_save(*live));
    const auto saved = read_document(place.path("pulled.json"));
    EXPECT_TRUE(saved) << saved.error().message;
  }
}

TEST(LiveSession, CancellingWithoutAStrokeChangesNothing) {
  Live live(held_handle());
  const std::uint64_t edits = live->frame().edit_count;
  ASSERT_TRUE(live->ask(CancelStroke{}));
  wait_ticks(*live, 50);
  EXPECT_EQ(live->frame().edit_count, edits);
}

// A recording of a live session must replay to the same states. The replay compares the states at every
// thousandth tick and at the last.
class LiveRecording : public testing::Test {
 protected:
  static const char* script() {
    return R"({
      "spoonbill_script": 1, "model": "model.json",
      "steps": [
        {"start_mm": [50, 14, 0]},
        {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]},
        {"hold_s": 0.1},
        {"move_to_mm": [50, 6, 0], "over_s": 0.2},
        {"command": "set_tool", "kind": "sphere", "action": "push", "radius_mm": 7, "substeps": 3},
        {"hold_s": 0.1},
        {"command": "cancel_stroke"},
        {"move_to_mm": [50, 14, 0], "over_s": 0.2},
        {"command": "set_symmetry", "on": true, "point_mm": [0, 0, 0], "normal": [0, 0, 1]},
        {"move_to_mm": [45, 5, 3], "over_s": 0.3},
        {"move_to_mm": [45, 14, 3], "over_s": 0.2},
        {"command": "keep_shape"},
        {"hold_s": 0.1},
        {"move_to_mm": [50, 5, 0], "over_s": 0.2},
        {"move_to_mm": [50, 14, 0], "over_s": 0.2},
        {"command": "undo"}, {"hold_s": 0.2}, {"command": "redo"}, {"hold_s": 0.6}
      ]})";
  }
};

TEST_F(LiveRecording, ReplaysToItsOwnStates) {
  const Workplace place;
  place.write("live.json", script());
  const Outcome recorded =
      run({"record", place.text("live.json"), "--live", "--out", place.text("live.jsonl"), "--json"});
  ASSERT_EQ(recorded.code, exit_done) << recorded.err;
  const Outcome replayed = run({"replay", place.text("live.jsonl"), "--no-frames", "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_TRUE(json_of(replayed.out)["complete"].get<bool>());
  // Under a sanitizer most ticks are late and dropped, so the number of ticks has no lower bound.
  EXPECT_GT(json_of(replayed.out)["ticks"].get<int>(), 0);
}

}  // namespace
}  // namespace spoonbill
