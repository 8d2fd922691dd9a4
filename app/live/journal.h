// The journal: writes what the haptic thread hands over, on a thread that may wait for the disk. Recordings
// as they happen, documents when they are asked for, and an autosave at most a second behind the hand.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "app/live/autosave.h"
#include "app/live/exporter.h"
#include "app/live/live_frame.h"
#include "app/live/notices.h"
#include "haptic/lock_free.h"
#include "haptic/recording.h"

namespace spoonbill {

// What happened, in its order. A command that was not recorded travels here too, to be freed.
struct RecordingBegun {
  std::unique_ptr<RecordingWriter> recording;
};
struct RecordedReading {
  DeviceReading reading;
};
struct RecordedCommand {
  Json command;
  bool recorded = true;
};
struct RecordedReset {};  // of the proxy, after a pause
struct RecordedState {
  std::uint64_t state_hash = 0;
  bool last = false;  // the recording ends with it
};
using JournalEntry = std::variant<std::monostate, RecordingBegun, RecordedReading, RecordedCommand,
                                  RecordedReset, RecordedState>;

// A document that was saved.
struct SavedDocument {
  std::filesystem::path file;
  std::uint64_t document = 0;  // as in LiveFrame
  std::uint64_t deed = 0;
};

struct AskedSave {
  std::uint64_t request = 0;
  std::uint64_t document = 0;  // that was to be seen when it was asked for
  std::filesystem::path file;
};

class Journal {
 public:
  // How many ticks the disk may keep us waiting before a recording is given up.
  static constexpr std::size_t entry_capacity = 16384;

  // The notices must outlive the journal. `first` gives the scenes' sizes.
  Journal(Notices& notices, const LiveScene& first);
  ~Journal();

  // Writes what was handed over and ends the thread; a recording that goes on is left without its end. By the
  // thread that made the journal, when no more is handed over.
  void stop();
  // After stop(): whether the last recording got its end and its place.
  bool last_recording_is_whole() const { return last_is_whole_; }

  // By the haptic thread: neither waits nor allocates. False when full.
  bool push(JournalEntry&& entry) { return entries_.push(std::move(entry)); }
  // The slot to write a scene into, and the word that it is whole.
  LiveScene& scene() { return scenes_.writing(); }
  void publish_scene() { scenes_.publish(); }
  // Whether a recording was given up since the last call.
  bool take_gave_up() { return gave_up_.exchange(false, std::memory_order_acq_rel); }

  // By the program's main thread. How the next documents are looked at.
  void set_view(Json view);
  // Where unsaved work goes from now on; nothing for nowhere. The one before is removed.
  void set_autosave(std::optional<Autosave> autosave);
  // Writes the scene that answers this request, or a newer one of the same document, to the file. Where its
  // ending is one that the exporter writes, it is exported, which saves nothing.
  void save(AskedSave save);
  // The last document that was saved since the last call.
  std::optional<SavedDocument> take_saved();

 private:
  void run();
  bool work();
  void write(JournalEntry& entry);
  Status write_to_recording(JournalEntry& entry);
  void give_up_recording(const Error& error);
  void keep(const LiveScene& scene);
  Document document_of(const LiveScene& scene);
  void autosave(const LiveScene& scene);
  bool was_superseded(std::uint64_t autosave_count);

  Notices* notices_;
  Exporter exporter_;
  BoundedQueue<JournalEntry> entries_;
  TripleBuffer<LiveScene> scenes_;

  std::mutex mutex_;  // for the six below, which the main thread sets
  Json view_ = Json::object();
  std::optional<Autosave> autosave_;
  std::optional<AskedSave> save_;
  std::optional<SavedDocument> saved_;
  std::uint64_t autosave_count_ = 0;  // of the places that were set
  std::uint64_t settled_change_ = 0;  // in the file, or as it was opened: need not be autosaved

  std::unique_ptr<RecordingWriter> recording_;  // the journal's thread only, as all below
  std::uint64_t autosaved_change_ = 0;
  bool autosave_failed_ = false;
  bool last_is_whole_ = false;

  std::atomic<bool> gave_up_{false};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace spoonbill
