#include "app/live/haptic_side.h"

#include <algorithm>
#include <utility>

namespace spoonbill {
namespace {

constexpr std::uint64_t ticks_between_frames = 4;
constexpr int ticks_between_scenes = 400;

// A body goes on moving after it was let go; what it does for so long is saved too.
constexpr int settling_ticks = 3000;

// The main thread draws and writes files itself; what is left to do is to record that it did.
bool concerns_the_main_thread_alone(const Request& request) {
  return std::holds_alternative<ChangeView>(request) || std::holds_alternative<MarkFile>(request);
}

}  // namespace

HapticSide::HapticSide(std::unique_ptr<Session> session, std::unique_ptr<Device> device,
                       LiveExchange& exchange, Journal& journal, SessionWorker& worker)
    : device_(std::move(device)),
      safe_device_(*device_, session->reading),
      exchange_(&exchange),
      journal_(&journal),
      worker_(&worker) {
  safe_device_.set_workspace_centre(session->reading.pose().position_m);
  safe_device_.set_workspace_radius(session->device.workspace_radius_m);
  lent_.session = std::move(session);
  ticks_since_change_ = settling_ticks;
}

void HapticSide::tick(const LoopTick& tick) noexcept {
  try {
    run_tick(tick);
    last_tick_failed_ = false;
  } catch (const FailedAssertion& failure) {
    give_up_tick(failure, tick.dropped);
  }
}

void HapticSide::give_up_tick(const FailedAssertion& failure, std::uint64_t dropped) {
  safe_device_.give_none(dropped);
  safe_device_.request_proxy_reset();
  if (lent_.session != nullptr) lent_.session->flags |= tick_flag_failed;
  recording_ = false;
  if (!last_tick_failed_) exchange_->failures.push(failure);
  last_tick_failed_ = true;
}

void HapticSide::run_tick(const LoopTick& tick) {
  if (journal_->take_gave_up()) recording_ = false;
  const DeviceReading reading = safe_device_.read();
  if (lent_.session == nullptr) take_back_if_done();
  if (lent_.session != nullptr) {
    record_state_when_due();
    do_commands();
  }
  if (lent_.session == nullptr) return safe_device_.give_none(tick.dropped);
  advance_session(reading, tick.dropped);
  publish(tick.index);
}

void HapticSide::close() {
  safe_device_.give_none(0);
  if (lent_.session == nullptr) return;
  if (recording_) end_recording();
  // The newest work, for the autosave of a session that ends in a fault.
  if (published_change_ != change_) publish_scene();
}

void HapticSide::do_commands() {
  while (lent_.session != nullptr && exchange_->commands.pop(command_)) {
    if (!do_command()) return;
  }
}

// False when the session is on loan now.
bool HapticSide::do_command() {
  if (auto* asked = std::get_if<AskedRequest>(&command_)) {
    if (concerns_the_main_thread_alone(asked->request)) {
      record(std::move(asked->json));
    } else if (rebuilds(*lent_.session, asked->request)) {
      lend();
      return false;
    } else {
      apply_now(*asked);
    }
  } else if (auto* work = std::get_if<AskedWork>(&command_)) {
    if (work->ends_recording) end_recording();
    lend();
    return false;
  } else if (const auto* scene = std::get_if<AskedScene>(&command_)) {
    request_ = scene->request;
    publish_scene();
  } else if (std::holds_alternative<EndRecording>(command_)) {
    end_recording();
  }
  return true;
}

void HapticSide::lend() {
  worker_->lend(std::move(lent_), std::move(command_));
  lent_ = {};
}

void HapticSide::take_back_if_done() {
  bool done = false;
  if (!worker_->take_back(lent_, command_, done)) return;
  if (lent_.begun_anew) {
    ++session_count_;
    safe_device_.set_workspace_radius(lent_.session->device.workspace_radius_m);
    lent_.begun_anew = false;
  }
  if (lent_.other_document) {
    ++document_count_;
    // A virtual handle's workspace moves along to the body that is shaped now.
    if (lent_.session->device.workspace_follows_model) {
      const Box box = bounding_box(lent_.session->simulation.surface().net);
      safe_device_.set_workspace_centre(box.centre());
    }
    lent_.other_document = false;
  }
  if (lent_.recording != nullptr) begin_recording(std::move(lent_.recording));
  if (auto* asked = std::get_if<AskedRequest>(&command_); asked != nullptr && done) {
    record(std::move(asked->json));
    note_change();
  }
  if (std::holds_alternative<AskedWork>(command_)) answer_work(done);
  safe_device_.request_proxy_reset();
}

void HapticSide::answer_work(bool done) {
  const std::uint64_t bit = std::uint64_t{1} << (works_++ % 64);
  failed_works_ = done ? failed_works_ & ~bit : failed_works_ | bit;
}

void HapticSide::apply_now(AskedRequest& asked) {
  const bool does_nothing =
      std::holds_alternative<CancelStroke>(asked.request) && !lent_.session->history.in_stroke();
  if (does_nothing) return;
  const Status applied = apply_request(*lent_.session, asked.request);
  if (!applied) return;
  record(std::move(asked.json));
  note_change();
}

void HapticSide::record(Json&& command) {
  push(RecordedCommand{std::move(command), recording_});
}

void HapticSide::reset_proxy() {
  if (!lent_.session->simulation.apply(ResetProxy{})) return;
  if (recording_) push(RecordedReset{});
}

void HapticSide::begin_recording(std::unique_ptr<RecordingWriter> recording) {
  recording_ = true;
  recorded_ticks_ = 0;
  state_recorded_ = false;
  push(RecordingBegun{std::move(recording)});
  record_state_when_due();
}

void HapticSide::end_recording() {
  if (!recording_) return;
  push(RecordedState{state_hash(*lent_.session), true});
  recording_ = false;
}

void HapticSide::record_state_when_due() {
  if (!recording_ || state_recorded_ || recorded_ticks_ % recording_checkpoint_ticks != 0) return;
  push(RecordedState{state_hash(*lent_.session), false});
  state_recorded_ = true;
}

void HapticSide::push(JournalEntry&& entry) {
  if (journal_->push(std::move(entry)) || !recording_) return;
  // What is lost cannot be replayed: the recording ends where the disk could not follow.
  recording_ = false;
  exchange_->recordings_lost.fetch_add(1, std::memory_order_relaxed);
}

void HapticSide::advance_session(const DeviceReading& reading, std::uint64_t dropped) {
  if (safe_device_.consume_proxy_reset()) reset_proxy();
  if (recording_) {
    push(RecordedReading{reading});
    ++recorded_ticks_;
    state_recorded_ = false;
  }
  const TickResult result = advance(*lent_.session, reading);
  const Vector3 force_n = safe_device_.give(result.force_n, dropped);
  exchange_->forces.push(ForceSample{static_cast<float>(force_n.norm())});
  if (result.touching) note_change();
}

void HapticSide::note_change() {
  ticks_since_change_ = 0;
  ++deed_;
}

void HapticSide::publish(std::uint64_t index) {
  if (ticks_since_change_ < settling_ticks) {
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
  frame.deed = deed_;
  frame.document = document_count_;
  frame.works = works_;
  frame.failed_works = failed_works_;
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
  scene.deed = deed_;
  scene.request = request_;
  journal_->publish_scene();
}

}  // namespace spoonbill
