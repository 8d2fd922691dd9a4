// The journal of a live session, which writes recordings, documents and autosaves. It has its own thread,
// because the disk may be slow. Also contains the exporter to foreign formats and the notices to the user.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "app/live/autosave.h"
#include "engine/scene/scene.h"
#include "haptic/lock_free.h"
#include "haptic/recording.h"

namespace spoonbill {

// A one-line message to the user.
struct Notice {
  enum class Kind { information, problem };
  Kind kind = Kind::information;
  std::string text;
};

// Messages to the user. Thread-safe. The haptic thread must not call add(), because the call may wait.
class Notices {
 public:
  void add(Notice::Kind kind, std::string text) {
    const std::lock_guard lock(mutex_);
    all_.push_back({kind, std::move(text)});
  }

  // Returns the messages since the last call.
  std::vector<Notice> consume() {
    const std::lock_guard lock(mutex_);
    return std::exchange(all_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<Notice> all_;
};

// Writes bodies as CAD files and meshes on its own thread, so that an export delays neither autosaves nor
// frames. It has one owner, and one thread calls begin().
class Exporter {
 public:
  // The notices must outlive the exporter.
  explicit Exporter(Notices& notices) : notices_(&notices) {}
  ~Exporter();  // cancels a running export and leaves an existing file unchanged
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;

  // Returns true if the file name has the extension of an export format.
  static bool has_export_extension(const std::filesystem::path& file);
  static const char* extensions_text();

  // Starts an export, unless another one is still running. A notice reports its end or its error.
  void begin(std::vector<Body> bodies, std::filesystem::path file);

 private:
  void run(std::vector<Body> bodies, const std::filesystem::path& file);

  Notices* notices_;
  std::atomic<bool> busy_{false}, stopping_{false};
  std::thread thread_;
};

// The types from RecordingStart to RecordedState are the entries of a recording. Commands pass through the
// journal even if they are not recorded, so that their memory is freed outside the haptic thread.
struct RecordingStart {
  std::unique_ptr<RecordingWriter> recording;
};
struct RecordedReading {
  DeviceReading reading;
};
struct RecordedCommand {
  Json command;
  bool recorded = true;
};
struct RecordedReset {};  // records a reset of the proxy after a pause
struct RecordedForceSwitch {
  bool on = true;
};
struct RecordedState {
  std::uint64_t state_hash = 0;
  bool last = false;         // true if this entry ends the recording
  std::uint64_t missed = 0;  // periods of 1 ms without a tick during the recording; valid if `last` is true
};

// Number of ticks of a recording, and number of periods of 1 ms without a tick while it was recorded.
struct RecordedTicks {
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;
};

using JournalEntry = std::variant<std::monostate, RecordingStart, RecordedReading, RecordedCommand,
                                  RecordedReset, RecordedForceSwitch, RecordedState>;

// A document's scene at one tick, which the haptic thread passes to the journal.
struct LiveScene {
  std::string title;
  Scene scene;
  std::uint64_t document = 0;    // number of the document, see LiveFrame::document
  std::uint64_t change = 0;      // number of changes of the scene so far, including motion after a touch
  std::uint64_t edit_count = 0;  // see LiveFrame::edit_count
  // Number of the last save request that was received before the scene was written.
  std::uint64_t request = 0;
};

// A document that was saved.
struct SavedDocument {
  std::filesystem::path file;
  std::uint64_t document = 0;  // number of the document, see LiveFrame::document
  std::uint64_t edit_count = 0;
};

// Existing files that a save may replace. `known`: only a file with the content that this session read or
// saved last. `any`: every file. Unknown content comes from another program, or the user has named the file
// of another document.
enum class Replaced { known, any };

// A request to save or export the document that is shown.
struct SaveRequest {
  std::uint64_t request = 0;
  std::uint64_t document = 0;  // number of the document shown at the time of the request
  std::filesystem::path file;
  Replaced replaced = Replaced::known;
};

// Writes the files of one live session. The autosave is at most a second older than the simulation.
class Journal {
 public:
  // Number of entries that may wait for the disk before a recording is abandoned. A tick makes about one
  // entry.
  static constexpr std::size_t entry_capacity = 16384;

  // The notices must outlive the journal. The scene buffers are allocated with the sizes of `first`.
  Journal(Notices& notices, const LiveScene& first);
  ~Journal();

  // Writes all pending entries and ends the thread. An unfinished recording remains without its end. Must be
  // called after the last push(), by the thread that made the journal.
  void stop();
  // Returns true if the last recording was written to its end and closed. Valid after stop().
  bool is_last_recording_complete() const { return is_last_complete_; }
  RecordedTicks last_recording() const { return last_recording_; }

  // Lets recordings end as FILE.part, complete but without replacing FILE.
  void leave_recordings_unpublished() { leaves_unpublished_.store(true, std::memory_order_release); }

  // Queues an entry. Returns false if the queue is full. Called by the haptic thread; does not wait or
  // allocate.
  bool push(JournalEntry&& entry) { return entries_.push(std::move(entry)); }
  // scene() returns the slot for the next scene, which publish_scene() passes on once it is complete. Both
  // are called by the haptic thread.
  LiveScene& scene() { return scenes_.writing(); }
  void publish_scene() { scenes_.publish(); }
  // Returns true if a recording has been abandoned since the last call.
  bool consume_recording_failure() { return recording_failed_.exchange(false, std::memory_order_acq_rel); }

  // Sets the view that is saved with documents. The main thread calls this function and all public functions
  // below it.
  void set_view(Json view);
  // Sets the autosave of the document with this number (LiveFrame::document); an empty value disables
  // autosaving. The previous autosave file is removed.
  void set_autosave(std::optional<Autosave> autosave, std::uint64_t document);
  // Disables the autosave and keeps its content under another name, which is returned; see
  // Autosave::set_aside(). Returns an error if there is no autosave.
  Result<std::filesystem::path> set_autosave_aside();
  // Saves the scene that is published for this request, or a newer one of the same document. A file with the
  // extension of an export format is exported; an export does not count as saving.
  void save(SaveRequest save);
  // Returns the last document that was saved since the previous call, or nullopt.
  std::optional<SavedDocument> consume_saved_document();
  // Returns the file of a save that was refused since the last call, because this session does not know the
  // content of the file; nullopt if no save was refused.
  std::optional<std::filesystem::path> consume_save_conflict();
  // Sets the hash of the content of the document's file as it was read, see content_hash(); empty if there is
  // no file.
  void set_known_content(std::optional<std::uint64_t> content);

 private:
  void run();
  bool process_pending();
  void write(JournalEntry& entry);
  Status write_to_recording(JournalEntry& entry);
  void abandon_recording(const Error& error);
  void store(const LiveScene& scene);
  bool may_replace(const SaveRequest& save);
  Document make_document(const LiveScene& scene);
  void autosave(const LiveScene& scene);
  bool was_superseded(std::uint64_t autosave_count);

  Notices* notices_;
  Exporter exporter_;
  BoundedQueue<JournalEntry> entries_;
  TripleBuffer<LiveScene> scenes_;

  std::mutex mutex_;  // guards the nine members that follow
  Json view_ = Json::object();
  std::optional<Autosave> autosave_;
  std::optional<SaveRequest> save_;
  std::optional<SavedDocument> saved_;
  std::optional<std::filesystem::path> save_conflict_;
  std::optional<std::uint64_t> known_content_;
  std::uint64_t autosave_count_ = 0;     // number of times that autosave_ was replaced or set aside
  std::uint64_t autosave_document_ = 0;  // number of the document that autosave_ holds
  std::uint64_t saved_change_ = 0;       // LiveScene::change of the last saved scene

  // recording_ and the four members that follow are used only by the journal's thread until stop() has ended
  // it.
  std::unique_ptr<RecordingWriter> recording_;
  std::uint64_t autosaved_change_ = 0;
  bool autosave_failed_ = false;
  bool is_last_complete_ = false;
  RecordedTicks last_recording_;

  std::atomic<bool> recording_failed_{false};
  std::atomic<bool> leaves_unpublished_{false};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace spoonbill
