// Tests damaged recordings: each must be read, or be refused with a message of one line, and never end the
// program.
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "haptic/recording.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/damage.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"
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

// Returns the error of reading a recording with these lines after a valid header.
Refusal recording_refusal(const std::string& lines) {
  const auto recording = read_text(header_line() + lines);
  return Refusal(recording);
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
  for (int i = random_cases(is_full_run() ? 20'000 : 6'000, 60'000); i > 0; --i) {
    // Most damage is after the header, because the tests of documents already damage the document in the
    // header.
    expect_recording_or_line(damaged(text, i % 8 == 0 ? 0 : header, random));
  }
}

TEST(DamagedRecording, HasNoHeader) {
  const auto refusal = [](const std::string& text) {
    const auto recording = read_text(text);
    return Refusal(recording);
  };
  EXPECT_EQ(refusal("").message, "a.jsonl: is empty");
  EXPECT_TRUE(refusal("\n").message.starts_with("a.jsonl: line 1: column 1: ")) << refusal("\n");
  EXPECT_EQ(refusal("{\"tick\":0,\"ticks\":1}\n"), Refusal(ErrorCode::missing, "spoonbill_recording"));
  EXPECT_TRUE(refusal("\x7f"
                      "ELF\x02\x01")
                  .message.starts_with("a.jsonl: line 1: is truncated or not a recording: "));
  EXPECT_TRUE(refusal(header_line().substr(0, 100))
                  .message.starts_with("a.jsonl: line 1: is truncated or not a recording: "));
  std::string newer = header_line();
  newer.replace(newer.find("recording\":1"), 12, "recording\":7");
  EXPECT_EQ(refusal(newer).message,
            "a.jsonl: line 1: spoonbill_recording is 7, this program reads 1; the file is from a newer "
            "program, update this one");
  std::string slower = header_line();
  slower.replace(slower.find("0.001"), 5, "0.002");
  EXPECT_EQ(refusal(slower), Refusal(ErrorCode::out_of_range, "tick_s"));
  std::string wide = header_line();
  wide.replace(wide.find("\"radius_mm\":8"), 13, "\"radius_mm\":9999");
  EXPECT_EQ(refusal(wide), Refusal(ErrorCode::out_of_range, "tool.radius_mm"));
}

TEST(DamagedRecording, NamesLineAndField) {
  const std::string still = "{\"tick\":0,\"ticks\":100}\n";
  EXPECT_EQ(recording_refusal(still + "{\"tick\":50,\"ticks\":1}\n").message,
            "a.jsonl: line 3: tick is 50, must be 100 after the lines before it");
  EXPECT_EQ(recording_refusal("{\"tick\":-1,\"ticks\":1}\n"), Refusal(ErrorCode::out_of_range, "tick"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":0}\n"), Refusal(ErrorCode::out_of_range, "ticks"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":101}\n"), Refusal(ErrorCode::out_of_range, "ticks"));
  EXPECT_EQ(recording_refusal("{\"tick\":0}\n"), Refusal(ErrorCode::missing, "ticks"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":2,\"dx_nm\":[1]}\n"),
            Refusal(ErrorCode::too_few, "dx_nm"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[1.5]}\n"),
            Refusal(ErrorCode::out_of_range, "dx_nm[0]"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[18446744073709551615]}\n"),
            Refusal(ErrorCode::out_of_range, "dx_nm[0]"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[99999999999999999999]}\n"),
            Refusal(ErrorCode::out_of_range, "dx_nm[0]"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dz_nm\":[10000000001]}\n"),
            Refusal(ErrorCode::out_of_range, "dz_nm[0]"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dx_nm\":[NaN]}\n").message,
            "a.jsonl: line 2: column 30: parsing value - invalid literal; last read: '\"dx_nm\":[N'");
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dq_e9\":[[0],[0],[0],[-1000000000]]}\n"),
            Refusal(ErrorCode::out_of_range, "dq_e9"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"dq_e9\":[[0],[0],[0]]}\n"),
            Refusal(ErrorCode::too_few, "dq_e9"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"missed\":[-1]}\n"),
            Refusal(ErrorCode::out_of_range, "missed"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"buttons\":[-1]}\n"),
            Refusal(ErrorCode::out_of_range, "buttons"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"ticks\":1,\"speed\":1}\n"),
            Refusal(ErrorCode::unknown, "speed"));
  EXPECT_EQ(recording_refusal("[]\n"), Refusal(ErrorCode::wrong_type));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"command\":5}\n"), Refusal(ErrorCode::wrong_type, "command"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"command\":\"set_tool\"}\n"),
            Refusal(ErrorCode::missing, "kind"));
  EXPECT_EQ(recording_refusal("{\"tick\":0,\"state_hash\":\"12\"}\n"),
            Refusal(ErrorCode::out_of_range, "state_hash"));
  EXPECT_EQ(recording_refusal(
                "{\"tick\":0,\"command\":\"look\"}\n{\"tick\":0,\"state_hash\":\"0000000000000000\"}\n"),
            Refusal(ErrorCode::out_of_range, "state_hash"));
  EXPECT_EQ(recording_refusal(still + "{\"end\":true,\"ticks\":99,\"state_hash\":\"0000000000000000\"}\n"),
            Refusal(ErrorCode::out_of_range, "ticks"));
  EXPECT_EQ(recording_refusal("{\"end\":true,\"ticks\":0,\"state_hash\":\"0000000000000000\"}\n" + still),
            Refusal(ErrorCode::inconsistent));
}

TEST(DamagedRecording, HasAbsurdSizes) {
  EXPECT_EQ(recording_refusal(std::string(34'000'000, ' ') + "\n").message,
            "a.jsonl: line 2 is longer than 32 MiB");
  EXPECT_NE(
      recording_refusal(std::string(60'000, '[') + "\n").message.find("line 2: column 65: nested deeper"),
      std::string::npos);
  std::string lines;
  for (std::uint64_t tick = 0; tick <= recording_tick_limit; tick += 100) {
    lines += "{\"tick\":" + std::to_string(tick) + ",\"ticks\":100}\n";
  }
  EXPECT_EQ(recording_refusal(lines).message,
            "a.jsonl: line 100002: ticks exceed the limit of 10000000 ticks");
}

TEST(DamagedRecording, IsNoFile) {
  const TemporaryFolder folder;
  const std::string here = folder.path().string();
  EXPECT_EQ(read_recording(folder.path()).error().message, here + ": is a folder; name a file in it");
  EXPECT_EQ(read_recording(folder.path() / "x").error().message, here + "/x: no such file");
  EXPECT_EQ(Refusal(read_recording("/dev/null")), Refusal(ErrorCode::unreadable));
  EXPECT_EQ(read_recording(folder.write("e", "")).error().message, here + "/e: is empty");
}

}  // namespace
}  // namespace spoonbill
