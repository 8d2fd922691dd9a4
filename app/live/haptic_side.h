// Everything that the haptic thread owns while a live session runs, and what it does each tick: follow the
// hand, do what was asked, advance the session, make the force safe, hand over what others need.
//
//   main thread --commands, target--> [ haptic thread ] --frames, forces--> main thread
//                                        |        ^
//                        entries, scenes v        | a session on loan, and back
//                                     journal   worker
//
// tick() neither waits nor reads a clock. It allocates only in the first frames after a session was built
// anew, when the sizes of snapshots change.
#pragma once

#include <atomic>
#include <memory>

#include "app/live/journal.h"
#include "app/live/live_command.h"
#include "app/live/live_frame.h"
#include "app/live/session_worker.h"
#include "app/live/target_follower.h"
#include "haptic/bounded_queue.h"
#include "haptic/haptic_loop.h"
#include "haptic/safety.h"
#include "haptic/triple_buffer.h"

namespace spoonbill {

// Where the drawing thread and the haptic one meet. Made before the thread and outlives it.
struct LiveExchange {
  static constexpr std::size_t command_capacity = 256;
  static constexpr std::size_t force_capacity = 4096;

  LiveExchange(const HandTarget& start, const LiveFrame& first)
      : target(start), commands(command_capacity), frames(first), forces(force_capacity) {}

  TripleBuffer<HandTarget> target;                // main -> haptic
  BoundedQueue<LiveCommand> commands;             // main -> haptic
  TripleBuffer<LiveFrame> frames;                 // haptic -> main
  BoundedQueue<ForceSample> forces;               // haptic -> main; those that find no room are not plotted
  std::atomic<std::uint64_t> recordings_lost{0};  // ended because the disk could not follow
};

class HapticSide {
 public:
  // Exchange, journal and worker must outlive it. The workspace of the session's device lies about the
  // centre.
  HapticSide(std::unique_ptr<Session> session, VirtualDevice device, const Vector3& workspace_centre_m,
             LiveExchange& exchange, Journal& journal, SessionWorker& worker);

  // By the haptic thread alone, once a period.
  void tick(const LoopTick& tick) noexcept;

  // When the thread has stopped: ends a recording as stop_recording does.
  void close();

  const Session* session() const { return lent_.session.get(); }

 private:
  void do_commands();
  bool do_command();
  void lend();
  void take_back_if_done();
  void answer_work(bool done);
  void apply_now(AskedRequest& asked);
  void record(Json&& command);
  void reset_proxy();
  void begin_recording(std::unique_ptr<PlacedRecording> recording);
  void end_recording();
  void record_state_when_due();
  void push(JournalEntry&& entry);
  void advance_session(const DeviceReading& reading, std::uint64_t dropped);
  SafeForce make_force_safe(const Vector3& wanted_n, const DeviceReading& reading, std::uint64_t dropped,
                            bool stale);
  void note_change();
  void publish(std::uint64_t index);
  void publish_scene();

  LentSession lent_;  // its session is null while the worker has it
  VirtualDevice device_;
  DeviceSpecification specification_;  // the session's, also while that is on loan
  TargetFollower follower_;
  Vector3 workspace_centre_m_;
  SafetyState safety_;
  std::uint32_t safety_flags_ = 0;
  bool proxy_is_stale_ = false;

  LiveExchange* exchange_;
  Journal* journal_;
  SessionWorker* worker_;
  LiveCommand command_;  // the one that is being done

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
