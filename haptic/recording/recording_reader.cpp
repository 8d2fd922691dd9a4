#include <istream>
#include <string_view>
#include <utility>

#include "engine/base/file.h"
#include "haptic/recording/line_reader.h"
#include "haptic/recording/recording.h"
#include "haptic/recording/recording_lines.h"

namespace spoonbill {

namespace {

constexpr std::size_t header_bytes_limit = std::size_t{64} << 20;
constexpr std::size_t file_bytes_limit = std::size_t{1} << 30;
constexpr std::size_t command_bytes_limit = std::size_t{64} << 20;  // of all commands together

// Reads the lines after the header into the recording, in order.
class LineTaker {
 public:
  LineTaker(Recording& recording, const std::string& source) : recording_(recording), source_(source) {}

  Status add_line(const Json& json, std::size_t bytes, std::size_t line_number) {
    FieldReader reader(json, source_ + ": line " + std::to_string(line_number));
    if (recording_.end) reader.refuse("stands after the end of the recording, remove it");
    if (reader.has("end")) {
      add_end(reader);
    } else if (reader.has("command")) {
      return add_command(json, reader, bytes, line_number);
    } else if (reader.has("state_hash")) {
      add_checkpoint(reader);
    } else {
      check_tick(reader);
      read_motion(reader, recording_.readings);
    }
    reader.finish();
    if (recording_.readings.size() > recording_tick_limit) {
      reader.refuse("ticks",
                    "lead beyond " + std::to_string(recording_tick_limit) + " ticks, the most that is read");
    }
    return reader.status();
  }

 private:
  std::uint64_t next_tick() const { return recording_.readings.size(); }

  void check_tick(FieldReader& reader) {
    const std::uint64_t tick = reader.unsigned_integer("tick", recording_tick_limit);
    if (tick == next_tick()) return;
    reader.refuse("tick", "is " + std::to_string(tick) + ", must be " + std::to_string(next_tick()) +
                              " after the lines before it");
  }

  void add_end(FieldReader& reader) {
    if (!reader.boolean("end")) reader.refuse("end", "is false, must be true");
    const std::uint64_t ticks = reader.unsigned_integer("ticks", recording_tick_limit);
    if (ticks != next_tick()) {
      reader.refuse("ticks", "is " + std::to_string(ticks) + ", but the lines before hold " +
                                 std::to_string(next_tick()));
    }
    recording_.end = Checkpoint{ticks, read_hash(reader)};
  }

  void add_checkpoint(FieldReader& reader) {
    check_tick(reader);
    if (!recording_.checkpoints.empty() && recording_.checkpoints.back().tick == next_tick()) {
      reader.refuse("state_hash", "is given twice for tick " + std::to_string(next_tick()));
    }
    if (!recording_.commands.empty() && recording_.commands.back().tick == next_tick()) {
      reader.refuse("state_hash", "stands after a command of its tick, must stand before");
    }
    recording_.checkpoints.push_back({next_tick(), read_hash(reader)});
  }

  Status add_command(const Json& json, FieldReader& reader, std::size_t bytes, std::size_t line_number) {
    check_tick(reader);
    command_bytes_ += bytes;
    if (command_bytes_ > command_bytes_limit) {
      reader.refuse("is too much: all commands together exceed 64 MiB");
    }
    if (!reader.status().ok()) return reader.status();
    TimedCommand command{next_tick(), json, source_ + ": line " + std::to_string(line_number)};
    command.command.erase("tick");
    if (Status status = check_command(command.command, command.origin); !status.ok()) return status;
    recording_.commands.push_back(std::move(command));
    return {};
  }

  Recording& recording_;
  const std::string& source_;
  std::size_t command_bytes_ = 0;
};

Result<RecordingHeader> read_header(const Line& line, const std::string& source) {
  const std::string where = source + ": line 1";
  auto json = parse_json(line.text, where);
  if (!json.ok() && !line.terminated) {
    return Error{where + ": is cut or not a recording: " + json.error().message};
  }
  if (!json.ok()) return json.error();
  return header_from_json(json.value(), where);
}

std::string cut_notice(const std::string& source, const Recording& recording, bool partial_line) {
  return source + ": was cut after " + std::to_string(recording.readings.size()) + " ticks" +
         (partial_line ? " within a line; replays up to there" : "; replays up to there");
}

}  // namespace

Result<Recording> read_recording(std::istream& in, const std::string& source) {
  LineReader lines(in, source, file_bytes_limit);
  auto first = lines.next(header_bytes_limit);
  if (!first.ok()) return first.error();
  if (!first.value()) return Error{source + ": is empty"};
  auto header = read_header(*first.value(), source);
  if (!header.ok()) return header.error();

  Recording recording{std::move(header).value(), {}, {}, {}, {}, {}};
  LineTaker taker(recording, source);
  bool partial_line = false;
  for (;;) {
    auto line = lines.next(recording_line_bytes_limit);
    if (!line.ok()) return line.error();
    if (!line.value()) break;
    const Line& content = *line.value();
    auto json = parse_json(content.text, source + ": line " + std::to_string(content.number));
    if (!json.ok() && !content.terminated) {
      partial_line = true;
      break;
    }
    if (!json.ok()) return json.error();
    if (Status status = taker.add_line(json.value(), content.text.size(), content.number); !status.ok()) {
      return status.error();
    }
  }
  if (!recording.end || partial_line) recording.notice = cut_notice(source, recording, partial_line);
  return recording;
}

Result<Recording> read_recording(const std::filesystem::path& file) {
  auto in = open_file(file);
  if (!in) return in.error();
  return read_recording(in.value(), file.string());
}

}  // namespace spoonbill
