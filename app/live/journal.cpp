#include "app/live/journal.h"

#include <chrono>
#include <exception>
#include <utility>

namespace spoonbill {
namespace {

constexpr std::chrono::milliseconds pause_between_looks{5};

}  // namespace

Journal::Journal(Notices& notices, const LiveScene& first)
    : notices_(&notices), exporter_(notices), entries_(entry_capacity), scenes_(first), thread_([this] {
        run();
      }) {}

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

void Journal::set_autosave(std::optional<Autosave> autosave) {
  const std::lock_guard lock(mutex_);
  if (autosave_) autosave_->remove();
  autosave_ = std::move(autosave);
  ++autosave_count_;
}

void Journal::save(AskedSave save) {
  const std::lock_guard lock(mutex_);
  save_ = std::move(save);
}

std::optional<SavedDocument> Journal::take_saved() {
  const std::lock_guard lock(mutex_);
  return std::exchange(saved_, std::nullopt);
}

void Journal::run() {
  while (true) {
    const bool stopping = stopping_.load(std::memory_order_acquire);
    try {
      while (work()) {
      }
    } catch (const std::exception& exception) {
      // For want of memory above all: the thread must live on, to save what can be saved later.
      give_up_recording(Error{exception.what()});
    }
    if (stopping) return;
    std::this_thread::sleep_for(pause_between_looks);
  }
}

bool Journal::work() {
  JournalEntry entry;
  bool did = false;
  for (int i = 0; i < 1000 && entries_.pop(entry); ++i) {
    write(entry);
    entry = std::monostate{};  // freed here: the queue hands it back to the haptic thread
    did = true;
  }
  if (!scenes_.take()) return did;
  keep(scenes_.reading());
  return true;
}

void Journal::write(JournalEntry& entry) {
  if (auto* begun = std::get_if<RecordingBegun>(&entry)) {
    recording_ = std::move(begun->recording);
    last_is_whole_ = false;
    gave_up_.store(false, std::memory_order_release);
    return;
  }
  if (recording_ == nullptr) return;
  if (Status written = write_to_recording(entry); !written) give_up_recording(written.error());
}

Status Journal::write_to_recording(JournalEntry& entry) {
  RecordingWriter& writer = *recording_;
  if (const auto* reading = std::get_if<RecordedReading>(&entry)) return writer.reading(reading->reading);
  if (const auto* command = std::get_if<RecordedCommand>(&entry)) {
    return command->recorded ? writer.command(command->command) : Status();
  }
  if (std::holds_alternative<RecordedReset>(entry)) return writer.command(command_to_json(ResetProxy{}));
  const auto* state = std::get_if<RecordedState>(&entry);
  if (state == nullptr) return {};
  if (!state->last) return writer.checkpoint(state->state_hash);
  const std::uint64_t ticks = writer.tick();
  if (Status finished = writer.finish(state->state_hash); !finished) return finished;
  if (Status placed = writer.commit(); !placed) return placed;
  notices_->add(Notice::Kind::information, "recorded " + std::to_string(ticks / 1000) + " s");
  recording_.reset();
  last_is_whole_ = true;
  return {};
}

void Journal::give_up_recording(const Error& error) {
  const bool recorded = recording_ != nullptr;
  recording_.reset();
  notices_->add(Notice::Kind::problem,
                (recorded ? "the recording has ended: " : "not saved: ") + error.message);
  gave_up_.store(true, std::memory_order_release);
}

void Journal::keep(const LiveScene& scene) {
  std::optional<AskedSave> save;
  {
    const std::lock_guard lock(mutex_);
    if (save_ && save_->request <= scene.request) save = std::exchange(save_, std::nullopt);
  }
  if (!save) return autosave(scene);
  if (save->document != scene.document) {
    return notices_->add(Notice::Kind::problem, "not saved: another document was opened meanwhile");
  }
  if (Exporter::writes(save->file)) return exporter_.begin(scene.scene.bodies, save->file);
  const Status written = write_document(document_of(scene), save->file);
  if (!written) return notices_->add(Notice::Kind::problem, "not saved: " + written.error().message);
  notices_->add(Notice::Kind::information, "saved " + save->file.filename().string());
  const std::lock_guard lock(mutex_);
  saved_ = SavedDocument{save->file, scene.document, scene.deed};
  settled_change_ = scene.change;
  if (autosave_) autosave_->remove();
}

Document Journal::document_of(const LiveScene& scene) {
  const std::lock_guard lock(mutex_);
  return {scene.title, scene.scene, view_};
}

bool Journal::was_superseded(std::uint64_t autosave_count) {
  const std::lock_guard lock(mutex_);
  return autosave_count != autosave_count_;
}

void Journal::autosave(const LiveScene& scene) {
  std::optional<Autosave> place;
  std::uint64_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    if (scene.change <= settled_change_) return;
    place = autosave_;
    count = autosave_count_;
  }
  if (!place || scene.change == autosaved_change_) return;
  const Status written = place->write(document_of(scene));
  if (was_superseded(count)) return place->remove();  // while it was being written
  if (written) autosaved_change_ = scene.change;
  // Once is enough: a full disk would fill the panel with the same line.
  if (!written && !autosave_failed_) {
    notices_->add(Notice::Kind::problem, "not autosaved: " + written.error().message);
  }
  autosave_failed_ = !written.ok();
}

}  // namespace spoonbill
