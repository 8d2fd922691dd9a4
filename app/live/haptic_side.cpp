#include "app/live/haptic_side.h"

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <utility>

namespace spoonbill {
namespace {

// Carries out a command. Catches exceptions of the standard library, which mostly report a lack of memory,
// because the thread of the worker must survive.
Status run_job(LiveCommand& command, LentSession& lent) {
  try {
    if (auto* queued = std::get_if<QueuedRequest>(&command)) {
      return apply_request(*lent.session, queued->request);
    }
    if (auto* queued = std::get_if<QueuedJob>(&command)) return queued->job(lent);
  } catch (const std::exception& exception) {
    return Error{ErrorCode::internal, std::string("the command failed: ") + exception.what()};
  }
  return {};
}

// Returns null if the memory does not suffice. The surfaces are then not refined.
std::unique_ptr<Refiner> make_refiner(const Simulation& simulation) {
  try {
    return std::make_unique<Refiner>(simulation);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void run_refinement(RefinementJob& job) {
  try {
    if (!job.refiner->prepare(job.command)) return;
    job.json = request_to_json(Command(job.command));
  } catch (const std::exception&) {
    job.refiner.reset();  // the memory does not suffice, or the command failed
  }
}

}  // namespace

SessionWorker::SessionWorker(Notices& notices) : notices_(&notices), thread_([this] { run(); }) {}

SessionWorker::~SessionWorker() {
  stopping_.store(true, std::memory_order_release);
  pending_.release();
  thread_.join();
}

void SessionWorker::lend(LentSession lent, LiveCommand job) {
  lent_ = std::move(lent);
  job_ = std::move(job);
  finished_.store(false, std::memory_order_relaxed);
  pending_.release();
}

bool SessionWorker::reclaim(LentSession& lent, LiveCommand& job, bool& is_done) {
  if (!finished_.exchange(false, std::memory_order_acquire)) return false;
  lent = std::move(lent_);
  job = std::move(job_);
  is_done = is_done_;
  return true;
}

void SessionWorker::prepare(RefinementJob& job) {
  SPOONBILL_ASSERT(job.refiner != nullptr);
  std::swap(refinement_, job);
  finished_.store(false, std::memory_order_relaxed);
  pending_.release();
}

bool SessionWorker::reclaim(RefinementJob& job) {
  if (!finished_.exchange(false, std::memory_order_acquire)) return false;
  std::swap(refinement_, job);
  return true;
}

void SessionWorker::run() {
  while (true) {
    pending_.acquire();
    if (stopping_.load(std::memory_order_acquire)) return;
    if (refinement_.refiner != nullptr) {
      run_refinement(refinement_);
    } else {
      run_loan();
    }
    finished_.store(true, std::memory_order_release);
  }
}

void SessionWorker::run_loan() {
  const Status status = run_job(job_, lent_);
  if (!status) notices_->add(Notice::Kind::problem, status.error().message);
  is_done_ = status.ok();
  if (is_done_) lent_.refiner = make_refiner(lent_.session->simulation);
}

namespace {

constexpr std::uint64_t ticks_between_frames = 4;
constexpr int ticks_between_scenes = 400;

// Number of ticks after the last command or touch during which each tick counts as a change to save.
constexpr int after_motion_ticks = 3000;

// Returns true for a request that the main thread carries out itself; the haptic thread only records it.
bool is_main_thread_request(const Request& request) {
  return std::holds_alternative<ChangeView>(request) || std::holds_alternative<MarkFile>(request);
}

}  // namespace

HapticSide::HapticSide(std::unique_ptr<Session> session, std::unique_ptr<Device> device,
                       LiveExchange& exchange, Journal& journal, SessionWorker& worker)
    : device_(std::move(device)),
      watched_device_(*device_),
      safe_device_(watched_device_, session->reading),
      exchange_(&exchange),
      journal_(&journal),
      worker_(&worker) {
  safe_device_.set_workspace_centre(session->reading.pose().position_m);
  safe_device_.set_workspace_radius(session->device.workspace_radius_m);
  lent_.session = std::move(session);
  lent_.refiner = make_refiner(lent_.session->simulation);
  ticks_since_change_ = after_motion_ticks;
}

void HapticSide::tick(const LoopTick& tick) noexcept {
  try {
    run_tick(tick);
    last_tick_failed_ = false;
  } catch (const FailedAssertion& failure) {
    abandon_tick(failure);
  }
}

void HapticSide::abandon_tick(const FailedAssertion& failure) {
  safe_device_.give_none();
  safe_device_.request_proxy_reset();
  if (lent_.session != nullptr) lent_.session->flags |= tick_flag_failed;
  recording_ = false;
  if (!last_tick_failed_) exchange_->failures.push(failure);
  last_tick_failed_ = true;
}

void HapticSide::run_tick(const LoopTick& tick) {
  if (journal_->consume_recording_failure()) recording_ = false;
  // If the watchdog has cut the force, the tick is treated as the first one after a stall.
  const std::uint64_t cut_ticks = watched_device_.consume_cut() ? stall_ticks - 1 : 0;
  const DeviceReading reading = safe_device_.read(std::max(tick.dropped, cut_ticks));
  if (lent_.session == nullptr) reclaim_if_done();
  if (lent_.session != nullptr) {
    record_state_when_due();
    run_commands();
  }
  update_force_switch();
  if (lent_.session == nullptr) return safe_device_.give_none();
  refine();
  advance_session(reading);
  publish(tick.index);
}

void HapticSide::close() {
  safe_device_.give_none();
  if (lent_.session == nullptr) return;
  if (recording_) end_recording();
  // The journal autosaves this state, so that a session that ends with a fault loses no work.
  if (published_change_ != change_) publish_scene();
}

void HapticSide::run_commands() {
  while (lent_.session != nullptr &&
         (std::exchange(is_command_waiting_, false) || exchange_->commands.pop(command_))) {
    if (!run_command()) return;
  }
}

// Switches the force of the device. Records each change of the session's force switch, because a replay
// starts with the force on.
void HapticSide::update_force_switch() {
  if (exchange_->force_cut.exchange(false, std::memory_order_acq_rel)) force_on_ = false;
  safe_device_.switch_force(force_on_);
  if (lent_.session == nullptr || lent_.session->force_on == force_on_) return;
  lent_.session->force_on = force_on_;
  if (recording_) push(RecordedForceSwitch{force_on_});
}

// Runs command_. Returns false if the session is then on loan to the worker, or if the command waits for
// this.
bool HapticSide::run_command() {
  if (auto* queued = std::get_if<QueuedRequest>(&command_)) {
    if (is_main_thread_request(queued->request)) {
      record(std::move(queued->json));
    } else if (const auto* force = std::get_if<SwitchForce>(&queued->request)) {
      force_on_ = force->on;
    } else if (needs_rebuild(*lent_.session, queued->request)) {
      if (!waits_for_loan()) lend();
      return false;
    } else {
      apply_now(*queued);
    }
  } else if (auto* job = std::get_if<QueuedJob>(&command_)) {
    if (waits_for_loan()) return false;
    if (job->ends_recording) end_recording();
    lend();
    return false;
  } else if (const auto* scene = std::get_if<SceneRequest>(&command_)) {
    request_ = scene->request;
    publish_scene();
  } else if (std::holds_alternative<EndRecording>(command_)) {
    end_recording();
  }
  return true;
}

// Returns whether command_, which needs the session on loan, must wait until a refinement is prepared.
bool HapticSide::waits_for_loan() {
  is_command_waiting_ = is_refining_;
  return is_command_waiting_;
}

void HapticSide::lend() {
  worker_->lend(std::move(lent_), std::move(command_));
  lent_ = {};
}

void HapticSide::reclaim_if_done() {
  bool is_done = false;
  if (!worker_->reclaim(lent_, command_, is_done)) return;
  if (lent_.is_new_session) {
    ++session_count_;
    safe_device_.set_workspace_radius(lent_.session->device.workspace_radius_m);
    lent_.is_new_session = false;
  }
  if (lent_.is_other_document) {
    ++document_count_;
    // The workspace of a virtual device is centred on the first body of the new document.
    if (lent_.session->device.workspace_follows_model) {
      safe_device_.set_workspace_centre(lent_.session->simulation.bounds(0).centre());
    }
    lent_.is_other_document = false;
  }
  if (lent_.recording != nullptr) start_recording(std::move(lent_.recording));
  if (auto* queued = std::get_if<QueuedRequest>(&command_); queued != nullptr && is_done) {
    record(std::move(queued->json));
    count_edit();
  }
  if (std::holds_alternative<QueuedJob>(command_)) report_job(is_done);
  safe_device_.request_proxy_reset();
}

// Has the worker prepare the refinement that the simulation wants, and adopts the one that it has prepared.
void HapticSide::refine() {
  if (is_refining_) return adopt_refinement();
  if (ticks_to_refinement_ > 0) --ticks_to_refinement_;
  const Session& session = *lent_.session;
  const std::optional<RefineKnots>& wanted = session.simulation.wanted_refinement();
  if (lent_.refiner == nullptr || ticks_to_refinement_ > 0 || !wanted || !session.history.has_open_step()) {
    return;
  }
  refinement_.refiner = std::move(lent_.refiner);
  refinement_.command = *wanted;
  worker_->prepare(refinement_);
  is_refining_ = true;
}

// Adopts the refinement once the worker has prepared it, unless an undo has made it unwanted.
void HapticSide::adopt_refinement() {
  constexpr int patience_ticks = 300;
  if (!worker_->reclaim(refinement_)) return;
  is_refining_ = false;
  lent_.refiner = std::move(refinement_.refiner);
  Session& session = *lent_.session;
  const bool is_prepared = lent_.refiner != nullptr && lent_.refiner->is_prepared();
  ticks_to_refinement_ = is_prepared ? 0 : patience_ticks;
  const bool is_wanted = session.history.has_open_step() && session.simulation.wanted_refinement();
  if (!is_prepared || !is_wanted) return;
  session.history.adopt(session.simulation, *lent_.refiner);
  record(std::move(refinement_.json));
  count_edit();
}

void HapticSide::report_job(bool is_done) {
  const std::uint64_t bit = std::uint64_t{1} << (completed_jobs_++ % 64);
  failed_jobs_ = is_done ? failed_jobs_ & ~bit : failed_jobs_ | bit;
}

void HapticSide::apply_now(QueuedRequest& queued) {
  const bool does_nothing =
      std::holds_alternative<CancelStroke>(queued.request) && !lent_.session->history.in_stroke();
  if (does_nothing) return;
  const Status applied = apply_request(*lent_.session, queued.request);
  if (!applied) return;
  record(std::move(queued.json));
  count_edit();
}

void HapticSide::record(Json&& command) {
  push(RecordedCommand{std::move(command), recording_});
}

void HapticSide::reset_proxy() {
  if (!lent_.session->simulation.apply(ResetProxy{})) return;
  if (recording_) push(RecordedReset{});
}

void HapticSide::start_recording(std::unique_ptr<RecordingWriter> recording) {
  recording_ = true;
  recorded_ticks_ = 0;
  recorded_missed_ = 0;
  state_recorded_ = false;
  push(RecordingStart{std::move(recording)});
  record_state_when_due();
}

void HapticSide::end_recording() {
  if (!recording_) return;
  push(RecordedState{state_hash(*lent_.session), true, recorded_missed_});
  recording_ = false;
}

void HapticSide::record_state_when_due() {
  if (!recording_ || state_recorded_ || recorded_ticks_ % recording_checkpoint_ticks != 0) return;
  push(RecordedState{state_hash(*lent_.session), false});
  state_recorded_ = true;
}

void HapticSide::push(JournalEntry&& entry) {
  if (journal_->push(std::move(entry)) || !recording_) return;
  // A recording with a gap cannot be replayed, so it ends at the last entry that was queued.
  recording_ = false;
  exchange_->recordings_lost.fetch_add(1, std::memory_order_relaxed);
}

void HapticSide::advance_session(DeviceReading reading) {
  if (safe_device_.consume_proxy_reset()) reset_proxy();
  if (recording_) {
    if (recorded_ticks_ == 0) reading.missed = 0;  // ticks missed before the recording do not count
    push(RecordedReading{reading});
    recorded_missed_ += reading.missed;
    ++recorded_ticks_;
    state_recorded_ = false;
  }
  const TickResult result = advance(*lent_.session, reading);
  const Vector3 force_n = safe_device_.give(result.force_n);
  exchange_->forces.push(ForceSample{static_cast<float>(force_n.norm())});
  if (result.touching) count_edit();
}

void HapticSide::count_edit() {
  ticks_since_change_ = 0;
  ++edit_count_;
}

void HapticSide::publish(std::uint64_t index) {
  if (ticks_since_change_ < after_motion_ticks) {
    ++ticks_since_change_;
    ++change_;
  }
  if (++ticks_since_scene_ >= ticks_between_scenes && published_change_ != change_) publish_scene();
  if (index % ticks_between_frames != 0) return;
  LiveFrame& frame = exchange_->frames.writing();
  write_snapshot(*lent_.session, frame.snapshot);
  lent_.session->flags = tick_flag_none;
  write_facts(*lent_.session, frame.facts);
  frame.safety_flags = safe_device_.flags();
  frame.recording = recording_;
  frame.session = session_count_;
  frame.edit_count = edit_count_;
  frame.document = document_count_;
  frame.completed_jobs = completed_jobs_;
  frame.failed_jobs = failed_jobs_;
  exchange_->frames.publish();
}

void HapticSide::publish_scene() {
  ticks_since_scene_ = 0;
  published_change_ = change_;
  LiveScene& scene = journal_->scene();
  scene.title = lent_.session->title;
  lent_.session->simulation.write_scene(scene.scene);
  scene.document = document_count_;
  scene.change = change_;
  scene.edit_count = edit_count_;
  scene.request = request_;
  journal_->publish_scene();
}

}  // namespace spoonbill
