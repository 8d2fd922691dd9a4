// Damaged recordings must be read, or refused with a message of one line; they must never end the program.
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "haptic/recording.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/damage.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/haptic/sample_recording.h"

namespace spoonbill {
namespace {

Result<Recording> read_text(const std::string& text) {
  std::istringstream in(text);
  return read_recording(in, "a.jsonl");
}

std::string sample_text(std::size_t ticks = 260) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_sample_recording(folder.path() / "a.jsonl", sample_readings(ticks, 8), true).ok());
  return content_of(folder.path() / "a.jsonl");
}

std::string header_line() {
  const std::string text = sample_text(0);
  return text.substr(0, text.find('\n') + 1);
}

// Returns the error message for a recording with these lines after a valid header.
std::string recording_refusal(const std::string& lines) {
  const auto recording = read_text(header_line() + lines);
  return recording.ok() ? "accepted" : recording.error().message;
}

void expect_recording_or_line(const std::string& text) {
  const auto recording = read_text(text);
  if (recording.ok()) return;
  const std::string& message = recording.error().message;
  EXPECT_TRUE(message.starts_with("a.jsonl: ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), 600u) << message;
}

TEST(DamagedRecording, CutAtEveryByteLoadsUpToTheCut) {
  const std::string text = sample_text();
  const Recording whole = read_text(text).value();
  const std::size_t header = text.find('\n');
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto recording = read_text(text.substr(0, length));
    if (length < header) {
      ASSERT_FALSE(recording.ok()) << length;
      ASSERT_EQ(recording.error().message.find('\n'), std::string::npos);
      continue;
    }
    ASSERT_TRUE(recording.ok()) << length << ": " << recording.error().message;
    ASSERT_LE(recording->readings.size(), whole.readings.size());
    ASSERT_TRUE(std::equal(recording->readings.begin(), recording->readings.end(), whole.readings.begin()));
    ASSERT_EQ(recording->notice.empty(), recording->end.has_value()) << length;
    ASSERT_EQ(recording->end.has_value(), length == text.size() - 1) << length;
  }
}

TEST(DamagedRecording, AnyBytesChanged) {
  const std::string text = sample_text();
  const std::size_t header = text.find('\n');
  std::mt19937_64 random(9);
  for (int i = random_cases(20'000, 60'000); i > 0; --i) {
    // Most damage is behind the header, because the document's tests already damage headers.
    expect_recording_or_line(damaged(text, i % 8 == 0 ? 0 : header, random));
  }
}

TEST(DamagedRecording, HasNoHeader) {
  const auto message = [](const std::string& text) {
    const auto recording = read_text(text);
    return recording.ok() ? "accepted" : recording.error().message;
  };
  EXPECT_EQ(message(""), "a.jsonl: is empty");
  EXPECT_EQ(
      message("\n"),
      "a.jsonl: line 1: column 1: parsing value - unexpected end of input; expected '[', '{', or a literal");
  EXPECT_EQ(message("{\"tick\":0,\"ticks\":1}\n"), "a.jsonl: line 1: spoonbill_recording is missing");
  EXPECT_TRUE(message("\x7f"
                      "ELF\x02\x01")
                  .starts_with("a.jsonl: line 1: is truncated or not a recording: "));
  EXPECT_TRUE(message(header_line().substr(0, 100))
                  .starts_with("a.jsonl: line 1: is truncated or not a recording: "));
  std::string newer = header_line();
  newer.replace(newer.find("recording\":1"), 12, "recording\":7");
  EXPECT_EQ(message(newer),
            "a.jsonl: line 1: spoonbill_recording is 7, this program reads 1; the file is from a newer "
            "program, update this one");
  std::string slower = header_line();
  slower.replace(slower.find("0.001"), 5, "0.002");
  EXPECT_EQ(message(slower), "a.jsonl: line 1: tick_s is 0.002, must be 0.001 to 0.001");
  std::string wide = header_line();
  wide.replace(wide.find("\"radius_mm\":8"), 13, "\"radius_mm\":9999");
  EXPECT_EQ(message(wide), "a.jsonl: line 1: document: tool.radius_mm is 9999, must be 0 to 500");
}

TEST(DamagedRecording, NamesLineAndField) {
  const std::string still = "{\"tick\":0,\"ticks\":100}\n";
  EXPECT_EQ(recording_refusal(still + "{\"tick\":50,\"ticks\":1}\n"),
            "a.jsonl: line 3: tick is 50, must be 100 after the lines before it");
  EXPECT_EQ(recording_refusal("{\"tick\":-1,\"ticks\":1}\n"),
            "a.jsonl: line 2: tick is -1, must be a whole number from 0 to 10000000");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":0}\n"), "a.jsonl: line 2: ticks is 0, must be 1 to 100");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":101}\n"),
            "a.jsonl: line 2: ticks is 101, must be a whole number from 0 to 100");
  EXPECT_EQ(recording_refusal("{\"tick\":0}\n"), "a.jsonl: line 2: ticks is missing");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":2,\"dx_nm\":[1]}\n"),
            "a.jsonl: line 2: dx_nm is a list of 1, must be a list of 2");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[1.5]}\n"),
            "a.jsonl: line 2: dx_nm[0] is 1.5, must be a whole number within 20000000000 of zero");
  EXPECT_EQ(
      recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[18446744073709551615]}\n"),
      "a.jsonl: line 2: dx_nm[0] is 18446744073709551615, must be a whole number within 20000000000 of zero");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[99999999999999999999]}\n"),
            "a.jsonl: line 2: dx_nm[0] is 1e+20, must be a whole number within 20000000000 of zero");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dz_nm\":[10000000001]}\n"),
            "a.jsonl: line 2: dz_nm[0] leads to 10000000001, must stay within 10000000000 of zero");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[NaN]}\n"),
            "a.jsonl: line 2: column 30: parsing value - invalid literal; last read: '\"dx_nm\":[N'");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dq_e9\":[[0],[0],[0],[-1000000000]]}\n"),
            "a.jsonl: line 2: dq_e9 leads to an orientation that is not a unit quaternion at reading 0");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dq_e9\":[[0],[0],[0]]}\n"),
            "a.jsonl: line 2: dq_e9 is a list of 3, must be a list of 4");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"buttons\":[-1]}\n"),
            "a.jsonl: line 2: buttons contains -1, must contain 32-bit whole numbers");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"speed\":1}\n"),
            "a.jsonl: line 2: has an unknown field \"speed\"; known: tick, ticks, dx_nm, dy_nm, dz_nm, "
            "dq_e9, buttons");
  EXPECT_EQ(recording_refusal("[]\n"), "a.jsonl: line 2: is a list of 0, must be an object");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"command\":5}\n"),
            "a.jsonl: line 2: command is 5, must be a text in quotes");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"command\":\"set_tool\"}\n"), "a.jsonl: line 2: kind is missing");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"state_hash\":\"12\"}\n"),
            "a.jsonl: line 2: state_hash is \"12\", must be 16 hexadecimal digits");
  EXPECT_EQ(recording_refusal(
                "{\"tick\":0,\"command\":\"look\"}\n{\"tick\":0,\"state_hash\":\"0000000000000000\"}\n"),
            "a.jsonl: line 3: state_hash comes after a command of its tick, must come before it");
  EXPECT_EQ(recording_refusal(still + "{\"end\":true,\"ticks\":99,\"state_hash\":\"0000000000000000\"}\n"),
            "a.jsonl: line 3: ticks is 99, but the lines before it contain 100");
  EXPECT_EQ(recording_refusal("{\"end\":true,\"ticks\":0,\"state_hash\":\"0000000000000000\"}\n" + still),
            "a.jsonl: line 3: is after the end of the recording, remove it");
}

TEST(DamagedRecording, HasAbsurdSizes) {
  EXPECT_EQ(recording_refusal(std::string(34'000'000, ' ') + "\n"), "a.jsonl: line 2 is longer than 32 MiB");
  EXPECT_NE(recording_refusal(std::string(60'000, '[') + "\n").find("line 2: column 65: nested deeper"),
            std::string::npos);
  std::string lines;
  for (std::uint64_t tick = 0; tick <= recording_tick_limit; tick += 100) {
    lines += "{\"tick\":" + std::to_string(tick) + ",\"ticks\":100}\n";
  }
  EXPECT_EQ(recording_refusal(lines), "a.jsonl: line 100002: ticks exceed the limit of 10000000 ticks");
}

TEST(DamagedRecording, IsNoFile) {
  const TemporaryFolder folder;
  const std::string here = folder.path().string();
  EXPECT_EQ(read_recording(folder.path()).error().message, here + ": is a folder; name a file in it");
  EXPECT_EQ(read_recording(folder.path() / "x").error().message, here + "/x: no such file");
  EXPECT_EQ(read_recording("/dev/null").error().message, "/dev/null: is not a regular file");
  EXPECT_EQ(read_recording(folder.write("e", "")).error().message, here + "/e: is empty");
}

}  // namespace
}  // namespace spoonbill
