#include "app/live/live_session.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Returns the specification of the device. If the device is virtual, its workspace is enlarged to contain the
// body, up to the largest radius allowed.
DeviceSpecification with_fitted_workspace(DeviceSpecification device, const Body& body) {
  if (!device.workspace_follows_model) return device;
  const double reach = find_bounds(body).size();
  device.workspace_radius_m = std::clamp(reach, device.workspace_radius_m, device_workspace_range_m.high);
  return device;
}

Result<std::unique_ptr<Session>> make_session(const Document& document, const std::string& source,
                                              const DeviceSpecification& device, InstructionSet set) {
  auto session =
      Session::make(document, source, with_fitted_workspace(device, document.scene.bodies[0]), set);
  if (!session) return session.error();
  return std::make_unique<Session>(std::move(session).value());
}

std::string describe_real_time_limit(int substeps) {
  return "this material needs " + std::to_string(substeps) +
         " substeps a tick in real time; a live session can take " + std::to_string(live_substeps_limit) +
         "; a replay can take any number";
}

// Switches real time off if a tick would need more substeps than a live session can take. Returns the reason,
// or an empty text.
std::string limit_real_time(Simulation& simulation) {
  Sculpting sculpting = simulation.scene().sculpting;
  const int substeps = simulation.real_time_substeps();
  if (!sculpting.real_time || substeps <= live_substeps_limit) return {};
  sculpting.real_time = false;
  if (Status applied = simulation.apply(SetSculpting{sculpting}); !applied) return applied.error().message;
  return "real time is off: " + describe_real_time_limit(substeps);
}

// Returns true for a change of the material while real time is on. The new material may need more substeps
// than the last frame reports.
bool changes_material_in_real_time(const Request& request, const Sculpting& sculpting) {
  const auto* command = std::get_if<Command>(&request);
  return command != nullptr && std::holds_alternative<SetMaterial>(*command) && sculpting.real_time;
}

bool switches_real_time_on(const Request& request) {
  const auto* command = std::get_if<Command>(&request);
  const auto* set = command == nullptr ? nullptr : std::get_if<SetSculpting>(command);
  return set != nullptr && set->sculpting.real_time;
}

// Replaces the session by a new one that starts with the current shape of its bodies.
Status restart_session(LentSession& lent, const DeviceSpecification& device, InstructionSet set) {
  auto session = make_session(make_session_document(*lent.session), "the current shape", device, set);
  if (!session) return session.error();
  session.value()->reading = lent.session->reading;
  lent.session = std::move(session).value();
  lent.is_new_session = true;
  return {};
}

Status restart_and_record(LentSession& lent, const std::filesystem::path& file, const ViewChoice& view,
                          const DeviceSpecification& device, InstructionSet set, const OutputOptions& output,
                          Notices& notices) {
  lent.session->view = view;
  const RecordingHeader header{lent.session->device, make_session_document(*lent.session)};
  auto recording = RecordingWriter::create(file, header, output);
  if (!recording) return recording.error();
  if (!recording->notice().empty()) notices.add(Notice::Kind::information, recording->notice());
  if (Status restarted = restart_session(lent, device, set); !restarted) return restarted;
  lent.recording = std::make_unique<RecordingWriter>(std::move(recording).value());
  return {};
}

}  // namespace

Result<std::unique_ptr<LiveSession>> LiveSession::start(const Document& document, const std::string& source,
                                                        const LiveSettings& settings,
                                                        std::unique_ptr<Device> device) {
  SPOONBILL_ASSERT(device != nullptr);
  const DeviceSpecification& specification = device->specification();
  if (Status checked = check_specification(specification); !checked) return checked.error();
  auto session = make_session(document, source, specification, settings.instruction_set);
  if (!session) return session.error();
  const std::string limit = limit_real_time(session.value()->simulation);
  auto live = start(std::move(session).value(), settings, std::move(device));
  if (live && !limit.empty()) live.value()->notices_.add(Notice::Kind::problem, limit);
  return live;
}

Result<std::unique_ptr<LiveSession>> LiveSession::start(std::unique_ptr<Session> session,
                                                        const LiveSettings& settings,
                                                        std::unique_ptr<Device> device,
                                                        std::unique_ptr<RecordingWriter> recording) {
  SPOONBILL_ASSERT(session != nullptr && device != nullptr);
  const DeviceSpecification& specification = device->specification();
  if (Status checked = check_specification(specification); !checked) return checked.error();
  const std::optional<DeviceReading> reading = device->read();
  if (!reading || !reading->is_valid()) {
    return Error{ErrorCode::unreadable, "device " + specification.name + ": does not answer"};
  }
  Session& made = *session;
  made.reading = *reading;
  LiveFrame first;
  write_snapshot(made, first.snapshot);
  write_facts(made, first.facts);
  const std::vector<std::string> notes = made.simulation.warnings();
  const LiveScene first_scene{made.title, make_session_document(made).scene};
  std::unique_ptr<LiveSession> live(
      new LiveSession(std::move(session), std::move(device), settings, first, first_scene));
  if (recording) live->haptic_.begin_recording(std::move(recording));
  LoopSettings loop_settings;
  loop_settings.real_time = settings.real_time;
  auto loop =
      HapticLoop::start(loop_settings, [side = &live->haptic_](const LoopTick& tick) { side->tick(tick); });
  if (!loop) return loop.error();
  live->loop_.emplace(std::move(loop).value());
  if (Status watched = live->haptic_.watched_device().start(settings.real_time); !watched)
    return watched.error();
  if (const std::string notice = live->loop_->figures().notice; !notice.empty()) {
    live->notices_.add(Notice::Kind::information, notice);
  }
  for (const std::string& note : notes) live->notices_.add(Notice::Kind::problem, note);
  return live;
}

LiveSession::LiveSession(std::unique_ptr<Session> session, std::unique_ptr<Device> device,
                         const LiveSettings& settings, const LiveFrame& first, const LiveScene& first_scene)
    : settings_(settings),
      device_(device->specification()),
      journal_(notices_, first_scene),
      worker_(notices_),
      exchange_(first),
      haptic_(std::move(session), std::move(device), exchange_, journal_, worker_) {}

LiveSession::~LiveSession() {
  stop();
}

void LiveSession::stop() {
  if (!loop_) return;
  loop_->stop();
  haptic_.watched_device().stop();
  haptic_.close();
  journal_.stop();
}

void LiveSession::set_autosave(std::optional<Autosave> autosave) {
  journal_.set_autosave(std::move(autosave), last_frame().document);
}

bool LiveSession::send(LiveCommand command) {
  return exchange_.commands.push(std::move(command));
}

bool LiveSession::ask(Request request) {
  const LiveFrame& shown = last_frame();
  const int substeps = shown.snapshot.real_time_substeps;
  if (switches_real_time_on(request) && substeps > live_substeps_limit) {
    notices_.add(Notice::Kind::problem, describe_real_time_limit(substeps));
    return true;
  }
  // The substeps of a new material are known only once its lattice is made.
  if (changes_material_in_real_time(request, shown.facts.sculpting)) {
    Sculpting sculpting = shown.facts.sculpting;
    sculpting.real_time = false;
    notices_.add(Notice::Kind::information, "real time is off, because the material has changed");
    if (!ask(Command(SetSculpting{sculpting}))) return false;
  }
  Json json = request_to_json(request);
  return send(QueuedRequest{std::move(request), std::move(json)});
}

bool LiveSession::open(Document document, std::string source) {
  const InstructionSet set = settings_.instruction_set;
  return send(QueuedJob{[this, document = std::move(document), source = std::move(source), device = device_,
                         set](LentSession& lent) {
                          auto session = make_session(document, source, device, set);
                          if (!session) return Status(session.error());
                          const std::string limit = limit_real_time(session.value()->simulation);
                          if (!limit.empty()) notices_.add(Notice::Kind::problem, limit);
                          lent.session = std::move(session).value();
                          lent.is_new_session = true;
                          lent.is_other_document = true;
                          return Status();
                        },
                        true});
}

bool LiveSession::start_recording(std::filesystem::path file, const ViewChoice& view,
                                  const OutputOptions& output) {
  const InstructionSet set = settings_.instruction_set;
  return send(
      QueuedJob{[this, file = std::move(file), view, device = device_, set, output](LentSession& lent) {
                  return restart_and_record(lent, file, view, device, set, output, notices_);
                },
                true});
}

bool LiveSession::stop_recording() {
  return send(EndRecording{});
}

bool LiveSession::save(std::filesystem::path file, Replaced replaced) {
  const std::uint64_t request = ++saves_;
  journal_.save({request, last_frame().document, std::move(file), replaced});
  return send(SceneRequest{request});
}

const LiveFrame& LiveSession::frame() {
  exchange_.frames.update_reading();
  return exchange_.frames.reading();
}

void LiveSession::consume_forces(std::vector<float>& forces_n) {
  forces_n.clear();
  ForceSample sample;
  while (exchange_.forces.pop(sample)) forces_n.push_back(sample.force_n);
}

std::vector<Notice> LiveSession::consume_notices() {
  const std::uint64_t lost = exchange_.recordings_lost.load(std::memory_order_relaxed);
  if (lost != recordings_lost_) {
    recordings_lost_ = lost;
    notices_.add(Notice::Kind::problem, "the recording has ended: the disk is too slow");
  }
  std::optional<FailedAssertion> failure;
  while (exchange_.failures.pop(failure)) {
    notices_.add(Notice::Kind::problem, std::string(failure->what()) + "; undo the stroke, or save the work");
  }
  return notices_.consume();
}

}  // namespace spoonbill
