// Everything that the haptic thread owns while a live session runs, and what it does each tick: read the
// device, do what was asked, advance the session, give the device its force, hand over what others need.
//
//   main thread --commands--> [ haptic thread, device ] --frames, forces--> main thread
//                                        |        ^
//                        entries, scenes v        | a session on loan, and back
//                                     journal   worker
//
// tick() neither waits nor reads a clock. It allocates only in the first frames after a session was built
// anew, when the sizes of snapshots change.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "app/live/journal.h"
#include "app/live/live_command.h"
#include "app/live/live_frame.h"
#include "app/live/session_worker.h"
#include "engine/base/assert.h"
#include "haptic/haptic_loop.h"
#include "haptic/lock_free.h"
#include "haptic/safe_device.h"

namespace spoonbill {

// Where the drawing thread and the haptic one meet. Made before the thread and outlives it.
struct LiveExchange {
  static constexpr std::size_t command_capacity = 256;
  static constexpr std::size_t force_capacity = 4096;
  static constexpr std::size_t failure_capacity = 16;

  explicit LiveExchange(const LiveFrame& first)
      : commands(command_capacity), frames(first), forces(force_capacity), failures(failure_capacity) {}

  BoundedQueue<LiveCommand> commands;             // main -> haptic
  TripleBuffer<LiveFrame> frames;                 // haptic -> main
  BoundedQueue<ForceSample> forces;               // haptic -> main; those that find no room are not plotted
  std::atomic<std::uint64_t> recordings_lost{0};  // ended because the disk could not follow
  BoundedQueue<std::optional<FailedAssertion>>
      failures;  // haptic -> main: the first of each row of failed ticks
};

class HapticSide {
 public:
  // Exchange, journal and worker must outlive it. The device's workspace is centred on the session's reading.
  HapticSide(std::unique_ptr<Session> session, std::unique_ptr<Device> device, LiveExchange& exchange,
             Journal& journal, SessionWorker& worker);

  // By the haptic thread alone, once a period. A failed assert gives up this tick: the hand gets no force,
  // what was left to do is skipped, the frame that follows bears tick_flag_failed, and a recording ends, as
  // its replay would not know where the tick broke off.
  void tick(const LoopTick& tick) noexcept;

  // When the thread has stopped: leaves the device without force, ends a recording as stop_recording does,
  // and hands the journal the last changes.
  void close();

  const Session* session() const { return lent_.session.get(); }

 private:
  void run_tick(const LoopTick& tick);
  void give_up_tick(const FailedAssertion& failure, std::uint64_t dropped);
  void do_commands();
  bool do_command();
  void lend();
  void take_back_if_done();
  void answer_work(bool done);
  void apply_now(AskedRequest& asked);
  void record(Json&& command);
  void reset_proxy();
  void begin_recording(std::unique_ptr<RecordingWriter> recording);
  void end_recording();
  void record_state_when_due();
  void push(JournalEntry&& entry);
  void advance_session(const DeviceReading& reading, std::uint64_t dropped);
  void note_change();
  void publish(std::uint64_t index);
  void publish_scene();

  LentSession lent_;  // its session is null while the worker has it
  std::unique_ptr<Device> device_;
  SafeDevice safe_device_;  // the device, for all that reads it or gives it a force

  LiveExchange* exchange_;
  Journal* journal_;
  SessionWorker* worker_;
  LiveCommand command_;  // the one that is being done

  bool last_tick_failed_ = false;
  bool recording_ = false;
  std::uint64_t recorded_ticks_ = 0;
  bool state_recorded_ = false;  // of recorded_ticks_

  std::uint64_t session_count_ = 0;
  std::uint64_t document_count_ = 0;
  std::uint64_t works_ = 0;
  std::uint64_t failed_works_ = 0;
  std::uint64_t change_ = 0;
  std::uint64_t deed_ = 0;
  std::uint64_t request_ = 0;
  int ticks_since_change_ = 0;
  int ticks_since_scene_ = 0;
  std::uint64_t published_change_ = 0;
};

}  // namespace spoonbill
