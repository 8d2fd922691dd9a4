#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <set>

#include "app/program.h"
#include "app/session/lockstep.h"
#include "tests/app/workplace.h"
#include "tests/render/compare.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

TEST(Frames, ShowTheStateAfterWholeTicks) {
  EXPECT_EQ(frame_tick(0), 0U);
  EXPECT_EQ(frame_tick(1), 16U);
  EXPECT_EQ(frame_tick(2), 33U);
  EXPECT_EQ(frame_tick(60), 1000U);
  EXPECT_EQ(frame_count(0), 1U);
  EXPECT_EQ(frame_count(15), 1U);
  EXPECT_EQ(frame_count(16), 2U);
  EXPECT_EQ(frame_count(999), 60U);
  EXPECT_EQ(frame_count(1000), 61U);
}

TEST(Replay, MakesTheFilesThatTheRecordingAskedFor) {
  const Workplace place;
  place.write("marks.json", R"({
    "spoonbill_script": 1, "model": "model.json",
    "steps": [
      {"start_mm": [50, 14, 0]}, {"hold_s": 0.05},
      {"command": "screenshot", "name": "first"}, {"command": "save", "name": "as_it_was"},
      {"hold_s": 0.1}]})");
  ASSERT_EQ(run({"record", place.text("marks.json"), "--out", place.text("marks.jsonl")}).code, exit_done);
  const Outcome outcome =
      run({"replay", place.text("marks.jsonl"), "--out", place.text("out"), "--size", "96x64"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const auto saved = read_document(place.path("out/saved-as_it_was.json"));
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_EQ(saved->scene.bodies[0].surface.net.x,
            read_document(place.path("model.json"))->scene.bodies[0].surface.net.x);
  // The screenshot is taken at tick 50, which frame 3 shows.
  const auto picture = read_png(place.path("out/picture-first.png"));
  const auto frame = read_png(place.path("out/frame-0003.png"));
  ASSERT_TRUE(picture && frame);
  EXPECT_EQ(picture->rgba, frame->rgba);
}

std::string mark_script(const std::string& steps) {
  return R"({"spoonbill_script": 1, "model": "model.json", "steps": [{"start_mm": [50, 14, 0]}, {"hold_s": 0.05},)" +
         steps + R"({"hold_s": 0.1}]})";
}

// The tool presses into the handle; what --save writes is what a `save` at the last tick would.
TEST(Replay, SavesTheShapeAtTheEnd) {
  const Workplace place;
  place.write("press.json", R"({
    "spoonbill_script": 1, "model": "model.json",
    "steps": [
      {"start_mm": [50, 14, 0]}, {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]},
      {"move_to_mm": [50, 6, 0], "over_s": 0.2}, {"command": "save", "name": "end"}]})");
  ASSERT_EQ(run({"record", place.text("press.json"), "--out", place.text("press.jsonl")}).code, exit_done);
  const std::vector<std::string> replay{
      "replay", place.text("press.jsonl"), "--out", place.text("out"), "--size", "96x64",
      "--save", place.text("end.json")};
  ASSERT_EQ(run(replay).code, exit_done);
  const auto saved = read_document(place.path("end.json")),
             marked = read_document(place.path("out/saved-end.json"));
  ASSERT_TRUE(saved && marked);
  const Surface &surface = saved->scene.bodies[0].surface, &expected = marked->scene.bodies[0].surface;
  EXPECT_EQ(surface.net.y, expected.net.y);
  EXPECT_NE(surface.net.y, read_document(place.path("model.json"))->scene.bodies[0].surface.net.y);
  EXPECT_EQ(saved->scene.planes.size(), 1U);
  EXPECT_EQ(run({"replay", place.text("press.jsonl"), "--no-frames", "--save", place.text("end.stl")}).code,
            exit_wrong_use);
  EXPECT_EQ(
      run({"replay", place.text("press.jsonl"), "--no-frames", "--save", place.text("none/end.json")}).code,
      exit_failed);
}

TEST(Replay, TakesAScreenshotBetweenTheFramesItDraws) {
  const Workplace place;
  place.write("marks.json", mark_script(R"({"command": "screenshot", "name": "early"}, {"hold_s": 0.092},
    {"command": "screenshot", "name": "late"},)"));
  ASSERT_EQ(run({"record", place.text("marks.json"), "--out", place.text("marks.jsonl")}).code, exit_done);
  for (const char* every : {"1", "20"}) {
    const Outcome outcome = run({"replay", place.text("marks.jsonl"), "--out", place.text(every), "--size",
                                 "96x64", "--every", every});
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  }
  for (const char* name : {"picture-early.png", "picture-late.png"}) {
    const auto each = read_png(place.path("1") / name), twentieth = read_png(place.path("20") / name);
    ASSERT_TRUE(each && twentieth) << name;
    EXPECT_EQ(each->rgba, twentieth->rgba) << name;
  }
  EXPECT_EQ(names_in(place.path("20")).count("frame-0003.png"), 0u);
}

TEST(Replay, ARecordingWithoutTicksHasOneFrame) {
  const Workplace place;
  const std::string whole = content_of(place.record("bend.jsonl"));
  place.write("none.jsonl", whole.substr(0, whole.find('\n') + 1));
  const Outcome outcome =
      run({"replay", place.text("none.jsonl"), "--out", place.text("out"), "--size", "96x64"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(names_in(place.path("out")), (std::set<std::string>{"frame-0000.png", "contact-sheet.png"}));
}

TEST(Replay, ShowsThePanelOnlyIfAsked) {
  const Workplace place;
  const std::string recording = place.record("bend.jsonl").string();
  const auto replayed = [&](std::vector<std::string> more) {
    std::vector<std::string> command = {"replay", recording, "--out", place.text("out"), "--every", "99"};
    command.insert(command.end(), more.begin(), more.end());
    EXPECT_EQ(run(command).code, exit_done);
    return read_png(place.path("out") / "frame-0000.png").value();
  };
  EXPECT_FALSE(has_panel(replayed({})));
  EXPECT_TRUE(has_panel(replayed({"--panel"})));
}

TEST(Replay, NeverFollowsALinkInItsFolder) {
  const Workplace place;
  place.write("marks.json",
              mark_script(R"({"command": "screenshot", "name": "a"}, {"command": "save", "name": "a"},)"));
  ASSERT_EQ(run({"record", place.text("marks.json"), "--out", place.text("marks.jsonl")}).code, exit_done);
  const auto own = place.write("own", "the person's own");
  std::filesystem::create_directory(place.path("out"));
  for (const char* name : {"frame-0000.png", "picture-a.png", "saved-a.json", "contact-sheet.png"}) {
    std::filesystem::create_symlink(own, place.path("out") / name);
    for (const std::string& end :
         {std::string(".part"), std::string(".new"), ".new-" + std::to_string(getpid())}) {
      std::filesystem::create_symlink(own, place.path("out") / (name + end));
    }
  }
  const Outcome outcome =
      run({"replay", place.text("marks.jsonl"), "--out", place.text("out"), "--size", "96x64"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(content_of(own), "the person's own");
  for (const char* name : {"frame-0000.png", "picture-a.png", "saved-a.json", "contact-sheet.png"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(place.path("out") / name)));
  }
}

TEST(Replay, AReadOnlyFileIsReplacedOnlyByForce) {
  const Workplace place;
  const auto read_only = std::filesystem::perms(0444);
  const std::string recording = place.record("bend.jsonl").string();
  const auto again = place.write("again.jsonl", "old"), model = place.write("old.json", "old"),
             mesh = place.write("old.stl", "old");
  std::filesystem::create_directory(place.path("out"));
  const auto frame = place.write("out/frame-0000.png", "old");
  for (const auto& file : {again, model, mesh, frame}) std::filesystem::permissions(file, read_only);
  const std::vector<std::vector<std::string>> commands = {
      {"record", place.text("script.json"), "--out", again.string()},
      {"replay", recording, "--no-frames", "--rerecord", again.string()},
      {"replay", recording, "--out", place.text("out"), "--size", "96x64", "--every", "99"},
      {"convert", place.text("model.json"), mesh.string()},
      {"new", "sphere", "--out", model.string(), "--control", "12x12"},
      {"sample", place.text("model.json"), "--out", again.string()}};
  for (std::vector<std::string> command : commands) {
    const Outcome refused = run(command);
    EXPECT_EQ(refused.code, exit_failed) << command[0];
    EXPECT_TRUE(is_clean_failure(refused)) << refused.err;
  }
  for (const auto& file : {again, model, mesh, frame}) EXPECT_EQ(content_of(file), "old");
  for (std::vector<std::string> command : commands) {
    command.push_back("--force");
    EXPECT_EQ(run(command).code, exit_done) << command[0];
  }
  for (const auto& file : {again, model, mesh}) {
    EXPECT_NE(content_of(file), "old");
    EXPECT_EQ(std::filesystem::status(file).permissions(), read_only) << "the mode is kept";
  }
}

TEST(Replay, NamedPipesAreWrittenDirectly) {
  const Workplace place;
  const std::vector<std::vector<std::string>> commands = {
      {"new", "sphere", "--control", "12x12", "--out", place.text("pipe.json")},
      {"sample", place.text("model.json"), "--grid", "2x2", "--out", place.text("pipe.csv")},
      {"record", place.text("script.json"), "--out", place.text("pipe.jsonl")}};
  for (const auto& command : commands) {
    ASSERT_EQ(mkfifo(command.back().c_str(), 0600), 0);
    // The test holds the pipe open for reading and writing, so that neither side waits until the other opens
    // it.
    const int held = open(command.back().c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    fcntl(held, F_SETPIPE_SZ, 1 << 20);
    EXPECT_EQ(run(command).code, exit_done) << command[0];
    char first = 0;
    EXPECT_EQ(read(held, &first, 1), 1) << command[0];
    close(held);
    EXPECT_TRUE(std::filesystem::is_fifo(command.back()));
  }
}

TEST(Session, SavesAtOneTickShareADocument) {
  auto session = Session::make(held_handle(), "test", {}, best_instruction_set());
  ASSERT_TRUE(session);
  for (int n = 0; n < 900; ++n) {
    ASSERT_TRUE(apply_request(session.value(), MarkFile{FileMarkKind::document, std::to_string(n % 450)}));
  }
  ASSERT_EQ(session->marks.size(), 450u);
  for (const FileMark& mark : session->marks) EXPECT_EQ(mark.document, session->marks[0].document);
  // Marks without a command between them share a document. A command before each mark makes the session store
  // another document.
  Status saved;
  int count = 0;
  for (; saved && count < 900; ++count) {
    ASSERT_TRUE(apply_request(session.value(), RemovePlanes{}));
    saved = apply_request(session.value(), MarkFile{FileMarkKind::document, std::to_string(count)});
  }
  EXPECT_LT(count, 30);
  EXPECT_EQ(saved.error().code, ErrorCode::too_many);
  advance(session.value(), {});
  EXPECT_TRUE(apply_request(session.value(), MarkFile{FileMarkKind::document, "later"}));
}

TEST(Replay, LeavesFramesAndContactSheet) {
  const Workplace place;
  const std::string recording = place.record("bend.jsonl").string();
  std::filesystem::create_directory(place.path("pictures"));
  place.write("pictures/frame-9999.png", "of an earlier run");
  place.write("pictures/frame-notes.png", "the person's own");
  const Outcome outcome = run(
      {"replay", recording, "--out", place.text("pictures"), "--size", "96x64", "--every", "12", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["ticks"], 600);
  EXPECT_EQ(facts["frames"], 4);
  EXPECT_EQ(facts["complete"], true);
  EXPECT_EQ(names_in(place.path("pictures")),
            (std::set<std::string>{"frame-0000.png", "frame-0012.png", "frame-0024.png", "frame-0036.png",
                                   "frame-notes.png", "contact-sheet.png"}));
  const auto frame = read_png(place.path("pictures/frame-0036.png"));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width, 96);
  EXPECT_EQ(frame->height, 64);
}

TEST(Replay, RerecordsTheSameBytes) {
  const Workplace place;
  const auto recording = place.record("bend.jsonl");
  const Outcome outcome =
      run({"replay", recording.string(), "--no-frames", "--rerecord", place.text("again.jsonl"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(content_of(place.path("again.jsonl")), content_of(recording));
}

TEST(Replay, NamesTheTickWhereTheStateDiffers) {
  const Workplace place;
  std::string text = content_of(place.record("bend.jsonl"));
  const std::size_t end = text.find("\"state_hash\":\"", text.find("\"end\"")) + 14;
  text[end] = text[end] == '0' ? '1' : '0';
  const std::string changed = place.write("changed.jsonl", text).string();
  const Outcome outcome = run({"replay", changed, "--no-frames"});
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("after 600 ticks"), std::string::npos) << outcome.err;

  const std::string older = place.write("older.jsonl", "of before").string();
  EXPECT_EQ(run({"replay", changed, "--no-frames", "--rerecord", older}).code, exit_failed);
  EXPECT_EQ(content_of(older), "of before") << "a file that could not be replaced stays";

  const Outcome again = run({"record", changed, "--out", place.text("again.jsonl")});
  EXPECT_EQ(again.code, exit_done) << again.err;
  EXPECT_EQ(content_of(place.path("again.jsonl")), content_of(place.path("bend.jsonl")));
  EXPECT_EQ(run({"record", changed, "--out", older}).code, exit_done);
  EXPECT_EQ(content_of(older), content_of(place.path("bend.jsonl")));
}

TEST(Replay, GoesUpToTheCut) {
  const Workplace place;
  const std::string text = content_of(place.record("bend.jsonl"));
  const std::size_t line = text.find("{\"tick\":400");
  ASSERT_NE(line, std::string::npos);
  const std::string cut = place.write("cut.jsonl", text.substr(0, line + 20)).string();
  const Outcome outcome = run({"replay", cut, "--no-frames", "--json"});
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["ticks"], 400);
  EXPECT_EQ(json_of(outcome.out)["complete"], false);
  EXPECT_TRUE(outcome.err.starts_with("spoonbill: ")) << outcome.err;
}

TEST(Replay, UndoTakesTheSecondStrokeBack) {
  const Workplace place;
  const std::string script = content_of(place.path("script.json"));
  const auto hash_of = [&](const std::string& name, const std::string& text) {
    place.write(name, text);
    const Outcome outcome = run({"record", place.text(name), "--out", place.text(name + "l"), "--json"});
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out)["state_hash"];
  };
  std::string without = script;
  const std::string command = "{\"command\": \"undo\"},";
  without.erase(without.find(command), command.size());
  EXPECT_NE(hash_of("with.json", script), hash_of("without.json", without));
}

TEST(Replay, UndoingEveryStrokeGivesBackTheShapeHash) {
  const Workplace place;
  const auto hash_after = [&](const std::string& undone) {
    std::string script = content_of(place.path("script.json"));
    const std::string plane =
        "{\"command\": \"place_plane\", \"point_mm\": [20, 0, 0], \"normal\": [1, 0, 0]},";
    const std::string undo = "{\"command\": \"undo\"},";
    script.erase(script.find(plane), plane.size());
    script.replace(script.find(undo), undo.size(), undone);
    place.write("some.json", script);
    const std::string recording = place.text("some.recording.jsonl");
    EXPECT_EQ(run({"record", place.text("some.json"), "--out", recording, "--force"}).code, exit_done);
    return json_of(run({"replay", recording, "--no-frames", "--json"}).out)["shape_hash"];
  };
  const Json start = json_of(run({"info", place.text("model.json"), "--json"}).out)["shape_hash"];
  ASSERT_TRUE(start.is_string());
  EXPECT_NE(hash_after("{\"command\": \"undo\"},"), start);
  EXPECT_EQ(hash_after("{\"command\": \"undo\"}, {\"command\": \"undo\"},"), start);
}

}  // namespace
}  // namespace spoonbill
