#include <cstddef>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/file.h"
#include "engine/exchange/old_documents.h"
#include "haptic/recording.h"
#include "haptic/recording_lines.h"

namespace spoonbill {

namespace {

constexpr std::size_t header_bytes_limit = std::size_t{64} << 20;
constexpr std::size_t file_bytes_limit = std::size_t{1} << 30;
constexpr std::size_t command_bytes_limit = std::size_t{64} << 20;  // limit for all commands together

constexpr std::size_t chunk_bytes = std::size_t{64} << 10;

std::string readable_size(std::size_t bytes) {
  return bytes >= (std::size_t{1} << 20) ? std::to_string(bytes >> 20) + " MiB"
                                         : std::to_string(bytes >> 10) + " KiB";
}

// A line without its newline.
struct Line {
  std::string_view text;    // valid until the next line is read
  std::size_t number = 0;   // number of the line, from 1
  bool terminated = false;  // false for a last line without a newline
};

// Reads the lines of a stream. The length of each line and of the whole stream is limited, so that no file
// can exhaust the memory. Borrows the stream.
class LineReader {
 public:
  LineReader(std::istream& in, std::string source, std::size_t bytes_limit);

  // Returns the next line, or nothing at the end of the stream. Errors: a line or a stream that exceeds its
  // limit, a read error.
  Result<std::optional<Line>> next(std::size_t line_bytes_limit);

 private:
  bool fill();
  Error make_length_error(const std::string& what, std::size_t limit) const;

  std::istream& in_;
  std::string source_;
  std::size_t bytes_limit_;
  std::size_t bytes_read_ = 0;
  std::string buffer_;
  std::size_t start_ = 0;  // offset of the next line in the buffer
  std::size_t number_ = 0;
};

LineReader::LineReader(std::istream& in, std::string source, std::size_t bytes_limit)
    : in_(in), source_(std::move(source)), bytes_limit_(bytes_limit) {}

bool LineReader::fill() {
  buffer_.erase(0, start_);
  start_ = 0;
  const std::size_t unread = buffer_.size();
  buffer_.resize(unread + chunk_bytes);
  in_.read(buffer_.data() + unread, static_cast<std::streamsize>(chunk_bytes));
  const auto count = static_cast<std::size_t>(in_.gcount());
  buffer_.resize(unread + count);
  bytes_read_ += count;
  return count > 0;
}

Error LineReader::make_length_error(const std::string& what, std::size_t limit) const {
  return Error{ErrorCode::too_many, source_ + ": " + what + " is longer than " + readable_size(limit)};
}

Result<std::optional<Line>> LineReader::next(std::size_t line_bytes_limit) {
  std::size_t searched = 0;  // bytes of this line known to contain no newline
  for (;;) {
    const std::size_t newline = buffer_.find('\n', start_ + searched);
    const std::size_t length = (newline == std::string::npos ? buffer_.size() : newline) - start_;
    if (length >= line_bytes_limit)
      return make_length_error("line " + std::to_string(number_ + 1), line_bytes_limit);
    const std::string_view text = std::string_view(buffer_).substr(start_, length);
    if (newline != std::string::npos) {
      start_ = newline + 1;
      return std::optional(Line{text, ++number_, true});
    }
    searched = length;
    if (fill()) {
      if (bytes_read_ > bytes_limit_) return make_length_error("the file", bytes_limit_);
      continue;
    }
    if (in_.bad()) {
      return Error{ErrorCode::unreadable,
                   source_ + ": line " + std::to_string(number_ + 1) + " cannot be read"};
    }
    if (buffer_.empty()) return std::optional<Line>();
    start_ = buffer_.size();
    return std::optional(Line{buffer_, ++number_, false});
  }
}

// Adds the lines after the header to a recording, in order.
class RecordingBuilder {
 public:
  // `old_commands` converts the commands of a recording whose document is old.
  RecordingBuilder(Recording& recording, const std::string& source, std::optional<OldCommands> old_commands)
      : recording_(recording), source_(source), old_commands_(old_commands) {}

  Status add_line(const Json& json, std::size_t bytes, std::size_t line_number) {
    FieldReader reader(json, source_ + ": line " + std::to_string(line_number));
    if (recording_.end) reader.refuse("is after the end of the recording, remove it");
    if (reader.has("end")) {
      add_end(reader);
    } else if (reader.has("command")) {
      return add_command(json, reader, bytes, line_number);
    } else if (reader.has("state_hash")) {
      add_checkpoint(reader);
    } else {
      check_tick(reader);
      const std::size_t first = recording_.readings.size();
      read_motion(reader, recording_.readings);
      for (std::size_t i = first; i < recording_.readings.size(); ++i) {
        recording_.missed += recording_.readings[i].missed;
      }
    }
    reader.finish();
    if (recording_.readings.size() > recording_tick_limit) {
      reader.refuse("ticks", "exceed the limit of " + std::to_string(recording_tick_limit) + " ticks");
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
      reader.refuse("ticks", "is " + std::to_string(ticks) + ", but the lines before it contain " +
                                 std::to_string(next_tick()));
    }
    recording_.end = Checkpoint{ticks, read_hash(reader)};
    constexpr std::uint64_t missed_limit = std::uint64_t{1} << 40;
    if (reader.has("missed")) recording_.missed = reader.unsigned_integer("missed", missed_limit);
  }

  void add_checkpoint(FieldReader& reader) {
    check_tick(reader);
    if (!recording_.checkpoints.empty() && recording_.checkpoints.back().tick == next_tick()) {
      reader.refuse("state_hash", "is given twice for tick " + std::to_string(next_tick()));
    }
    if (!recording_.commands.empty() && recording_.commands.back().tick == next_tick()) {
      reader.refuse("state_hash", "comes after a command of its tick, must come before it");
    }
    recording_.checkpoints.push_back({next_tick(), read_hash(reader)});
  }

  Status add_command(const Json& json, FieldReader& reader, std::size_t bytes, std::size_t line_number) {
    check_tick(reader);
    command_bytes_ += bytes;
    if (command_bytes_ > command_bytes_limit) {
      reader.refuse("exceeds the limit of 64 MiB for all commands together");
    }
    if (!reader.status().ok()) return reader.status();
    TimedCommand command{next_tick(), json, source_ + ": line " + std::to_string(line_number)};
    command.command.erase("tick");
    if (old_commands_) {
      if (Status status = old_commands_->convert(command.command, command.origin); !status.ok())
        return status;
    }
    if (Status status = check_command(command.command, command.origin); !status.ok()) return status;
    recording_.commands.push_back(std::move(command));
    return {};
  }

  Recording& recording_;
  const std::string& source_;
  std::optional<OldCommands> old_commands_;
  std::size_t command_bytes_ = 0;
};

struct ReadHeader {
  RecordingHeader header;
  std::optional<OldCommands> old_commands;  // set if the header's document is old
};

Result<ReadHeader> read_header(const Line& line, const std::string& source) {
  const std::string location = source + ": line 1";
  auto json = parse_json(line.text, location);
  if (!json.ok() && !line.terminated) {
    return Error{json.error().code, location + ": is truncated or not a recording: " + json.error().message};
  }
  if (!json.ok()) return json.error();
  auto header = header_from_json(json.value(), location);
  if (!header.ok()) return header.error();
  ReadHeader read{std::move(header).value(), {}};
  // A converted tool has one substep for each of its former iterations, so its `substeps` is the number of
  // iterations.
  if (is_old_document(json.value()["document"])) {
    read.old_commands.emplace(read.header.document.scene.tool.substeps);
  }
  return read;
}

std::string make_truncation_notice(const std::string& source, const Recording& recording, bool partial_line) {
  return source + ": is truncated after " + std::to_string(recording.readings.size()) + " ticks" +
         (partial_line ? " within a line; replays up to there" : "; replays up to there");
}

}  // namespace

Result<Recording> read_recording(std::istream& in, const std::string& source) {
  LineReader lines(in, source, file_bytes_limit);
  auto first = lines.next(header_bytes_limit);
  if (!first.ok()) return first.error();
  if (!first.value()) return Error{ErrorCode::malformed, source + ": is empty"};
  auto header = read_header(*first.value(), source);
  if (!header.ok()) return header.error();

  Recording recording{std::move(header->header), {}, {}, {}, {}, 0, {}};
  RecordingBuilder builder(recording, source, header->old_commands);
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
    if (Status status = builder.add_line(json.value(), content.text.size(), content.number); !status.ok()) {
      return status.error();
    }
  }
  if (!recording.end || partial_line)
    recording.notice = make_truncation_notice(source, recording, partial_line);
  return recording;
}

Result<Recording> read_recording(const std::filesystem::path& file) {
  auto in = open_file(file);
  if (!in) return in.error();
  return read_recording(in.value(), file.string());
}

}  // namespace spoonbill
