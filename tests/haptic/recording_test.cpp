#include "haptic/recording.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <sstream>

#include "haptic/recording_lines.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"
#include "tests/haptic/sample_recording.h"

namespace spoonbill {
namespace {

TEST(Recording, HoldsWhatWasWritten) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl";
  const std::vector<DeviceReading> readings = sample_readings(2345, 1);
  ASSERT_TRUE(write_sample_recording(file, readings, true).ok());
  const auto recording = read_recording(file);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->readings, readings);
  EXPECT_EQ(recording->notice, "");
  ASSERT_TRUE(recording->end.has_value());
  EXPECT_EQ(*recording->end, (Checkpoint{2345, pretended_hash(2345)}));
  EXPECT_EQ(recording->checkpoints,
            (std::vector<Checkpoint>{
                {0, pretended_hash(0)}, {1000, pretended_hash(1000)}, {2000, pretended_hash(2000)}}));
  ASSERT_EQ(recording->commands.size(), 8u);
  EXPECT_EQ(recording->commands[2].tick, 250u);
  EXPECT_EQ(recording->commands[2].command["command"], "set_camera");
  EXPECT_FALSE(recording->commands[2].command.contains("tick"));
  EXPECT_TRUE(recording->commands[2].origin.starts_with(file.string() + ": line "));
  EXPECT_TRUE(same_bits(recording->header.document, sample_document()));
  EXPECT_EQ(recording->header.device.name, "virtual");
}

TEST(Recording, WritesTheSameBytesAgain) {
  const TemporaryFolder folder;
  for (const std::size_t ticks : {0u, 1u, 99u, 100u, 101u, 250u, 251u, 1000u, 1001u, 4321u}) {
    const auto first = folder.path() / "first.jsonl", second = folder.path() / "second.jsonl";
    ASSERT_TRUE(write_sample_recording(first, sample_readings(ticks, 2), true).ok());
    const auto recording = read_recording(first);
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    ASSERT_TRUE(write_again(recording.value(), second).ok());
    EXPECT_EQ(content_of(first), content_of(second)) << ticks << " ticks";
  }
}

// Returns a recording of one command. Its document has the given version, and `steps_field` is the field of
// the tool that contains the number of steps.
std::string recording_with_command(int version, const char* steps_field, const std::string& command) {
  Json header = header_to_json(sample_header());
  Json& document = header["document"];
  document["spoonbill_document"] = version;
  document["tool"].erase("substeps");
  document["tool"][steps_field] = 3;
  if (version == 2) {
    document["sculpting"].erase("drag_per_s");
    document["sculpting"]["damping_per_s"] = 4;
    document["body"]["material"].erase("damping_time_s");
    document["body"]["material"]["damping_ratio"] = 0.1;
  }
  return json_to_line(header) + "\n" + command + "\n";
}

TEST(Recording, ConvertsTheCommandsOfAnOldDocument) {
  const std::string command =
      R"({"tick":0,"command":"set_sculpting","damping_per_s":2,"gravity_m_per_s2":[0,0,0],"force_scale":1})";
  std::istringstream old(recording_with_command(2, "iterations", command));
  const auto recording = read_recording(old, "old.jsonl");
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->header.document.scene.sculpting.drag_per_s, 12.0);
  ASSERT_EQ(recording->commands.size(), 1u);
  EXPECT_EQ(recording->commands[0].command["drag_per_s"], 6);
  std::istringstream current(recording_with_command(3, "substeps", command));
  EXPECT_EQ(Refusal(read_recording(current, "new.jsonl")), Refusal(ErrorCode::missing, "drag_per_s"));
}

TEST(Recording, LeavesOutWhatDoesNotChange) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "still.jsonl";
  auto writer = RecordingWriter::create(file, sample_header()).value();
  for (int tick = 0; tick < 100; ++tick) ASSERT_TRUE(writer.reading({}).ok());
  const std::string content = content_of(file.string() + ".part");
  EXPECT_TRUE(content.ends_with("\n{\"tick\":0,\"ticks\":100}\n")) << content;
}

TEST(Recording, KeepsExtremePositions) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "far.jsonl";
  std::vector<DeviceReading> readings(4);
  readings[0].position_nm[0] = reading_limit_nm;
  readings[1].position_nm[0] = -reading_limit_nm;
  readings[2].orientation_e9[3] = -1'000'000'000;
  readings[2].buttons = 0xffffffffu;
  readings[1].missed = 7;
  {
    auto writer = RecordingWriter::create(file, sample_header()).value();
    for (const DeviceReading& reading : readings) ASSERT_TRUE(writer.reading(reading).ok());
    ASSERT_TRUE(writer.finish(0).ok());
  }
  const auto recording = read_recording(file.string() + ".part");
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->readings, readings);
}

TEST(Recording, ReadsAMinuteInAMoment) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "minute.jsonl";
  ASSERT_TRUE(write_sample_recording(file, sample_readings(60'000, 4), true).ok());
  const auto start = std::chrono::steady_clock::now();
  const auto recording = read_recording(file);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->readings.size(), 60'000u);
  EXPECT_LT(taken.count(), 10.0) << "generous for sanitizers on a loaded machine";
  RecordProperty("seconds", std::to_string(taken.count()));
}

TEST(RecordingWriter, RefusesPathsThatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto no_folder = RecordingWriter::create(folder.path() / "none" / "a.jsonl", sample_header());
  ASSERT_FALSE(no_folder.ok());
  EXPECT_EQ(no_folder.error().message,
            (folder.path() / "none/a.jsonl").string() + ": cannot be written: No such file or directory");
  EXPECT_FALSE(RecordingWriter::create(folder.path(), sample_header()).ok());
}

TEST(RecordingWriter, ReportsAFullDisk) {
  const auto full = RecordingWriter::create("/dev/full", sample_header());
  ASSERT_FALSE(full.ok());
  EXPECT_EQ(full.error().message, "/dev/full: cannot be written: No space left on device");
}

// A limit on the file's size has the effect of a disk that becomes full during a recording.
TEST(RecordingWriter, ReportsADiskThatFillsUp) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header());
    const rlimit limit{20'000, 20'000};
    if (!writer.ok() || setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(2);
    for (const DeviceReading& reading : sample_readings(100'000, 5)) {
      const Status status = writer->reading(reading);
      if (!status.ok()) _exit(status.error().message.ends_with("cannot be written: File too large") ? 0 : 3);
    }
    _exit(4);
  }
  int state = 0;
  ASSERT_EQ(waitpid(child, &state, 0), child);
  EXPECT_TRUE(WIFEXITED(state));
  EXPECT_EQ(WEXITSTATUS(state), 0);
  const auto recording = read_recording(folder.path() / "a.jsonl.part");
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_NE(recording->notice, "");
}

TEST(RecordingWriter, KeepsItsFirstError) {
  const TemporaryFolder folder;
  auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header()).value();
  const Status bad = writer.command(Json{{"no", "command"}});
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().message, (folder.path() / "a.jsonl").string() + ": tick 0: command is missing");
  EXPECT_EQ(writer.reading({}).error().message, bad.error().message);
  EXPECT_EQ(writer.finish(0).error().message, bad.error().message);
}

TEST(RecordingWriter, RefusesWhatCouldNotBeReadBack) {
  const TemporaryFolder folder;
  const auto refusal = [&](const Json& command) {
    auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header()).value();
    const Status status = writer.command(command);
    return Refusal(status);
  };
  Json deep = 1;
  for (int i = 0; i < 80; ++i) deep = Json::array({deep});
  EXPECT_EQ(refusal({{"command", "x"}, {"deep", deep}}), Refusal(ErrorCode::too_many));
  EXPECT_EQ(refusal({{"command", "x"}, {"nan", std::nan("")}}), Refusal(ErrorCode::unsupported, "command"));
  EXPECT_EQ(refusal({{"command", "x"}, {"tick", 5}}), Refusal(ErrorCode::out_of_range, "tick"));
  EXPECT_EQ(refusal({{"command", "x"}, {"long", std::string(34'000'000, 'x')}}),
            Refusal(ErrorCode::too_many, "command"));
  EXPECT_EQ(refusal({{"command", "set_tool"}}), Refusal(ErrorCode::missing, "kind"));
  EXPECT_EQ(refusal({{"command", "x"}, {"list", {1, 2.5, "three"}}}), Refusal());
}

// A command that sets a tool of many triangles can be this large.
TEST(RecordingWriter, KeepsACommandOfSeveralMegabytes) {
  const TemporaryFolder folder;
  Json large{{"command", "x"}, {"list", Json::array()}};
  for (int k = 0; k < 900'000; ++k) large["list"].push_back(k);
  auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header()).value();
  ASSERT_TRUE(writer.command(large).ok());
  ASSERT_TRUE(writer.finish(0).ok());
  ASSERT_TRUE(writer.commit().ok());
  const auto recording = read_recording(folder.path() / "a.jsonl");
  ASSERT_TRUE(recording.ok());
  ASSERT_EQ(recording.value().commands.size(), 1u);
  EXPECT_EQ(recording.value().commands[0].command, large);
}

TEST(RecordingWriter, RefusesReadingsOutOfReach) {
  const TemporaryFolder folder;
  DeviceReading far, turned;
  far.position_nm[1] = reading_limit_nm + 1;
  turned.orientation_e9[3] = 5;
  for (const DeviceReading& reading : {far, turned}) {
    auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header()).value();
    EXPECT_FALSE(writer.reading(reading).ok());
  }
}

TEST(RecordingWriter, RefusesAStateHashOutOfPlace) {
  const TemporaryFolder folder;
  auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header()).value();
  ASSERT_TRUE(writer.checkpoint_due());
  ASSERT_TRUE(writer.checkpoint(1).ok());
  EXPECT_FALSE(writer.checkpoint_due());
  EXPECT_FALSE(writer.checkpoint(1).ok());
}

TEST(RecordingWriter, LosesATenthOfASecondWhenKilled) {
  const TemporaryFolder folder;
  const auto named = folder.path() / "killed.jsonl", file = folder.path() / "killed.jsonl.part";
  constexpr std::size_t ticks = 1777;
  const std::vector<DeviceReading> readings = sample_readings(ticks, 6);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto writer = RecordingWriter::create(named, sample_header());
    for (const DeviceReading& reading : readings) {
      if (!writer->reading(reading).ok()) _exit(1);
    }
    raise(SIGKILL);
  }
  int state = 0;
  ASSERT_EQ(waitpid(child, &state, 0), child);
  ASSERT_TRUE(WIFSIGNALED(state));
  const auto recording = read_recording(file);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_GE(recording->readings.size(), ticks - 100);
  EXPECT_TRUE(std::equal(recording->readings.begin(), recording->readings.end(), readings.begin()));
  EXPECT_EQ(recording->notice, file.string() + ": is truncated after 1700 ticks; replays up to there");
}

TEST(RecordingWriter, RefusesAFileThatAnotherWrites) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl";
  auto first = RecordingWriter::create(file, sample_header());
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(first->reading({}).ok());
  const auto second = RecordingWriter::create(file, sample_header());
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::in_use);
  ASSERT_TRUE(first->finish(7).ok());
  ASSERT_TRUE(first->commit().ok());
  const auto recording = read_recording(file);
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->readings.size(), 1u);
  EXPECT_TRUE(RecordingWriter::create(file, sample_header()).ok()) << "the lock ends with the recording";
}

TEST(RecordingWriter, KeepsWhatACrashLeft) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl";
  for (const char* left : {"one", "two"}) {
    const auto part = folder.write("a.jsonl.part", left);
    auto writer = RecordingWriter::create(file, sample_header());
    ASSERT_TRUE(writer.ok());
    EXPECT_NE(writer->notice(), "");
    ASSERT_TRUE(writer->finish(0).ok());
    ASSERT_TRUE(writer->commit().ok());
    EXPECT_FALSE(std::filesystem::exists(part));
  }
  EXPECT_EQ(content_of(folder.path() / "a.jsonl.part.1"), "one");
  EXPECT_EQ(content_of(folder.path() / "a.jsonl.part.2"), "two");
  EXPECT_TRUE(read_recording(file).ok());
}

TEST(RecordingWriter, NeverFollowsALinkThatItWasNotGiven) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl", foreign = folder.write("foreign", "mine");
  for (const bool exists : {false, true}) {
    if (exists) folder.write("a.jsonl", "old");
    std::filesystem::create_symlink(foreign, file.string() + ".part");
    auto writer = RecordingWriter::create(file, sample_header());
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->finish(0).ok());
    ASSERT_TRUE(writer->commit().ok());
    EXPECT_EQ(content_of(foreign), "mine");
    EXPECT_TRUE(read_recording(file).ok());
  }
}

TEST(RecordingWriter, WritesThroughALinkThatItWasGivenAndKeepsTheMode) {
  const TemporaryFolder folder;
  const auto target = folder.write("target.jsonl", "old"), link = folder.path() / "link.jsonl";
  std::filesystem::permissions(target, std::filesystem::perms(0600));
  std::filesystem::create_symlink(target, link);
  auto writer = RecordingWriter::create(link, sample_header());
  ASSERT_TRUE(writer.ok());
  EXPECT_EQ(writer->written_file(), std::filesystem::canonical(folder.path()) / "target.jsonl.part");
  ASSERT_TRUE(writer->finish(0).ok());
  ASSERT_TRUE(writer->commit().ok());
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_TRUE(read_recording(target).ok());
  EXPECT_EQ(std::filesystem::status(target).permissions(), std::filesystem::perms(0600));
}

TEST(RecordingWriter, KeepsTheNumberOfMissedTicks) {
  const TemporaryFolder folder;
  auto writer = RecordingWriter::create(folder.path() / "a.jsonl", sample_header());
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->finish(0, 129).ok());
  ASSERT_TRUE(writer->commit().ok());
  const auto recording = read_recording(folder.path() / "a.jsonl");
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->missed, 129u);
}

}  // namespace
}  // namespace spoonbill
