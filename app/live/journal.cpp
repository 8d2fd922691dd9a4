#include "app/live/journal.h"

#include <chrono>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "app/files/content_hash.h"
#include "app/files/conversion.h"
#include "app/session/session.h"
#include "engine/exchange/json.h"

namespace spoonbill {

Exporter::~Exporter() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

bool Exporter::has_export_extension(const std::filesystem::path& file) {
  return is_exported_to(file);
}

const char* Exporter::extensions_text() {
  return ".step, .iges, .stl, .obj, .ply or .3mf";
}

void Exporter::begin(std::vector<Body> bodies, std::filesystem::path file) {
  if (busy_.exchange(true)) {
    return notices_->add(Notice::Kind::problem, "not exported: another export is still running");
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this, bodies = std::move(bodies), file = std::move(file)]() mutable {
    run(std::move(bodies), file);
    busy_.store(false);
  });
}

void Exporter::run(std::vector<Body> bodies, const std::filesystem::path& file) {
  const auto report =
      export_bodies(std::move(bodies), file, Progress([this](double) { return !stopping_.load(); }));
  if (!report) return notices_->add(Notice::Kind::problem, "not exported: " + report.error().message);
  notices_->add(Notice::Kind::information,
                "exported " + file.filename().string() + ", in " + report->unit_out);
  for (const std::string& note : report->notes) notices_->add(Notice::Kind::information, note);
}

namespace {

constexpr std::chrono::milliseconds poll_interval{5};

}  // namespace

Journal::Journal(Notices& notices, const LiveScene& first)
    : notices_(&notices),
      exporter_(notices),
      entries_(entry_capacity),
      scenes_(first, [](LiveScene& scene) { reserve_for_refinement(scene.scene); }),
      thread_([this] { run(); }) {}

Journal::~Journal() {
  stop();
}

void Journal::stop() {
  stopping_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
}

void Journal::set_view(Json view) {
  const std::lock_guard lock(mutex_);
  view_ = std::move(view);
}

void Journal::set_autosave(std::optional<Autosave> autosave, std::uint64_t document) {
  const std::lock_guard lock(mutex_);
  if (autosave_) autosave_->remove();
  autosave_ = std::move(autosave);
  autosave_document_ = document;
  ++autosave_count_;
}

// Holds the mutex until the file has its new name. If the journal's thread is writing the autosave in the
// meantime, it waits for the mutex in was_superseded().
Result<std::filesystem::path> Journal::set_autosave_aside() {
  const std::lock_guard lock(mutex_);
  if (!autosave_) return Error{ErrorCode::unavailable, "there is no autosave"};
  ++autosave_count_;
  return std::exchange(autosave_, std::nullopt)->set_aside();
}

void Journal::save(SaveRequest save) {
  const std::lock_guard lock(mutex_);
  save_ = std::move(save);
}

std::optional<SavedDocument> Journal::consume_saved_document() {
  const std::lock_guard lock(mutex_);
  return std::exchange(saved_, std::nullopt);
}

std::optional<std::filesystem::path> Journal::consume_save_conflict() {
  const std::lock_guard lock(mutex_);
  return std::exchange(save_conflict_, std::nullopt);
}

void Journal::set_known_content(std::optional<std::uint64_t> content) {
  const std::lock_guard lock(mutex_);
  known_content_ = content;
}

void Journal::run() {
  while (true) {
    const bool stopping = stopping_.load(std::memory_order_acquire);
    try {
      while (process_pending()) {
      }
    } catch (const std::exception& exception) {
      // The exception mostly reports a lack of memory. The thread must survive, so that later documents can
      // be saved.
      abandon_recording(Error{ErrorCode::internal, exception.what()});
    }
    if (stopping) return;
    std::this_thread::sleep_for(poll_interval);
  }
}

bool Journal::process_pending() {
  JournalEntry entry;
  bool worked = false;
  for (int i = 0; i < 1000 && entries_.pop(entry); ++i) {
    write(entry);
    // The entry is freed here, so that the haptic thread does not free it when it reuses the queue's slot.
    entry = std::monostate{};
    worked = true;
  }
  if (!scenes_.update_reading()) return worked;
  store(scenes_.reading());
  return true;
}

void Journal::write(JournalEntry& entry) {
  if (auto* start = std::get_if<RecordingStart>(&entry)) {
    recording_ = std::move(start->recording);
    is_last_complete_ = false;
    recording_failed_.store(false, std::memory_order_release);
    return;
  }
  if (recording_ == nullptr) return;
  if (Status written = write_to_recording(entry); !written) abandon_recording(written.error());
}

Status Journal::write_to_recording(JournalEntry& entry) {
  RecordingWriter& writer = *recording_;
  if (const auto* reading = std::get_if<RecordedReading>(&entry)) return writer.reading(reading->reading);
  if (const auto* command = std::get_if<RecordedCommand>(&entry)) {
    return command->recorded ? writer.command(command->command) : Status();
  }
  if (std::holds_alternative<RecordedReset>(entry)) return writer.command(command_to_json(ResetProxy{}));
  if (const auto* force = std::get_if<RecordedForceSwitch>(&entry)) {
    return writer.command(request_to_json(SwitchForce{force->on}));
  }
  const auto* state = std::get_if<RecordedState>(&entry);
  if (state == nullptr) return {};
  if (!state->last) return writer.checkpoint(state->state_hash);
  const std::uint64_t ticks = writer.tick();
  if (Status finished = writer.finish(state->state_hash, state->missed); !finished) return finished;
  last_recording_ = {ticks, state->missed};
  if (!leaves_unpublished_.load(std::memory_order_acquire)) {
    if (Status published = writer.commit(); !published) return published;
  }
  notices_->add(Notice::Kind::information, "recorded " + std::to_string(ticks / 1000) + " s");
  recording_.reset();
  is_last_complete_ = true;
  return {};
}

void Journal::abandon_recording(const Error& error) {
  const bool recorded = recording_ != nullptr;
  recording_.reset();
  notices_->add(Notice::Kind::problem,
                (recorded ? "the recording has ended: " : "not saved: ") + error.message);
  recording_failed_.store(true, std::memory_order_release);
}

void Journal::store(const LiveScene& scene) {
  std::optional<SaveRequest> save;
  {
    const std::lock_guard lock(mutex_);
    if (save_ && save_->request <= scene.request) save = std::exchange(save_, std::nullopt);
  }
  if (!save) return autosave(scene);
  if (save->document != scene.document) {
    return notices_->add(Notice::Kind::problem, "not saved: another document was opened in the meantime");
  }
  if (Exporter::has_export_extension(save->file)) return exporter_.begin(scene.scene.bodies, save->file);
  std::error_code ignored;
  // Writing to a pipe could block the thread, which also records and autosaves.
  if (std::filesystem::exists(save->file, ignored) &&
      !std::filesystem::is_regular_file(save->file, ignored)) {
    return notices_->add(Notice::Kind::problem, "not saved: " + save->file.string() +
                                                    ": is not a regular file; choose another name");
  }
  if (!may_replace(*save)) {
    const std::lock_guard lock(mutex_);
    save_conflict_ = save->file;
    return;
  }
  const Document document = make_document(scene);
  const Status written = write_document(document, save->file);
  if (!written) return notices_->add(Notice::Kind::problem, "not saved: " + written.error().message);
  notices_->add(Notice::Kind::information, "saved " + save->file.filename().string());
  const std::uint64_t content = content_hash(json_to_page(document_to_json(document)));
  const std::lock_guard lock(mutex_);
  known_content_ = content;
  saved_ = SavedDocument{save->file, scene.document, scene.edit_count};
  saved_change_ = scene.change;
  if (autosave_) autosave_->remove();
}

// Returns true if the save may replace its file. The content of a file that cannot be read counts as unknown,
// so the file is not replaced.
bool Journal::may_replace(const SaveRequest& save) {
  std::error_code ignored;
  if (save.replaced == Replaced::any || !std::filesystem::is_regular_file(save.file, ignored)) return true;
  const auto content = file_content_hash(save.file);
  const std::lock_guard lock(mutex_);
  return content && content == known_content_;
}

Document Journal::make_document(const LiveScene& scene) {
  const std::lock_guard lock(mutex_);
  return {scene.title, scene.scene, view_};
}

bool Journal::was_superseded(std::uint64_t autosave_count) {
  const std::lock_guard lock(mutex_);
  return autosave_count != autosave_count_;
}

void Journal::autosave(const LiveScene& scene) {
  std::optional<Autosave> target;
  std::uint64_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    if (scene.change <= saved_change_ || scene.document != autosave_document_) return;
    target = autosave_;
    count = autosave_count_;
  }
  if (!target || scene.change == autosaved_change_) return;
  const Status written = target->write(make_document(scene));
  if (was_superseded(count)) return target->remove();  // autosave_ was replaced or set aside during the write
  if (written) autosaved_change_ = scene.change;
  // Only the first failure of a series is reported, because later autosaves fail in the same way.
  if (!written && !autosave_failed_) {
    notices_->add(Notice::Kind::problem, "not autosaved: " + written.error().message);
  }
  autosave_failed_ = !written.ok();
}

}  // namespace spoonbill
