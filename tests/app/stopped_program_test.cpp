// Tests the built program when a signal ends it: temporary files are removed, and the recording up to the
// signal stays.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/process.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::string stopped_program = SPOONBILL_PROGRAM;
using StopClock = std::chrono::steady_clock;

// The program as a child process of the test.
class RunningProgram {
 public:
  RunningProgram(const std::vector<std::string>& arguments, const std::filesystem::path& err) : err_(err) {
    std::vector<std::string> words = arguments;
    words.insert(words.begin(), stopped_program);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
    // If the program does not start, process_ may be -1. A signal to process -1 would go to every process.
    const int refused =
        posix_spawn(&process_, stopped_program.c_str(), &actions, nullptr, pointers.data(), environ);
    EXPECT_EQ(refused, 0);
    ended_ = refused != 0;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~RunningProgram() {
    if (has_ended()) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  bool has_ended() {
    if (!ended_) ended_ = waitpid(process_, &state_, WNOHANG) == process_;
    return ended_;
  }
  void wait_for_size(const std::filesystem::path& file, std::uintmax_t bytes) {
    std::error_code ignored;
    const auto give_up = StopClock::now() + std::chrono::seconds(20);
    while (!has_ended() && StopClock::now() < give_up) {
      const auto size = std::filesystem::file_size(file, ignored);
      if (!ignored && size >= bytes) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  // Waits until the progress on standard error has reached a percentage.
  void wait_for_percent(int percent) {
    const auto give_up = StopClock::now() + std::chrono::seconds(20);
    while (!has_ended() && StopClock::now() < give_up) {
      const std::string text = err();
      const std::size_t end = text.rfind(" %"), start = text.rfind("] ", end);
      if (end != std::string::npos && start != std::string::npos &&
          std::stoi(text.substr(start + 2, end - start - 2)) >= percent) {
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  // Sends the signal and returns the seconds until the end.
  double stop(int signal) {
    const auto start = StopClock::now();
    send(signal);
    while (!has_ended() && StopClock::now() < start + std::chrono::seconds(20)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return std::chrono::duration<double>(StopClock::now() - start).count();
  }
  void send(int signal) const {
    if (!ended_) kill(process_, signal);
  }
  int wait_for_code() {
    if (!has_ended()) waitpid(process_, &state_, 0);
    ended_ = true;
    return WIFEXITED(state_) ? WEXITSTATUS(state_) : -1;
  }
  bool failed() const { return !WIFEXITED(state_) || WEXITSTATUS(state_) == exit_failed; }
  std::string err() const { return content_of(err_); }

 private:
  pid_t process_ = -1;
  std::filesystem::path err_;
  bool ended_ = false;
  int state_ = 0;
};

// The program promises to end within a second. The limit is higher, because the machine of the tests may be
// busy.
constexpr double stop_limit_s = 4.0;

std::string long_script(const Workplace& place) {
  std::string script = content_of(place.path("script.json"));
  script.replace(script.rfind("\"hold_s\": 0.1"), 13, "\"hold_s\": 500");
  return place.write("long.json", script).string();
}

std::uintmax_t header_bytes(const Workplace& place) {
  place.record("whole.jsonl");
  return content_of(place.path("whole.jsonl")).find('\n') + 1;
}

void expect_replayable(const Workplace& place, const RunningProgram& stopped, const std::string& name) {
  const std::string part = place.text(name + ".part");
  EXPECT_FALSE(std::filesystem::exists(place.path(name)));
  EXPECT_NE(stopped.err().find(part), std::string::npos) << stopped.err();
  const Outcome replayed = run({"replay", part, "--no-frames", "--json"});
  ASSERT_EQ(replayed.code, exit_done) << replayed.err;
  EXPECT_GT(json_of(replayed.out)["ticks"], 100);
}

TEST(StoppedProgram, LeavesARecordingWithItsTicks) {
  const Workplace place;
  const std::string script = long_script(place);
  const auto bytes = header_bytes(place) + 2000;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    if (signal != SIGTERM && !is_full_run()) continue;
    const std::string name = std::to_string(signal) + ".jsonl";
    RunningProgram recording({"record", script, "--out", place.text(name)}, place.path(name + ".err"));
    recording.wait_for_size(place.path(name + ".part"), bytes);
    EXPECT_LT(recording.stop(signal), stop_limit_s);
    EXPECT_TRUE(recording.failed());
    expect_replayable(place, recording, name);
  }
}

TEST(StoppedProgram, LeavesALiveRecordingUnpublished) {
  const Workplace place;
  const std::string script = long_script(place);
  const auto bytes = header_bytes(place) + 4000;
  RunningProgram recording({"record", script, "--live", "--out", place.text("l.jsonl")}, place.path("err"));
  recording.wait_for_size(place.path("l.jsonl.part"), bytes);
  EXPECT_LT(recording.stop(SIGTERM), stop_limit_s);
  EXPECT_TRUE(recording.failed());
  expect_replayable(place, recording, "l.jsonl");
}

TEST(StoppedProgram, NamesTheRecordingThatAReplayHasBegun) {
  const Workplace place;
  RunningProgram replay({"replay", SPOONBILL_ASSETS "/recordings/spoon-handle-bend.recording.jsonl",
                         "--no-frames", "--rerecord", place.text("r.jsonl")},
                        place.path("err"));
  replay.wait_for_size(place.path("r.jsonl.part"), 1);
  EXPECT_LT(replay.stop(SIGTERM), stop_limit_s);
  EXPECT_TRUE(replay.failed());
  EXPECT_NE(replay.err().find(place.text("r.jsonl.part")), std::string::npos) << replay.err();
  EXPECT_FALSE(std::filesystem::exists(place.path("r.jsonl")));
}

// The tool strokes through a ball that it has not touched before. Some ticks of this stroke take almost
// forever.
TEST(StoppedProgram, EndsInTheMidstOfALongTick) {
  const Workplace place;
  for (const char* name : {"endless-tick.script.json", "endless-tick-model.json"}) {
    std::filesystem::copy_file(std::filesystem::path(SPOONBILL_TEST_INPUTS) / name, place.path(name));
  }
  const std::vector<std::string> record = {"record", place.text("endless-tick.script.json"), "--out",
                                           place.text("e.jsonl")};
  std::vector<std::string> live = record;
  live.emplace_back("--live");
  for (const auto& arguments : {record, live}) {
    RunningProgram recording(arguments, place.path("err"));
    recording.wait_for_size(place.path("e.jsonl.part"), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    EXPECT_LT(recording.stop(SIGTERM), stop_limit_s);
    std::filesystem::remove(place.path("e.jsonl.part"));
    std::filesystem::remove(place.path("err"));
  }
}

// Stops `replay` while it draws and `sample` while it evaluates. Neither checks for signals in this work.
TEST(StoppedProgram, LeavesNoTemporaryFile) {
  const Workplace place;
  place.record("bend.jsonl");
  const auto before = std::distance(std::filesystem::directory_iterator(place.path("")), {});
  RunningProgram drawing(
      {"replay", place.text("bend.jsonl"), "--out", place.text("out"), "--size", "1920x1080"},
      place.path("err"));
  drawing.wait_for_size(place.path("out/frame-0000.png"), 1);
  EXPECT_LT(drawing.stop(SIGTERM), stop_limit_s);
  for (const auto& entry : std::filesystem::directory_iterator(place.path("out"))) {
    EXPECT_EQ(entry.path().extension(), ".png") << entry.path();
  }
  RunningProgram sampling(
      {"sample", place.text("model.json"), "--grid", "2000x2000", "--out", place.text("s.csv")},
      place.path("err2"));
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_LT(sampling.stop(SIGHUP), stop_limit_s);
  // The three new entries are the folder of frames and the two files with standard error.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(place.path("")), {}), before + 3);
}

// Waits at most a second until this process has no child, and returns whether it has none. A process whose
// parent has ended becomes a child of this process.
bool has_lost_all_children() {
  const auto give_up = StopClock::now() + std::chrono::seconds(1);
  while (StopClock::now() < give_up) {
    const pid_t ended = waitpid(-1, nullptr, WNOHANG);
    if (ended < 0) return errno == ECHILD;
    if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

// Writes a STEP file of so many bodies that its conversion takes seconds. Returns the name of the file.
std::string assembly_of(const Workplace& place) {
  Document document = read_document(place.path("model.json")).value();
  const Body first = document.scene.bodies[0];
  for (int k = 1; k < 300; ++k) {
    Body body = first;
    body.name = "body " + std::to_string(k + 1);
    for (double& y : body.surface.net.y) y += 0.03 * k;
    document.scene.bodies.push_back(std::move(body));
  }
  const std::string many = place.write("many.json", json_to_page(document_to_json(document))).string();
  const Outcome written = run_process(stopped_program, {"convert", many, place.text("many.step")});
  EXPECT_EQ(written.code, exit_done) << written.err;
  return place.text("many.step");
}

TEST(StoppedProgram, EndsAConversionWithItsReader) {
  const Workplace place;
  const std::string assembly = assembly_of(place);
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  const auto before = std::distance(std::filesystem::directory_iterator(place.path("")), {});
  // At 0 % the reader parses the file; at 40 % surfaces are meshed.
  for (const int percent : {0, 40}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      if ((percent == 0) != (signal == SIGINT) && !is_full_run()) continue;
      SCOPED_TRACE(std::to_string(percent) + " %, signal " + std::to_string(signal));
      RunningProgram converting(
          {"convert", assembly, place.text("out.stl"), "--chord", "0.01mm", "--progress"}, place.path("err"));
      converting.wait_for_percent(percent);
      EXPECT_LT(converting.stop(signal), stop_limit_s);
      EXPECT_TRUE(converting.failed());
      EXPECT_NE(converting.err().find("stopped"), std::string::npos) << converting.err();
      EXPECT_TRUE(has_lost_all_children());
      std::filesystem::remove(place.path("err"));
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(place.path("")), {}), before);
    }
  }
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST(StoppedProgram, GoesOnWhereTheSignalWasIgnoredAtItsStart) {
  const Workplace place;
  for (const int number : {SIGHUP, SIGINT, SIGTERM}) {
    if (number != SIGHUP && !is_full_run()) continue;
    const auto before = std::signal(number, SIG_IGN);
    RunningProgram recording({"record", place.text("script.json"), "--out", place.text("n.jsonl")},
                             place.path("err"));
    std::signal(number, before);
    for (int n = 0; n < 5; ++n) {
      recording.send(number);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(recording.wait_for_code(), exit_done) << recording.err();
  }
}

TEST(StoppedProgram, TwoRecordingsDoNotShareAFile) {
  const Workplace place;
  const std::string script = long_script(place);
  const auto bytes = header_bytes(place) + 2000;
  RunningProgram first({"record", script, "--out", place.text("a.jsonl")}, place.path("err"));
  first.wait_for_size(place.path("a.jsonl.part"), bytes);
  const Outcome second =
      run_process(stopped_program, {"record", place.text("script.json"), "--out", place.text("a.jsonl")});
  EXPECT_EQ(second.code, exit_failed) << second.err;
  EXPECT_FALSE(first.has_ended());
  first.stop(SIGINT);
  expect_replayable(place, first, "a.jsonl");
}

}  // namespace
}  // namespace spoonbill
