// A live session as the main thread sees it: ticks in real time on a thread of their own, with a journal and
// a worker.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/live/haptic_side.h"

namespace spoonbill {

// Largest number of substeps a tick for which a live session runs in real time. A document that needs more is
// opened with real time off, and a notice says so.
inline constexpr int live_substeps_limit = 32;

// Settings of a live session.
struct LiveSettings {
  InstructionSet instruction_set = best_instruction_set();
  bool real_time = true;
};

// Starts, controls and stops the threads of a session. One owner: the main thread, which makes all calls. No
// function except stop() waits for the haptic thread.
class LiveSession {
 public:
  // Starts a session. `source` names the document's file in messages. The device must not be null and is
  // closed with the session. Returns an error if the scene cannot be simulated, if the device does not
  // respond or its specification is out of range, or if a thread cannot be started.
  static Result<std::unique_ptr<LiveSession>> start(const Document& document, const std::string& source,
                                                    const LiveSettings& settings,
                                                    std::unique_ptr<Device> device);
  // Starts a session that is made already, such as one of training, with the reading that the device gives
  // now. Its first tick is the first of `recording`, unless that is null. Errors of the device and of threads
  // are those above.
  static Result<std::unique_ptr<LiveSession>> start(std::unique_ptr<Session> session,
                                                    const LiveSettings& settings,
                                                    std::unique_ptr<Device> device,
                                                    std::unique_ptr<RecordingWriter> recording = nullptr);
  ~LiveSession();  // waits for all pending writes, then stops the threads

  // Queues a request. Requests are applied in order before the next tick. Returns false if the queue is full
  // because the haptic thread is far behind. A request for real time is refused with a notice if a tick would
  // need more than live_substeps_limit substeps. A new material switches real time off.
  bool ask(Request request);

  // Switches the force of the device off at the next tick, whatever commands are queued.
  void cut_force() { exchange_.force_cut.store(true, std::memory_order_release); }

  // Queues the replacement of the document. A recording in progress ends first.
  bool open(Document document, std::string source);

  // Restarts the session from the current shape, at rest, and records from there, so that the recording is
  // self-contained. `view` is the initial view of its replay.
  bool start_recording(std::filesystem::path file, const ViewChoice& view,
                       const OutputOptions& output = {NamedBy::program});
  bool stop_recording();
  // Lets the recording end as FILE.part instead of replacing FILE. Called before stop_recording().
  void leave_recording_unpublished() { journal_.leave_recordings_unpublished(); }

  // Saves the document that the last frame shows, in the state of the next tick. consume_saved_document() and
  // the notices report the result. The save fails if another document was opened in the meantime. If
  // `replaced` does not allow the file to be replaced, consume_save_conflict() reports it.
  bool save(std::filesystem::path file, Replaced replaced = Replaced::known);
  std::optional<SavedDocument> consume_saved_document() { return journal_.consume_saved_document(); }
  std::optional<std::filesystem::path> consume_save_conflict() { return journal_.consume_save_conflict(); }
  // Sets the hash of the content of the document's file as it was read, see Journal.
  void set_known_content(std::optional<std::uint64_t> content) { journal_.set_known_content(content); }

  // set_view() sets the view that is saved with documents; set_autosave() sets the autosave of the document
  // of the last frame.
  void set_view(Json view) { journal_.set_view(std::move(view)); }
  void set_autosave(std::optional<Autosave> autosave);
  // Ends the autosave and stores its content under another name, see Journal::set_autosave_aside().
  Result<std::filesystem::path> set_autosave_aside() { return journal_.set_autosave_aside(); }

  // Returns the newest frame. The haptic thread makes one every four ticks.
  const LiveFrame& frame();
  // Returns the frame of the last call of frame(). It is valid until the next call of frame().
  const LiveFrame& last_frame() const { return exchange_.frames.reading(); }
  // Writes the forces of the ticks since the last call, oldest first, in newtons.
  void consume_forces(std::vector<float>& forces_n);
  std::vector<Notice> consume_notices();
  LoopFigures figures() const { return loop_->figures(); }

  // Ends the haptic thread and a recording, and waits until everything is written. Afterwards only figures(),
  // consume_notices(), is_last_recording_complete(), last_recording() and session() may be called.
  void stop();
  // Returns true if the last recording was written to its end.
  bool is_last_recording_complete() const { return journal_.is_last_recording_complete(); }
  RecordedTicks last_recording() const { return journal_.last_recording(); }
  // Returns the session after stop(); null if the worker had it.
  const Session* session() const { return haptic_.session(); }

 private:
  LiveSession(std::unique_ptr<Session> session, std::unique_ptr<Device> device, const LiveSettings& settings,
              const LiveFrame& first, const LiveScene& first_scene);
  bool send(LiveCommand command);

  LiveSettings settings_;
  DeviceSpecification device_;
  Notices notices_;
  Journal journal_;
  SessionWorker worker_;
  LiveExchange exchange_;
  HapticSide haptic_;
  std::optional<HapticLoop> loop_;
  std::uint64_t saves_ = 0;
  std::uint64_t recordings_lost_ = 0;
};

}  // namespace spoonbill
