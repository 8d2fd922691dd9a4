#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "haptic/recording.h"
#include "haptic/recording_lines.h"

namespace spoonbill {

struct RecordingWriter::State {
  State(OutputFile file, std::string named) : out(std::move(file)), name(std::move(named)) {}

  OutputFile out;
  std::string name;
  std::uint64_t ticks = 0;             // readings so far
  std::vector<DeviceReading> pending;  // readings not written yet
  DeviceReading before;                // the reading before the first pending reading
  std::optional<std::uint64_t> checkpoint_tick;
  std::optional<std::uint64_t> command_tick;
  Status failure;  // the first error, which persists
  bool finished = false;
  std::string notice;
  // Locked by every member function that writes, because the thread that handles signals may call leave().
  std::timed_mutex mutex;
  UnfinishedFile unfinished;  // writes the pending readings when a signal ends the process

  Status fail(ErrorCode code, const std::string& message) {
    failure = Error{code, name + ": " + message};
    return failure;
  }

  Status write_line(const Json& json) {
    if (failure.ok()) failure = out.write(json_to_line(json) + '\n');
    return failure;
  }

  Status flush_motion() {
    if (pending.empty()) return failure;
    Status status = write_line(motion_to_json(ticks - pending.size(), before, pending));
    before = pending.back();
    pending.clear();
    return status;
  }

  // Writes the pending readings and returns a line for the user that names the file. Called by the thread
  // that ends the process. If the owner is writing at the same time, waits for it up to 200 ms; after that,
  // the pending readings are not written.
  std::string leave() {
    const std::unique_lock lock(mutex, std::chrono::milliseconds(200));
    if (!lock.owns_lock()) return "the recording " + out.written_file().string() + " can be replayed";
    if (failure.ok() && !finished) [[maybe_unused]]
      const Status flushed = flush_motion();
    return "the recording of " + std::to_string(ticks - pending.size()) + " ticks is " +
           out.written_file().string() + ", which can be replayed";
  }

  // Returns an error if the recording has failed or is finished. Called first by each function that adds a
  // line.
  Status ready() {
    if (failure.ok() && finished)
      return fail(ErrorCode::internal, "the recording is finished; nothing can be added");
    return failure;
  }
};

namespace {

Status check_header(const Json& header, const std::string& name) {
  const std::string source = name + ": not recorded";
  auto json = parse_json(json_to_line(header), source);
  if (!json.ok()) return json.error();
  auto read_back = header_from_json(json.value(), source);
  return read_back.ok() ? Status() : Status(read_back.error());
}

// Checks that the line is not too long and can be read back: numbers must be finite, and nesting must not be
// deeper than the reader accepts.
Status check_line(const Json& line, const std::string& source) {
  const std::string text = json_to_line(line);
  if (text.size() + 1 >= recording_line_bytes_limit) {
    return Error{ErrorCode::too_many, source + ": the command is longer than 32 MiB", "command"};
  }
  auto read_back = parse_json(text, source);
  if (!read_back.ok()) return read_back.error();
  if (read_back.value() != line) {
    return Error{ErrorCode::unsupported, source + ": the command contains values that JSON cannot represent",
                 "command"};
  }
  return {};
}

}  // namespace

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& file,
                                                const RecordingHeader& header, const OutputOptions& options) {
  const Json header_json = header_to_json(header);
  if (Status status = check_header(header_json, file.string()); !status.ok()) return status.error();
  auto out = OutputFile::create_growing(file, options);
  if (!out.ok()) return out.error();
  auto state = std::make_unique<State>(std::move(out).value(), file.string());
  const std::filesystem::path& aside = state->out.kept_aside();
  if (!aside.empty()) {
    state->notice = state->out.written_file().string() + ": was left by an earlier recording; it is now " +
                    aside.string();
  }
  if (Status status = state->write_line(header_json); !status.ok()) return status.error();
  state->unfinished = UnfinishedFile([raw = state.get()] { return raw->leave(); });
  return RecordingWriter(std::move(state));
}

RecordingWriter::RecordingWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;

// Writes the pending readings, so that a stopped recording contains every tick up to the stop.
RecordingWriter::~RecordingWriter() {
  if (state_ == nullptr) return;
  const std::lock_guard lock(state_->mutex);
  if (state_->failure.ok() && !state_->finished) [[maybe_unused]]
    const Status flushed = state_->flush_motion();
}

const std::string& RecordingWriter::notice() const {
  return state_->notice;
}

const std::filesystem::path& RecordingWriter::written_file() const {
  return state_->out.written_file();
}

std::uint64_t RecordingWriter::tick() const {
  return state_->ticks;
}

bool RecordingWriter::checkpoint_due() const {
  return state_->ticks % recording_checkpoint_ticks == 0 && state_->checkpoint_tick != state_->ticks &&
         state_->command_tick != state_->ticks;
}

Status RecordingWriter::checkpoint(std::uint64_t state_hash) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!state.ready().ok()) return state.failure;
  if (!checkpoint_due())
    return state.fail(ErrorCode::internal, "no state hash is due at tick " + std::to_string(state.ticks));
  if (!state.flush_motion().ok()) return state.failure;
  state.checkpoint_tick = state.ticks;
  return state.write_line(Json{{"tick", state.ticks}, {"state_hash", hash_text(state_hash)}});
}

Status RecordingWriter::command(const Json& command) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!state.ready().ok()) return state.failure;
  const std::string source = state.name + ": tick " + std::to_string(state.ticks);
  if (Status status = check_command(command, source); !status.ok()) return state.failure = status;
  const Json line = command_line_to_json(state.ticks, command);
  if (Status status = check_line(line, source); !status.ok()) return state.failure = status;
  if (!state.flush_motion().ok()) return state.failure;
  state.command_tick = state.ticks;
  return state.write_line(line);
}

Status RecordingWriter::reading(const DeviceReading& reading) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!state.ready().ok()) return state.failure;
  if (state.ticks >= recording_tick_limit) {
    return state.fail(ErrorCode::too_many,
                      "has " + std::to_string(recording_tick_limit) + " ticks; start another recording");
  }
  if (!reading.is_valid()) {
    return state.fail(ErrorCode::out_of_range, "the reading of tick " + std::to_string(state.ticks) +
                                                   " is beyond 10 m or has no unit orientation");
  }
  state.pending.push_back(reading);
  ++state.ticks;
  return state.ticks % recording_line_ticks == 0 ? state.flush_motion() : state.failure;
}

Status RecordingWriter::finish(std::uint64_t state_hash, std::uint64_t missed) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!state.ready().ok()) return state.failure;
  if (!state.flush_motion().ok()) return state.failure;
  Json line{{"end", true}, {"ticks", state.ticks}, {"state_hash", hash_text(state_hash)}};
  if (missed > 0) line["missed"] = missed;
  if (!state.write_line(line).ok()) return state.failure;
  state.finished = true;
  return state.failure = state.out.flush();
}

Status RecordingWriter::commit() {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!state.failure.ok()) return state.failure;
  state.failure = state.out.commit();
  state.unfinished = {};
  return state.failure;
}

}  // namespace spoonbill
