// The haptic thread's part of a live session. Each tick it reads the device, applies commands, advances the
// session, sends the force to the device and passes data to the other threads.
//
//  main thread --commands--> [ haptic thread, device ] --frames, forces--> main thread
//                                       |        ^
//                       entries, scenes v        | a session on loan, and back
//                                    journal   worker
//
// tick() does not wait or read a clock. It allocates only in the first frames of a new session, when the
// sizes of snapshots change.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
#include <variant>

#include "app/live/journal.h"
#include "app/session/session.h"
#include "engine/base/assert.h"
#include "engine/simulation/refiner.h"
#include "engine/simulation/snapshot.h"
#include "haptic/haptic_loop.h"
#include "haptic/lock_free.h"
#include "haptic/recording.h"
#include "haptic/safe_device.h"
#include "haptic/watched_device.h"

namespace spoonbill {

// A session that the haptic thread lends to the worker for a job, with the results of the job.
struct LentSession {
  std::unique_ptr<Session> session;
  std::unique_ptr<Refiner> refiner;            // refiner of the session; null while it prepares something
  bool is_new_session = false;                 // true if the job has replaced the session by a new one
  bool is_other_document = false;              // true if the new session shows another document
  std::unique_ptr<RecordingWriter> recording;  // recording that starts with the session's next tick
};

// A refinement of knots that the haptic thread wants, with the refiner that prepares it.
struct RefinementJob {
  std::unique_ptr<Refiner> refiner;
  RefineKnots command;
  Json json;  // the command, for the recording
};

// A job that may take long. It runs on the worker's thread. Meanwhile, the haptic thread reads the device and
// sends no force. An error leaves the session unchanged.
using SessionJob = std::function<Status(LentSession&)>;

// A request with its JSON, which the main thread makes so that the haptic thread need not allocate.
struct QueuedRequest {
  Request request;
  Json json;
};

// A job for the worker.
struct QueuedJob {
  SessionJob job;
  bool ends_recording = false;
};

// A request to pass the scene to the journal, which saves it.
struct SceneRequest {
  std::uint64_t request = 0;
};
struct EndRecording {};

using LiveCommand = std::variant<std::monostate, QueuedRequest, QueuedJob, SceneRequest, EndRecording>;

// One tick of a live session for the thread that draws. Plain data.
struct LiveFrame {
  Snapshot snapshot;
  SessionFacts facts;
  std::uint32_t safety_flags = 0;  // SafetyFlag bits of the last tick
  bool recording = false;
  std::uint64_t session = 0;         // number of sessions started after the first
  std::uint64_t edit_count = 0;      // number of commands so far plus number of ticks with contact
  std::uint64_t document = 0;        // number of documents opened after the first
  std::uint64_t completed_jobs = 0;  // number of completed jobs: documents opened, recordings started
  std::uint64_t failed_jobs = 0;     // bit n % 64 is set if job n failed; jobs are counted from 0
};

// Force on the device at one tick, for a plot.
struct ForceSample {
  float force_n = 0.0F;
};

// Runs jobs that take milliseconds and allocate, on a thread that may wait, while the haptic thread
// continues. Has at most one session or one refinement at a time.
class SessionWorker {
 public:
  // The notices must outlive the worker. An error of a job becomes a notice.
  explicit SessionWorker(Notices& notices);
  ~SessionWorker();  // waits for the end of the current job

  // lend() and reclaim() are called by the haptic thread; neither waits nor allocates. reclaim() returns true
  // once per loan, after the job has ended; lend() must not be called again before that. `job` is the
  // command, and `is_done` is true if it succeeded.
  void lend(LentSession lent, LiveCommand job);
  bool reclaim(LentSession& lent, LiveCommand& job, bool& is_done);

  // prepare() and reclaim() do the same for a refinement, while the session stays with the haptic thread.
  // They swap `job` with the worker's. If this failed, which is not reported, the refiner has prepared
  // nothing or is null.
  void prepare(RefinementJob& job);
  bool reclaim(RefinementJob& job);

 private:
  void run();
  void run_loan();

  Notices* notices_;
  LentSession lent_;
  LiveCommand job_;
  bool is_done_ = false;
  RefinementJob refinement_;
  std::atomic<bool> finished_{false};
  std::atomic<bool> stopping_{false};
  std::counting_semaphore<2> pending_{0};  // released once per job, and once to stop the thread
  std::thread thread_;
};

// Queues and buffers between the main thread and the haptic thread. Must outlive the haptic thread.
struct LiveExchange {
  static constexpr std::size_t command_capacity = 256;
  static constexpr std::size_t force_capacity = 4096;
  static constexpr std::size_t failure_capacity = 16;

  explicit LiveExchange(const LiveFrame& first)
      : commands(command_capacity),
        frames(first, [](LiveFrame& frame) { reserve_for_refinement(frame.snapshot); }),
        forces(force_capacity),
        failures(failure_capacity) {}

  BoundedQueue<LiveCommand> commands;  // from the main thread to the haptic thread
  // Set by the main thread. The haptic thread then switches the force off at its next tick, whatever commands
  // are queued.
  std::atomic<bool> force_cut{false};
  TripleBuffer<LiveFrame> frames;    // from the haptic thread to the main thread
  BoundedQueue<ForceSample> forces;  // from the haptic thread to the main thread; dropped when full
  // Number of recordings that ended because the disk was too slow.
  std::atomic<std::uint64_t> recordings_lost{0};
  // From the haptic thread to the main thread: the first failure of each series of failed ticks.
  BoundedQueue<std::optional<FailedAssertion>> failures;
};

// State and functions of the haptic thread.
class HapticSide {
 public:
  // Exchange, journal and worker must outlive the object. The device's workspace is centred on the position
  // in the session's reading.
  HapticSide(std::unique_ptr<Session> session, std::unique_ptr<Device> device, LiveExchange& exchange,
             Journal& journal, SessionWorker& worker);

  // Runs one tick. Called by the haptic thread, once per period. A failed assertion abandons the tick: the
  // device gets no force and the next frame has tick_flag_failed. A recording ends, because its replay would
  // not abandon the tick at the same point.
  void tick(const LoopTick& tick) noexcept;

  // Starts a recording with the first tick. Must be called before the thread starts.
  void begin_recording(std::unique_ptr<RecordingWriter> recording) { start_recording(std::move(recording)); }

  // Leaves the device without force, ends a recording as LiveSession::stop_recording() does, and passes the
  // last changes to the journal. Must be called only after the thread has stopped.
  void close();

  // Returns the device with its watchdog. The caller starts and stops the watchdog's thread.
  WatchedDevice& watched_device() { return watched_device_; }

  const Session* session() const { return lent_.session.get(); }

 private:
  void run_tick(const LoopTick& tick);
  void abandon_tick(const FailedAssertion& failure);
  void run_commands();
  bool run_command();
  void lend();
  void reclaim_if_done();
  bool waits_for_loan();
  void refine();
  void adopt_refinement();
  void report_job(bool is_done);
  void update_force_switch();
  void apply_now(QueuedRequest& queued);
  void record(Json&& command);
  void reset_proxy();
  void start_recording(std::unique_ptr<RecordingWriter> recording);
  void end_recording();
  void record_state_when_due();
  void push(JournalEntry&& entry);
  void advance_session(DeviceReading reading);
  void count_edit();
  void publish(std::uint64_t index);
  void publish_scene();

  LentSession lent_;  // the session in `lent_` is null while the worker has it
  std::unique_ptr<Device> device_;
  WatchedDevice watched_device_;
  SafeDevice safe_device_;  // the only access to the device
  bool force_on_ = true;    // true if the user has switched the force on; kept for later sessions

  LiveExchange* exchange_;
  Journal* journal_;
  SessionWorker* worker_;
  LiveCommand command_;              // the command in progress
  bool is_command_waiting_ = false;  // whether command_ waits until a refinement is prepared
  RefinementJob refinement_;
  bool is_refining_ = false;     // whether the worker has the refinement
  int ticks_to_refinement_ = 0;  // number of ticks until a refinement may be prepared after one that failed

  bool last_tick_failed_ = false;
  bool recording_ = false;
  std::uint64_t recorded_ticks_ = 0;
  std::uint64_t recorded_missed_ = 0;  // periods of 1 ms without a tick since the first tick of the recording
  bool state_recorded_ = false;        // true if the state hash at recorded_ticks_ is recorded

  std::uint64_t session_count_ = 0;
  std::uint64_t document_count_ = 0;
  std::uint64_t completed_jobs_ = 0;
  std::uint64_t failed_jobs_ = 0;
  std::uint64_t change_ = 0;
  std::uint64_t edit_count_ = 0;
  std::uint64_t request_ = 0;
  int ticks_since_change_ = 0;
  int ticks_since_scene_ = 0;
  std::uint64_t published_change_ = 0;
};

}  // namespace spoonbill
