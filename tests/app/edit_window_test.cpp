#include "tests/app/edit_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "app/live/autosave.h"
#include "app/program.h"
#include "engine/exchange/document.h"
#include "haptic/recording.h"
#include "render/image.h"
#include "tests/app/process.h"
#include "tests/app/workplace.h"
#include "tests/render/compare.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

// Tests with a handle on whose upper edge, right of the panel, the mouse presses and drags down.
class HandleWindow : public EditWindow {
 protected:
  void stroke() {
    EXPECT_TRUE(move_to(900, 250));
    EXPECT_TRUE(press_button());
    for (int y = 260; y <= 350; y += 30) {
      EXPECT_TRUE(move_to(900, y));
      EXPECT_TRUE(wait_ticks(100));
    }
    EXPECT_TRUE(wait_shown([](const Json& frame) { return frame["in_stroke"].get<bool>(); }));
    EXPECT_TRUE(release_button());
    EXPECT_TRUE(move_to(900, 150));
    EXPECT_TRUE(wait_shown([](const Json& frame) { return !frame["in_stroke"].get<bool>(); }));
  }
};

double largest_difference(const Document& a, const Document& b) {
  const ControlNet &one = a.scene.bodies[0].surface.net, &other = b.scene.bodies[0].surface.net;
  if (one.size() != other.size()) return HUGE_VAL;
  double largest = 0.0;
  for (int i = 0; i < one.rows; ++i) {
    for (int j = 0; j < one.columns; ++j) {
      largest = std::max(largest, (one.point(i, j) - other.point(i, j)).norm());
    }
  }
  return largest;
}

Document held_model() {
  auto document = read_document(std::filesystem::path(SPOONBILL_ASSETS) / "models" / "spoon-handle.json");
  EXPECT_TRUE(document);
  document->scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  return std::move(document).value();
}

TEST_F(HandleWindow, AStrokeIsUndoneRedoneSavedReopenedAndReplays) {
  ASSERT_TRUE(write_document(held_model(), place_.path("handle.json")));
  start({place_.text("handle.json"), "--record", place_.text("session.jsonl")});
  const Document original = saved("handle.json", time_of("handle.json"));
  stroke();
  // After 2000 ticks the body is almost at rest.
  ASSERT_TRUE(wait_ticks(2000));
  const Document bent = saved("handle.json", time_of("handle.json"));
  // The dent is 0.7 to 1.2 mm deep; it depends on how fast the mouse moves while the machine is busy.
  EXPECT_GT(largest_difference(bent, original), 0.5e-3);

  // On a loaded machine the mouse moves in jerks, and the tool may touch more than once.
  ASSERT_TRUE(press_while("ctrl+z", "can_undo"));
  const Document undone = saved("handle.json", time_of("handle.json"));
  EXPECT_EQ(largest_difference(undone, original), 0.0);  // equal bit for bit

  ASSERT_TRUE(press_while("ctrl+y", "can_redo"));
  const Document redone = saved("handle.json", time_of("handle.json"));
  // The body moves a little between the two saves.
  EXPECT_LT(largest_difference(redone, bent), 0.25 * largest_difference(bent, original));

  ASSERT_TRUE(hands("key F12"));
  EXPECT_TRUE(wait_for([&] { return std::filesystem::exists(place_.path("handle-0001.png")); }));
  ASSERT_TRUE(hands("key shift+F12"));
  EXPECT_TRUE(wait_for([&] { return std::filesystem::exists(place_.path("handle-0002.png")); }));
  EXPECT_FALSE(has_panel(read_png(place_.path("handle-0001.png")).value()));
  EXPECT_TRUE(has_panel(read_png(place_.path("handle-0002.png")).value()));
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  const Outcome replayed = run({"replay", place_.text("session.jsonl"), "--no-frames", "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_TRUE(json_of(replayed.out)["complete"].get<bool>());

  start({place_.text("handle.json"), "--record", place_.text("again.jsonl")});
  ASSERT_TRUE(wait_shown([](const Json& frame) { return frame["recording"].get<bool>(); }));
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  const auto again = read_recording(place_.path("again.jsonl"));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(largest_difference(again->header.document, redone), 0.0);
  EXPECT_EQ(run({"replay", place_.text("again.jsonl"), "--no-frames"}).code, exit_done);
}

TEST_F(HandleWindow, BeginsAnewWithALump) {
  start({});
  const int session = shown()["session"].get<int>();
  const auto wait_prompt = [&](const std::string& prompt) {
    return wait_shown([&](const Json& frame) { return frame["prompt"] == prompt; }) && wait_frames(2);
  };
  EXPECT_TRUE(hands("key ctrl+shift+n"));
  ASSERT_TRUE(wait_prompt("shape"));
  press("Return");
  ASSERT_TRUE(wait_shown([&](const Json& frame) { return frame["session"].get<int>() > session; }));
  ASSERT_TRUE(wait_frames(2));
  EXPECT_TRUE(hands("key ctrl+s"));
  ASSERT_TRUE(wait_prompt("file"));
  press("ctrl a");
  EXPECT_TRUE(hands("type --delay 60 " + place_.text("lump.json")));
  ASSERT_TRUE(wait_shown([&](const Json& frame) { return frame["typed"] == place_.text("lump.json"); }));
  press("Return");
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(place_.path("lump.json")); }));
  const auto document = read_document(place_.path("lump.json"));
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->scene.bodies[0].name, "sphere");
}

TEST_F(HandleWindow, ShiftSmoothsUntilTheButtonIsLetGo) {
  ASSERT_TRUE(write_document(held_model(), place_.path("handle.json")));
  start({place_.text("handle.json"), "--record", place_.text("session.jsonl")});
  ASSERT_TRUE(hands("keydown shift"));
  ASSERT_TRUE(wait_frames(2));
  stroke();
  ASSERT_TRUE(hands("keyup shift"));
  ASSERT_TRUE(wait_ticks(100));
  saved("handle.json", time_of("handle.json"));
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  std::ostringstream text;
  text << std::ifstream(place_.path("session.jsonl")).rdbuf();
  const std::string recorded = text.str();
  const auto smooth = recorded.find("smooth");
  ASSERT_NE(smooth, std::string::npos);
  EXPECT_NE(recorded.find("push", smooth), std::string::npos);
  EXPECT_EQ(run({"replay", place_.text("session.jsonl"), "--no-frames"}).code, exit_done);
}

TEST_F(HandleWindow, KilledInAStrokeItLosesASecondAtMost) {
  ASSERT_TRUE(write_document(held_model(), place_.path("handle.json")));
  const std::string before = json_to_page(document_to_json(held_model()));
  start({place_.text("handle.json")});
  ASSERT_TRUE(move_to(900, 250));
  ASSERT_TRUE(hands("mousedown 1"));
  ASSERT_TRUE(wait_shown([](const Json& frame) { return frame["pressing"].get<bool>(); }));
  ASSERT_TRUE(hands("mousemove 900 330"));
  const Autosave autosave(place_.path("state") / "spoonbill", place_.path("handle.json"));
  // An autosave is at most a second older than the shape, so the bent shape is autosaved soon.
  EXPECT_TRUE(wait_for([&] {
    const auto saved = autosave.recovered_document();
    return saved && saved.value() && largest_difference(*saved.value(), held_model()) > 1e-4;
  }));
  kill_editor();
  EXPECT_EQ(json_to_page(document_to_json(read_document(place_.path("handle.json")).value())), before);
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found.value().has_value());
  EXPECT_GT(largest_difference(*found.value(), held_model()), 1e-4);
}

// A crashed session has left a document that differs from the saved one.
class RecoveryQuestion : public EditWindow {
 protected:
  void start_after_crash() {
    ASSERT_TRUE(write_document(held_model(), file_));
    std::filesystem::create_directories(folder());
    Document left = held_model();
    left.name = "left";
    left.scene.planes.push_back({Vector3(0.03, 0, 0), Vector3::UnitX()});
    ASSERT_TRUE(autosave().write(left));
    start({file_.string()});
    ASSERT_TRUE(wait_question());
  }

  // Clicks the answer with this number in the open dialog.
  void answer(std::size_t number) {
    const Json centre = shown()["answers_px"].at(number);
    const int x = static_cast<int>(centre[0].get<double>()), y = static_cast<int>(centre[1].get<double>());
    EXPECT_TRUE(hands("mousemove " + std::to_string(x) + " " + std::to_string(y)));
    EXPECT_TRUE(wait_shown(
        [&](const Json& frame) { return frame["pointer_x_px"] == x && frame["pointer_y_px"] == y; }));
    EXPECT_TRUE(hands("mousedown 1"));
    EXPECT_TRUE(wait_frames(2));
    EXPECT_TRUE(hands("mouseup 1"));
  }
  bool wait_question() const {
    return wait_shown([](const Json& frame) {
             return frame["prompt"] == "question" && !frame["answers_px"].empty();
           }) &&
           wait_frames(2);
  }

  std::filesystem::path folder() const { return place_.path("state") / "spoonbill"; }
  Autosave autosave() const { return {folder(), file_}; }
  // Returns the documents in the files named *.kept-* beside the autosave.
  std::vector<Document> kept() const {
    std::vector<Document> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder())) {
      if (entry.path().string().find(".kept-") == std::string::npos) continue;
      if (auto document = read_document(entry.path())) found.push_back(std::move(document).value());
    }
    return found;
  }

  std::filesystem::path file_ = place_.path("handle.json");
};

TEST_F(RecoveryQuestion, RecoverContinuesTheUnsavedWork) {
  start_after_crash();
  const int session = shown()["session"].get<int>();
  answer(0);
  ASSERT_TRUE(wait_shown(
      [&](const Json& frame) { return frame["prompt"] == "" && frame["session"].get<int>() > session; }));
  ASSERT_TRUE(wait_frames(2));
  EXPECT_EQ(saved("handle.json", time_of("handle.json")).scene.planes.size(), 2U);
  ASSERT_TRUE(wait_for([&] { return !std::filesystem::exists(autosave().file()); }));
  ASSERT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), exit_done);
  EXPECT_TRUE(kept().empty());
}

TEST_F(RecoveryQuestion, RecoveredWorkIsKeptWhenItIsNotSaved) {
  start_after_crash();
  const int session = shown()["session"].get<int>();
  answer(0);
  ASSERT_TRUE(wait_shown(
      [&](const Json& frame) { return frame["prompt"] == "" && frame["session"].get<int>() > session; }));
  ASSERT_TRUE(wait_frames(2));
  ASSERT_TRUE(hands("key ctrl+q"));
  ASSERT_TRUE(wait_question());
  answer(1);  // answers "Don't save"
  EXPECT_EQ(wait_for_end(), exit_done);
  EXPECT_EQ(read_document(file_)->scene.planes.size(), 1U);
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_EQ(kept()[0].scene.planes.size(), 2U);
}

TEST_F(RecoveryQuestion, TheSavedVersionIsOpenedAndTheUnsavedWorkIsKept) {
  start_after_crash();
  answer(1);
  ASSERT_TRUE(wait_shown([](const Json& frame) { return frame["prompt"] == ""; }));
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_EQ(kept()[0].scene.planes.size(), 2U);
  EXPECT_FALSE(std::filesystem::exists(autosave().file()));
  EXPECT_EQ(saved("handle.json", time_of("handle.json")).scene.planes.size(), 1U);
}

TEST_F(HandleWindow, AsksBeforeItReplacesAFileThatAnotherProgramChanged) {
  ASSERT_TRUE(write_document(held_model(), place_.path("handle.json")));
  start({place_.text("handle.json")});
  Document theirs = held_model();
  theirs.name = "theirs";
  ASSERT_TRUE(write_document(theirs, place_.path("handle.json")));
  ASSERT_TRUE(hands("key ctrl+s"));
  EXPECT_TRUE(wait_shown([](const Json& frame) { return frame["prompt"] == "question"; }));
  EXPECT_EQ(read_document(place_.path("handle.json")).value().name, "theirs");
}

TEST(EditWithoutDisplay, SaysSoInOneLineAndNamesReplay) {
  const Outcome outcome = run_process(SPOONBILL_PROGRAM, {"edit"}, "DISPLAY= WAYLAND_DISPLAY=");
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("spoonbill replay"), std::string::npos);
}

}  // namespace
}  // namespace spoonbill
